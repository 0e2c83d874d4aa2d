#include "engine/hand/hand_sweep.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

bool Collides(const HandShape& hand, const HandConfiguration& c,
              const Solid& solid) {
  const auto X_HL = CalcLinkPoses(hand.model(), c.q);
  return FindCollidingLink(hand, c.X_OH, X_HL, solid) >= 0 ||
         FindSelfCollision(hand, X_HL).has_value();
}

HandConfiguration DrawConfiguration(const HandShape& hand, double radius,
                                    Random& random) {
  const HandModel& model = hand.model();
  Eigen::VectorXd motors(model.num_actuators());
  for (int a = 0; a < model.num_actuators(); ++a) {
    motors[a] = random.NextUniform(model.actuators()[a].lower,
                                   model.actuators()[a].upper);
  }
  return {{random.NextRotation(), radius * random.NextUnitVector()},
          model.CalcCoupledJoints(motors)};
}

TEST(HandSweep, StopsWhereAHandComputedContactIs) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}));
  // The base's top, 20 mm above its origin, approaches the box's lower side at
  // z = -0.02 with the jaws on both sides: contact at z = -0.04, that is after
  // 60 of 100 mm.
  HandConfiguration from{{}, Eigen::Vector2d::Zero()};
  from.X_OH.translation.z() = -0.1;
  HandConfiguration to = from;
  to.X_OH.translation.z() = 0.0;
  EXPECT_NEAR(FindFirstContact(gripper, from, to, box, 0.0005), 0.6, 1e-3);
}

TEST(HandSweep, AFreeWayIsFreeToItsEnd) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}));
  HandConfiguration from{{}, Eigen::Vector2d::Zero()};
  from.X_OH.translation.z() = -0.2;
  HandConfiguration to = from;
  to.X_OH.translation.x() = 0.1;
  EXPECT_EQ(FindFirstContact(gripper, from, to, box, 0.0005), 1.0);
}

// A plate of 1 mm must not be jumped over, however long the way.
TEST(HandSweep, DoesNotTunnelThroughAThinPlate) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid plate(workshop::MakeBox({0.3, 0.3, 0.001}, 4));
  HandConfiguration from{{}, Eigen::Vector2d::Zero()};
  from.X_OH.translation.z() = -0.5;
  HandConfiguration to = from;
  to.X_OH.translation.z() = 0.5;
  // The jaws reach 80 mm above the origin; the plate's lower side is at
  // z = -0.0005: after 0.5 - 0.08 - 0.0005 of one metre.
  EXPECT_NEAR(FindFirstContact(gripper, from, to, plate, 0.0005), 0.4195, 1e-3);
}

// Against sampling the same motion densely. GRASPDB_SWEEPS raises the number.
TEST(HandSweep, MissesNothingThatDenseSamplingFinds) {
  const char* wanted = std::getenv("GRASPDB_SWEEPS");
  const int sweeps = wanted != nullptr ? std::atoi(wanted) : 60;
  constexpr int kSteps = 1000;
  const HandShape hand(workshop::LoadBarrettHand());
  const Solid box(workshop::MakeBox({0.05, 0.03, 0.08}, 4));
  Random random(41);
  int motions = 0, contacts = 0;
  while (motions < sweeps) {
    const HandConfiguration from = DrawConfiguration(hand, 0.25, random);
    if (Collides(hand, from, box)) continue;
    const HandConfiguration to = DrawConfiguration(hand, 0.1, random);
    ++motions;
    const double t = FindFirstContact(hand, from, to, box, 0.0002);
    EXPECT_FALSE(Collides(hand, Interpolate(from, to, t), box));
    for (int i = 0; i <= kSteps; ++i) {
      const double s = static_cast<double>(i) / kSteps;
      if (!Collides(hand, Interpolate(from, to, s), box)) continue;
      EXPECT_LT(t, s) << "motion " << motions;
      // The last free dense sample bounds the moment from below.
      EXPECT_GT(t, s - 1.0 / kSteps - 1e-4) << "motion " << motions;
      ++contacts;
      break;
    }
  }
  EXPECT_GT(contacts, sweeps / 4);
}

}  // namespace
}  // namespace graspdb
