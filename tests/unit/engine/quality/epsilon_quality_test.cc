#include "engine/quality/epsilon_quality.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/reference/qhull_wrenches.h"

namespace graspdb {
namespace {

MassProperties MakeUnitMass() {
  MassProperties mass;
  mass.max_radius = 1.0;
  return mass;
}

// Contacts on the unit sphere with normals that lean up to 30 degrees.
std::vector<Contact> MakeRandomContacts(int count, Random& random) {
  std::vector<Contact> contacts;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = random.NextUnitVector();
    contacts.push_back({0, p, random.NextRotationWithin(M_PI / 6) * p, 0.0});
  }
  return contacts;
}

// Two jaws 40 mm apart press flat on a block, each with four corners.
Wrenches MakePinchWrenches(const std::array<double, 2>& ys,
                           const std::array<double, 2>& zs) {
  std::vector<Contact> contacts;
  for (const double x : {-0.02, 0.02}) {
    for (const double y : ys) {
      for (const double z : zs) {
        contacts.push_back(
            {1, {x, y, z}, {x > 0 ? 1.0 : -1.0, 0.0, 0.0}, 0.0001});
      }
    }
  }
  MassProperties mass;
  mass.max_radius = 0.035;
  return CalcContactWrenches(contacts, mass, {});
}

TEST(EpsilonQuality, OfACrossPolytopeIsItsInradius) {
  // ± the unit vectors: facets x1 ± … ± x6 = 1, at distance 1/√6; the volume
  // is 2⁶/6!.
  Wrenches wrenches(6, 12);
  wrenches << Eigen::Matrix<double, 6, 6>::Identity(),
      -Eigen::Matrix<double, 6, 6>::Identity();
  EXPECT_NEAR(CalcEpsilonQuality(wrenches), 1.0 / std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(CalcWrenchVolume(wrenches), 64.0 / 720.0, 1e-12);
}

TEST(EpsilonQuality, OfACubeIsHalfItsEdgeThoughItsFacetsAreNoSimplices) {
  Wrenches wrenches(6, 64);
  for (int i = 0; i < 64; ++i) {
    for (int k = 0; k < 6; ++k) wrenches(k, i) = (i >> k & 1) ? 1.0 : -1.0;
  }
  EXPECT_NEAR(CalcEpsilonQuality(wrenches), 1.0, 1e-9);
  EXPECT_NEAR(CalcWrenchVolume(wrenches), 64.0, 1e-6);
}

TEST(EpsilonQuality, OfAShiftedCubeIsTheNearestFace) {
  Wrenches wrenches(6, 64);
  for (int i = 0; i < 64; ++i) {
    for (int k = 0; k < 6; ++k) wrenches(k, i) = (i >> k & 1) ? 1.0 : -1.0;
  }
  wrenches.row(2).array() += 0.7;
  EXPECT_NEAR(CalcEpsilonQuality(wrenches), 0.3, 1e-9);
  wrenches.row(2).array() += 0.7;
  EXPECT_NEAR(CalcEpsilonQuality(wrenches), -0.4, 1e-9);
}

TEST(EpsilonQuality, OfTwoContactsIsNegativeSinceTheyTurnAboutTheirLine) {
  const std::vector<Contact> contacts{{0, {1, 0, 0}, {1, 0, 0}, 0.0},
                                      {1, {-1, 0, 0}, {-1, 0, 0}, 0.0}};
  const Wrenches wrenches = CalcContactWrenches(contacts, MakeUnitMass(), {});
  EXPECT_EQ(CalcEpsilonQuality(wrenches), -1.0);
  EXPECT_EQ(CalcWrenchVolume(wrenches), 0.0);
}

TEST(EpsilonQuality, AgreesWithQhullOnThousandsOfRandomContactSets) {
  Random random(11);
  int stable = 0;
  for (int i = 0; i < 2000; ++i) {
    const int count = 3 + random.NextIndex(3);
    ContactParameters parameters;
    parameters.friction = random.NextUniform(0.2, 1.0);
    const Wrenches wrenches = CalcContactWrenches(
        MakeRandomContacts(count, random), MakeUnitMass(), parameters);
    const double ours = CalcEpsilonQuality(wrenches);
    const double qhull = CalcEpsilonByQhull(wrenches);
    ASSERT_EQ(ours > 1e-9, qhull > 1e-9) << i << " " << ours << " " << qhull;
    if (qhull > 1e-9) {
      ASSERT_NEAR(ours, qhull, 1e-9) << i;
      ++stable;
    }
  }
  EXPECT_GT(stable, 300);
}

TEST(WrenchVolume, AgreesWithQhull) {
  Random random(12);
  for (int i = 0; i < 60; ++i) {
    const Wrenches wrenches = CalcContactWrenches(
        MakeRandomContacts(3 + i % 5, random), MakeUnitMass(), {});
    const double qhull = CalcVolumeByQhull(wrenches);
    EXPECT_NEAR(CalcWrenchVolume(wrenches), qhull, 1e-6 * qhull) << i;
  }
}

// Eight contacts at the corners of two flat patches: many coplanar wrenches,
// on which the polytope once grew until memory ran out.
TEST(WrenchVolume, OfTwoFlatPatchesIsFoundOrGivenUp) {
  const Wrenches wrenches =
      MakePinchWrenches({-0.00999, 0.00998}, {-0.0098, 0.0188});
  EXPECT_GE(CalcWrenchVolume(wrenches), 0.0);
  EXPECT_GT(CalcEpsilonQuality(wrenches), 0.0);
}

// Regression: where many wrenches lie in one plane, but for rounding, walking
// around a ridge did not end.
TEST(EpsilonQuality, OfTwoFlatPatchesDoesNotDependOnTheLastDigits) {
  const Wrenches wrenches = MakePinchWrenches({-0.01, 0.01}, {-0.015, 0.005});
  const double epsilon = CalcEpsilonQuality(wrenches);
  EXPECT_GT(epsilon, 0.01);
  Random random(8);
  for (double shake = 1e-16; shake < 1e-9; shake *= 2.0) {
    for (int i = 0; i < 20; ++i) {
      Wrenches shaken = wrenches;
      for (double& w : shaken.reshaped()) {
        w += random.NextUniform(-shake, shake);
      }
      ASSERT_NEAR(CalcEpsilonQuality(shaken), epsilon, 1e-9 + 10.0 * shake);
    }
  }
}

TEST(EpsilonQuality, GrowsWithFrictionAndWithMoreContacts) {
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Contact> contacts = MakeRandomContacts(5, random);
    ContactParameters low, high;
    low.friction = 0.3;
    high.friction = 0.6;
    const double at_low =
        CalcEpsilonQuality(CalcContactWrenches(contacts, MakeUnitMass(), low));
    const double at_high =
        CalcEpsilonQuality(CalcContactWrenches(contacts, MakeUnitMass(), high));
    const double with_fewer = CalcEpsilonQuality(CalcContactWrenches(
        {contacts.begin(), contacts.end() - 1}, MakeUnitMass(), high));
    EXPECT_GE(at_high, at_low > 0.0 ? at_low - 1e-9 : -1.0);
    EXPECT_GE(at_high, with_fewer > 0.0 ? with_fewer - 1e-9 : -1.0);
  }
}

TEST(FrictionCone, EdgesHaveUnitNormalComponentAndTheFrictionsSlope) {
  const Eigen::Vector3d nhat = Eigen::Vector3d(1, 2, -2).normalized();
  const auto edges = CalcFrictionConeEdges(nhat, 0.5, 8);
  ASSERT_EQ(edges.size(), 8u);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& f : edges) {
    EXPECT_NEAR(f.dot(nhat), 1.0, 1e-15);
    EXPECT_NEAR((f - nhat).norm(), 0.5, 1e-15);
    sum += f;
  }
  EXPECT_NEAR((sum - 8 * nhat).norm(), 0.0, 1e-14);
}

}  // namespace
}  // namespace graspdb
