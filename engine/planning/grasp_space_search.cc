#include "engine/planning/grasp_space_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "engine/base/contract.h"
#include "engine/base/parallel.h"
#include "engine/base/random.h"
#include "engine/hand/hand_sweep.h"
#include "engine/planning/grasp_archive.h"
#include "engine/planning/grasp_coverage.h"
#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/perturbed_copies.h"
#include "engine/planning/start_yield.h"
#include "engine/quality/opposed_contacts.h"

namespace graspdb {
namespace {

// Particles pass through nothing thicker than this, metres.
constexpr double kMoveStep = 0.001;
// The residual, N, that stands for no grip at all in a particle's measure.
constexpr double kNoGrip = 5.0;

// A step in the tangent space of postures: metres, radians, motors.
struct Velocity {
  Eigen::Vector3d shift{Eigen::Vector3d::Zero()};  // Of the hand origin, in O.
  Eigen::Vector3d turn{Eigen::Vector3d::Zero()};   // In H.
  Eigen::VectorXd motors;
};

Velocity CalcDifference(const HandPosture& to, const HandPosture& from) {
  const Eigen::AngleAxisd turn(from.X_OH.rotation.transpose() *
                               to.X_OH.rotation);
  return {to.X_OH.translation - from.X_OH.translation,
          turn.angle() * turn.axis(), to.actuators - from.actuators};
}

// A grasp that holds on the whole object.
struct FoundGrasp {
  Grasp grasp;
  double gripped{0.0};  // Of its disturbed copies.
  bool sure{false};     // Only these are kept.
};

// What particles may start near: an approach's grasps, or else what came
// nearest.
struct Lead {
  int approach{0};
  std::vector<const Grasp*> grasps;
};

struct Particle {
  HandPosture here;
  Velocity velocity;
  HandPosture best;
  double best_measure{std::numeric_limits<double>::infinity()};
  int niche{0};
  int stale{0};                     // Iterations without improvement.
  std::optional<int> led_by;        // The approach of what it started near.
  std::optional<FoundGrasp> found;  // In this iteration.
};

class Swarm {
 public:
  Swarm(const HandShape& hand, const Solid& part, const Solid* whole,
        const ConfigurationSpace& space, const std::vector<HandPosture>& seeds,
        const Parameters& parameters, uint64_t seed)
      : hand_(hand),
        part_(part),
        whole_(whole),
        obstacle_(whole != nullptr ? *whole : part),
        space_(space),
        seeds_(seeds),
        parameters_(parameters),
        swarm_(parameters.swarm),
        seed_(seed),
        constriction_(CalcConstriction(2.0 * swarm_.acceleration)),
        archive_(parameters.distinct),
        niche_best_(kNumApproaches, -1),
        particles_(swarm_.particles) {}

  GraspSearchResult Run(ExecutionContext& context) {
    int iteration = 0;
    for (; iteration < swarm_.iterations && !context.Cancelled() &&
           archive_.size() < swarm_.target_grasps;
         ++iteration) {
      // Everything of one particle depends on its own stream and on the bests
      // of the iteration before, so threads change nothing.
      ParallelFor(swarm_.particles, [&](int i) {
        Random random(DeriveSeed(seed_, {uint64_t(iteration), uint64_t(i)}));
        Particle& particle = particles_[i];
        if (iteration == 0 || particle.stale > swarm_.patience) {
          Restart(particle, iteration, i, random);
        } else {
          Move(particle, random);
        }
        Judge(particle, random.NextBits());
      });
      for (const Particle& particle : particles_) KeepWhatIsFound(particle);
      UpdateNicheBests();
      UpdateLeads();
      context.ReportProgress(
          "swarm",
          std::max(
              static_cast<double>(iteration + 1) / swarm_.iterations,
              static_cast<double>(archive_.size()) / swarm_.target_grasps));
    }
    GraspSearchResult result;
    result.grasps = archive_.MakeSorted();
    result.configurations_tried = iteration * swarm_.particles;
    result.coverage =
        CalcGraspCoverage(result.grasps, part_.mesh_O()).approaches;
    return result;
  }

