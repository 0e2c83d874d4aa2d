#include "engine/segmentation/label_cut.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

struct Problem {
  std::vector<std::vector<double>> costs;
  std::vector<FaceLink> links;
  std::vector<double> link_costs;
};

Problem MakeRandomProblem(int num_labels, int num_faces, uint64_t seed) {
  Random random(seed);
  Problem p;
  for (int label = 0; label < num_labels; ++label) {
    p.costs.emplace_back();
    for (int f = 0; f < num_faces; ++f) {
      p.costs.back().push_back(random.NextUniform());
    }
  }
  for (int a = 0; a < num_faces; ++a) {
    for (int b = a + 1; b < num_faces; ++b) {
      if (random.NextUniform() > 0.4) continue;
      p.links.push_back({a, b, 1.0, 0.0});
      p.link_costs.push_back(random.NextUniform(0.0, 0.6));
    }
  }
  return p;
}

double CalcEnergy(const Problem& p, const std::vector<int>& labels) {
  double energy = 0.0;
  for (size_t f = 0; f < labels.size(); ++f) energy += p.costs[labels[f]][f];
  for (size_t i = 0; i < p.links.size(); ++i) {
    if (labels[p.links[i].face_a] != labels[p.links[i].face_b]) {
      energy += p.link_costs[i];
    }
  }
  return energy;
}

// The oracle: every labelling.
double FindLeastEnergy(const Problem& p, int num_faces) {
  const int num_labels = static_cast<int>(p.costs.size());
  double least = std::numeric_limits<double>::infinity();
  const int count =
      static_cast<int>(std::lround(std::pow(num_labels, num_faces)));
  for (int code = 0; code < count; ++code) {
    std::vector<int> labels;
    for (int f = 0, rest = code; f < num_faces; ++f, rest /= num_labels) {
      labels.push_back(rest % num_labels);
    }
    least = std::min(least, CalcEnergy(p, labels));
  }
  return least;
}

TEST(CutLabels, IsOptimalForTwoLabels) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = MakeRandomProblem(2, 9, seed);
    const auto labels = CutLabels(p.costs, p.links, p.link_costs);
    EXPECT_NEAR(CalcEnergy(p, labels), FindLeastEnergy(p, 9), 1e-9) << seed;
  }
}

TEST(CutLabels, IsWithinAFactorOfTwoForThreeLabels) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Problem p = MakeRandomProblem(3, 7, seed);
    const auto labels = CutLabels(p.costs, p.links, p.link_costs);
    EXPECT_LE(CalcEnergy(p, labels), 2.0 * FindLeastEnergy(p, 7)) << seed;
  }
}

TEST(CutLabels, FollowsTheFaceCostsWhenBordersAreFree) {
  const std::vector<FaceLink> links{{0, 1, 1, 0}, {1, 2, 1, 0}};
  EXPECT_EQ(CutLabels({{0, 1, 0}, {1, 0, 1}}, links, {0, 0}),
            (std::vector<int>{0, 1, 0}));
}

TEST(CutLabels, RefusesListsOfDifferentLength) {
  EXPECT_THROW(CutLabels({}, {}, {}), ContractViolation);
  EXPECT_THROW(CutLabels({{0, 0}, {0}}, {}, {}), ContractViolation);
  EXPECT_THROW(CutLabels({{0}}, {}, {1.0}), ContractViolation);
}

}  // namespace
}  // namespace graspdb
