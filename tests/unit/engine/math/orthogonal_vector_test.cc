#include "engine/math/orthogonal_vector.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/math/lanes.h"

namespace graspdb {
namespace {

TEST(OrthogonalVector, OfFiveScaledAxesIsTheSixthTimesTheirVolume) {
  // Without column 3 the rows' determinant is 2 · 3 · 4 · 5 · 6.
  const double rows[5][6] = {{2, 0, 0, 9, 0, 0},
                             {0, 3, 0, 0, 0, 0},
                             {0, 0, 4, 0, 0, 0},
                             {0, 0, 0, 0, 5, 0},
                             {0, 0, 0, 0, 0, 6}};
  double orthogonal[6];
  CalcOrthogonalByMinors(rows, orthogonal);
  // The first row leans on axis 3: 2 x₀ + 9 x₃ = 0.
  const double expected[6] = {3240, 0, 0, -720, 0, 0};
  for (int j = 0; j < 6; ++j) EXPECT_EQ(orthogonal[j], expected[j]) << j;
}

TEST(OrthogonalVector, ByMinorsIsTheOneByEliminationAndOrthogonalToTheRows) {
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    Eigen::Matrix<double, 5, 6> matrix;
    Doubles2 rows[5][6];
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 6; ++j) {
        matrix(i, j) = random.NextUniform(-1.0, 1.0);
        // Another in the second lane: the rows halved.
        rows[i][j] = Doubles2{matrix(i, j), 0.5 * matrix(i, j)};
      }
    }
    Doubles2 orthogonal[6];
    CalcOrthogonalByMinors(rows, orthogonal);
    Eigen::Vector<double, 6> first, second;
    for (int j = 0; j < 6; ++j) {
      first[j] = orthogonal[j][0];
      second[j] = orthogonal[j][1];
    }
    EXPECT_LT((matrix * first).cwiseAbs().maxCoeff(), 1e-13) << trial;
    EXPECT_EQ(second, first / 32.0) << trial;
    const auto by_elimination = CalcOrthogonalByElimination(matrix);
    ASSERT_TRUE(by_elimination) << trial;
    EXPECT_NEAR(std::abs(by_elimination->dot(first)), first.norm(),
                1e-13 * first.norm())
        << trial;
    EXPECT_NEAR(by_elimination->norm(), 1.0, 1e-15);
  }
}

TEST(OrthogonalVector, OfDependentRowsIsNone) {
  Random random(5);
  Eigen::Matrix<double, 5, 6> rows;
  for (double& x : rows.reshaped()) x = random.NextUniform(-1.0, 1.0);
  rows.row(4) = rows.row(0) - 2.0 * rows.row(2);
  EXPECT_FALSE(CalcOrthogonalByElimination(rows));
  double by_minors[5][6], orthogonal[6];
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 6; ++j) by_minors[i][j] = rows(i, j);
  }
  CalcOrthogonalByMinors(by_minors, orthogonal);
  for (const double x : orthogonal) EXPECT_NEAR(x, 0.0, 1e-14);
}

}  // namespace
}  // namespace graspdb