 private:
  // Near what was found, from the classifier's seeds as long as there are new
  // ones, near them, or from aimed samples around the part.
  void Restart(Particle& particle, int iteration, int index, Random& random) {
    const size_t next =
        static_cast<size_t>(iteration) * swarm_.particles + index;
    const bool may_be_near = random.NextUniform() < swarm_.near_share;
    const bool aimed = random.NextUniform() < swarm_.aimed_share;
    const bool uniform = !aimed && random.NextUniform() < swarm_.uniform_share;
    const auto led_by =
        may_be_near ? DrawByYield(lead_yields_, swarm_.yield_elsewhere, random)
                    : std::nullopt;
    particle.led_by.reset();
    if (led_by) {
      const Lead& lead = leads_[*led_by];
      particle.led_by = lead.approach;
      const Grasp& found = *lead.grasps[static_cast<size_t>(
          random.NextIndex(static_cast<int>(lead.grasps.size())))];
      // It must be near to hold like that one and far to be another.
      const double scale = random.NextUniform();
      particle.here = space_.Perturb(
          {found.configuration.X_OH,
           hand_.model().CalcActuators(found.q_pregrasp)},
          scale * swarm_.max_step, scale * swarm_.max_turn, random);
    } else if (uniform) {
      particle.here = space_.Sample(random);
    } else if (!aimed && next < seeds_.size()) {
      particle.here = seeds_[next];
    } else if (!aimed && !seeds_.empty()) {
      particle.here = space_.Perturb(
          seeds_[random.NextIndex(static_cast<int>(seeds_.size()))],
          swarm_.max_step, swarm_.max_turn, random);
    } else {
      particle.here = space_.SampleAimed(random);
    }
    constexpr int kTries = 100;
    for (int i = 0; i < kTries && !IsFree(particle.here); ++i) {
      particle.here =
          uniform ? space_.Sample(random) : space_.SampleAimed(random);
    }
    particle.velocity.shift = swarm_.max_step * random.NextInUnitBall();
    particle.velocity.turn = swarm_.max_turn * random.NextInUnitBall();
    particle.velocity.motors =
        Eigen::VectorXd::Zero(hand_.model().num_actuators());
    particle.best_measure = std::numeric_limits<double>::infinity();
    particle.best = particle.here;
    particle.stale = 0;
    particle.niche = swarm_.niches ? FindApproach(particle.here.X_OH.rotation *
                                                  hand_.model().approach_H())
                                   : 0;
  }

  bool IsFree(const HandPosture& posture) const {
    const auto X_HL = CalcLinkPoses(
        hand_.model(), hand_.model().CalcCoupledJoints(posture.actuators));
    return FindCollidingLink(hand_, posture.X_OH, X_HL, obstacle_) < 0 &&
           !FindSelfCollision(hand_, X_HL);
  }

  // Clerc's update; the move ends at the first contact.
  void Move(Particle& particle, Random& random) const {
    const HandPosture& leader = niche_best_[particle.niche] >= 0
                                    ? leaders_[niche_best_[particle.niche]]
                                    : particle.best;
    const Velocity own = CalcDifference(particle.best, particle.here);
    const Velocity social = CalcDifference(leader, particle.here);
    const double a = swarm_.acceleration * random.NextUniform();
    const double b = swarm_.acceleration * random.NextUniform();
    Velocity& v = particle.velocity;
    v.shift = constriction_ * (v.shift + a * own.shift + b * social.shift);
    v.turn = constriction_ * (v.turn + a * own.turn + b * social.turn);
    v.motors = constriction_ * (v.motors + a * own.motors + b * social.motors);
    v.shift *= std::min(1.0, swarm_.max_step / std::max(1e-12, v.shift.norm()));
    v.turn *= std::min(1.0, swarm_.max_turn / std::max(1e-12, v.turn.norm()));

    const HandModel& hand = hand_.model();
    HandPosture next = particle.here;
    next.X_OH.translation += v.shift;
    if (v.turn.norm() > 0.0) {
      next.X_OH.rotation = particle.here.X_OH.rotation *
                           Eigen::AngleAxisd(v.turn.norm(), v.turn.normalized())
                               .toRotationMatrix();
    }
    for (int i = 0; i < hand.num_actuators(); ++i) {
      next.actuators[i] =
          std::clamp(particle.here.actuators[i] + v.motors[i],
                     hand.actuators()[i].lower, hand.actuators()[i].upper);
    }
    const HandConfiguration from{
        particle.here.X_OH, hand.CalcCoupledJoints(particle.here.actuators)};
    const HandConfiguration to{next.X_OH,
                               hand.CalcCoupledJoints(next.actuators)};
    const double t = FindFirstContact(hand_, from, to, obstacle_, kMoveStep);
    if (t < 1.0) {
      next.actuators = (1.0 - t) * particle.here.actuators + t * next.actuators;
      next.X_OH = Interpolate(from, to, t).X_OH;
      // What stopped the particle takes its momentum.
      v.shift.setZero();
      v.turn.setZero();
      v.motors.setZero();
    }
    particle.here = next;
  }

