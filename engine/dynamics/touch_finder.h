#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** Where the links of a hand touch a solid, or soon will, while both move on a
 little at a time: a probe of a link is looked at again only when the link may
 have come as near as the probe was seen to be away. A copy remembers what was
 seen so far: both may be put back to where they were then. */
class TouchFinder {
 public:
  /** Keeps references to hand and solid. @param near  Nothing farther than
   this, m, is ever asked for. */
  TouchFinder(const HandShape& hand, const Solid& solid, double near)
      : hand_(&hand),
        field_(&solid.field()),
        near_(near),
        watches_(static_cast<size_t>(hand.model().num_links())) {}

  /** What is looked at is at most so far from the solid, m. */
  double reach() const { return kLongestWatch + near_; }

  /** No point of a link that is within reach() of the solid has moved farther
   than `distance`, m, relative to it. */
  void Move(int link, double distance) {
    watches_[static_cast<size_t>(link)].travel += distance;
  }

  /** Calls visit(p_L, distance, nhat_O) for each probe of a link, which has a
   shape, not farther than `near`, m, at most the constructor's: where it is on
   the link, how far from the surface, negative inside, and which way is out of
   the solid. */
  template <class Visitor>
  void Visit(int link, const RigidTransform& X_OL, double near,
             const Visitor& visit) {
    Watch& watch = watches_[static_cast<size_t>(link)];
    if (watch.travel >= watch.until) Fill(link, X_OL, watch);
    const PosedField field(*field_, X_OL);
    // Those that are awake, four at a time.
    Points4 points;
    std::array<Probe*, 4> batch;
    int size = 0;
    const auto look = [&] {
      const Floats4 distances = field(points);
      for (int lane = 0; lane < size; ++lane) {
        Probe& probe = *batch[static_cast<size_t>(lane)];
        const double distance = distances[lane];
        if (distance > near) {
          probe.wake = watch.travel + distance - near_;
          continue;
        }
        const Eigen::Vector3d gradient = field_->CalcGradient(X_OL * probe.p_L);
        const double norm = gradient.norm();
        if (norm > 0.0) visit(probe.p_L, distance, gradient / norm);
      }
      size = 0;
    };
    for (Probe& probe : watch.probes) {
      if (watch.travel < probe.wake) continue;
      points.Set(size, probe.p_L);
      batch[static_cast<size_t>(size++)] = &probe;
      if (size == 4) look();
    }
    if (size > 0) look();
  }

 private:
  // Probes so much farther than asked for are looked at, too, m; where all
  // others are even farther, the link may move on so far at most.
  static constexpr double kWatched = 0.003;
  static constexpr double kLongestWatch = 0.02;

  struct Probe {
    Eigen::Vector3d p_L;
    double wake;  // The link's travel at which it may be near.
  };

  // The probes of a link that may come near, up to some travel of the link.
  struct Watch {
    std::vector<Probe> probes;
    double travel{0.0};
    double until{0.0};
  };

  void Fill(int link, const RigidTransform& X_OL, Watch& watch) const;

  const HandShape* hand_;
  const DistanceField* field_;
  double near_;
  std::vector<Watch> watches_;
};

}  // namespace graspdb