  // Closes the fingers; remembers the grasp if it holds, and the place if it is
  // the particle's best.
  void Judge(Particle& particle, uint64_t seed) const {
    particle.found.reset();
    ++particle.stale;
    const Eigen::VectorXd q =
        hand_.model().CalcCoupledJoints(particle.here.actuators);
    const EvaluatedGrasp evaluated =
        CloseAndJudge(hand_, particle.here.X_OH, q, part_, parameters_,
                      Precision::kEstimated);
    if (evaluated.failure == GraspFailure::kPalmCollision ||
        evaluated.failure == GraspFailure::kFingerCollision) {
      return;
    }
    const double grip =
        evaluated.ok() && UsesGrip()
            ? std::min(kNoGrip, CalcGrip(hand_, evaluated.grasp,
                                         obstacle_.mass(), parameters_))
            : kNoGrip;
    const bool promising =
        evaluated.ok() &&
        (swarm_.min_grip == 0.0 || grip <= parameters_.grip.max_residual);
    if (promising) {
      particle.found = FindGrasp(particle.here.X_OH, q, seed);
      // Others would gather there in vain.
      const bool kept = particle.found && particle.found->sure;
      if (!kept && swarm_.shun_failed) return;
    }
    const double measure =
        CalcHybrid(hand_, evaluated.grasp, part_, parameters_) +
        swarm_.grip_weight * grip;
    if (measure < particle.best_measure) {
      particle.best_measure = measure;
      particle.best = particle.here;
      particle.stale = 0;
    }
  }

  // The grasp that the hand closes to, if it is new and holds on the whole.
  std::optional<FoundGrasp> FindGrasp(const RigidTransform& X_OH,
                                      const Eigen::VectorXd& q,
                                      uint64_t seed) const {
    const EvaluatedGrasp evaluated =
        CloseAndJudge(hand_, X_OH, q, part_, parameters_);
    if (!evaluated.ok() || !archive_.Wants(evaluated.grasp)) return {};
    for (const Grasp& grasp :
         {TimeFingers(hand_, evaluated.grasp, part_, parameters_),
          evaluated.grasp}) {
      // The rest of the object may be in the way of open fingers.
      if (!IsReachable(hand_, grasp, obstacle_)) continue;
      if (!HoldsOnWhole(grasp)) return {};
      const double gripped = CalcGripped(grasp, seed);
      return FoundGrasp{grasp, gripped, gripped >= swarm_.min_grip};
    }
    return {};
  }

  // On the whole object the same contacts must hold, not others that happen to.
  bool HoldsOnWhole(const Grasp& grasp) const {
    if (whole_ == nullptr) return true;
    const EvaluatedGrasp on_whole =
        CloseAndJudge(hand_, grasp.configuration.X_OH, grasp.q_pregrasp,
                      *whole_, parameters_);
    return on_whole.ok() &&
           ReachesOpposedTargets(on_whole.grasp.contacts, grasp.contacts,
                                 parameters_.transfer.max_target_distance,
                                 parameters_.transfer.min_opposed_contacts);
  }

  bool UsesGrip() const {
    return swarm_.min_grip > 0.0 || swarm_.grip_weight > 0.0;
  }

  // The share of its disturbed copies, or less when that is too small.
  double CalcGripped(const Grasp& grasp, uint64_t seed) const {
    if (swarm_.min_grip == 0.0) return 0.0;
    return CalcRobustness(hand_, grasp, obstacle_, parameters_, seed,
                          {.copies = swarm_.grip_copies,
                           .pushed = false,
                           .least_gripped = swarm_.min_grip})
        .gripped;
  }

  void KeepWhatIsFound(const Particle& particle) {
    const int size_before = archive_.size();
    if (particle.found) Keep(*particle.found);
    if (!particle.led_by) return;
    StartYield& yield = yields_[*particle.led_by];
    ++yield.tries;
    if (archive_.size() > size_before) ++yield.gains;
  }

  // Sure ones are kept; of the others, of each approach, the surest.
  void Keep(const FoundGrasp& found) {
    if (found.sure) {
      archive_.Insert(found.grasp);
    } else if (found.gripped > 0.0) {
      auto& almost = almost_[FindApproach(found.grasp.approach_O)];
      if (!almost.empty() && found.gripped < almost.front().gripped) return;
      if (!almost.empty() && found.gripped > almost.front().gripped) {
        almost.clear();
      }
      almost.push_back(found);
    }
  }

  // Points into what Keep() changes: to be called after it.
  void UpdateLeads() {
    std::map<int, std::vector<const Grasp*>> niches;
    for (const Grasp& grasp : archive_.grasps()) {
      niches[FindApproach(grasp.approach_O)].push_back(&grasp);
    }
    for (const auto& [niche, almost] : almost_) {
      std::vector<const Grasp*>& leads = niches[niche];
      if (!leads.empty()) continue;
      for (const FoundGrasp& found : almost) leads.push_back(&found.grasp);
    }
    leads_.clear();
    lead_yields_.clear();
    for (auto& [niche, grasps] : niches) {
      leads_.push_back({niche, std::move(grasps)});
      lead_yields_.push_back(CalcYield(yields_[niche], swarm_.expected_yield));
    }
  }

  void UpdateNicheBests() {
    std::fill(niche_best_.begin(), niche_best_.end(), -1);
    leaders_.resize(particles_.size());
    for (int i = 0; i < static_cast<int>(particles_.size()); ++i) {
      leaders_[i] = particles_[i].best;
      int& best = niche_best_[particles_[i].niche];
      if (best < 0 ||
          particles_[i].best_measure < particles_[best].best_measure) {
        best = i;
      }
    }
  }

  const HandShape& hand_;
  const Solid& part_;
  const Solid* whole_;
  const Solid& obstacle_;  // What the hand must not run into.
  const ConfigurationSpace& space_;
  const std::vector<HandPosture>& seeds_;
  const Parameters& parameters_;
  const SwarmParameters& swarm_;
  const uint64_t seed_;
  const double constriction_;
  GraspArchive archive_;
  // For each approach, the grasps that came nearest to being sure.
  std::map<int, std::vector<FoundGrasp>> almost_;
  std::vector<Lead> leads_;
  std::vector<double> lead_yields_;   // Of each lead.
  std::map<int, StartYield> yields_;  // Of each approach that ever led one.
  std::vector<int> niche_best_;       // Particle with the best measure, or -1.
  std::vector<Particle> particles_;
  std::vector<HandPosture> leaders_;  // Each particle's best so far.
};

}  // namespace

double CalcConstriction(double phi) {
  GRASPDB_EXPECTS(phi > 4.0);
  return 2.0 / std::abs(2.0 - phi - std::sqrt(phi * phi - 4.0 * phi));
}

GraspSearchResult SearchGraspSpace(const HandShape& hand, const Solid& part,
                                   const Solid* whole,
                                   const ConfigurationSpace& space,
                                   const std::vector<HandPosture>& seeds,
                                   const Parameters& parameters, uint64_t seed,
                                   ExecutionContext& context) {
  return Swarm(hand, part, whole, space, seeds, parameters, seed).Run(context);
}

}  // namespace graspdb
