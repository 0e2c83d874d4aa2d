#include "engine/transfer/local_replanner.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <utility>

#include "engine/base/random.h"
#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/perturbed_copies.h"
#include "engine/transfer/replan_objective.h"

namespace graspdb {
namespace {

// A start whose open hand collides draws back in these steps, metres.
constexpr double kRetreatStep = 0.0025;
// Annealings that follow one another draw from nearer and from farther around,
// shares of the trust region.
constexpr double kReaches[] = {1.0, 0.5, 1.5};
// A share of copies below which it does not matter how many there are.
constexpr double kLeastGrip = 0.05;
// Samples around the best grasp come from farther and from nearer, likewise.
constexpr double kClimbReaches[] = {1.5, 0.6};
// The residual, N, that stands for no grip at all in the objective.
constexpr double kNoGrip = 5.0;

TransferOutcome ToOutcome(GraspFailure failure) {
  switch (failure) {
    case GraspFailure::kNone:
      return TransferOutcome::kSucceeded;
    case GraspFailure::kPalmCollision:
      return TransferOutcome::kPalmCollision;
    case GraspFailure::kFingerCollision:
      return TransferOutcome::kFingerCollision;
    case GraspFailure::kNoContact:
      return TransferOutcome::kNoContact;
    case GraspFailure::kUnstable:
      return TransferOutcome::kUnstable;
    case GraspFailure::kUnreachable:
      return TransferOutcome::kUnreachable;
  }
  return TransferOutcome::kUnstable;
}

// T* X_EH and, if wanted, the wrist that brings the contacts to their targets.
std::vector<RigidTransform> MakeStarts(const HandModel& hand,
                                       const TransferTask& task,
                                       const Parameters& parameters) {
  std::vector<RigidTransform> starts{task.X_NH};
  if (parameters.replan.aimed_starts) {
    starts.push_back(Confine(FitWrist(hand, task), task, parameters.transfer));
  }
  return starts;
}

bool PalmCollides(const HandShape& hand, const RigidTransform& X_NH,
                  const Eigen::VectorXd& q, const Solid& solid) {
  return hand.link(0) &&
         LinkCollides(*hand.link(0), X_NH * CalcLinkPose(hand.model(), q, 0),
                      solid);
}

// Annealing of one grasp on one solid, and the climb from what it finds.
class Replanner {
 public:
  Replanner(const HandShape& hand, const TransferTask& task, const Solid& solid,
            const Parameters& parameters, uint64_t seed,
            const ReplanOptions& options)
      : hand_(hand),
        task_(task),
        solid_(solid),
        parameters_(parameters),
        replan_(parameters.replan),
        options_(options),
        copies_(hand, solid, parameters, seed, parameters.replan.grip_copies),
        random_(seed) {}

  // Of the best start, with nothing looked at closely.
  double RateStarts(const std::vector<RigidTransform>& starts) {
    keeps_ = false;
    return RankStarts(starts, 0).front().value;
  }

  ReplanResult Run(const std::vector<RigidTransform>& starts) {
    keeps_ = !options_.until_sure;
    const std::vector<Rated> ranked = RankStarts(starts, replan_.refits);
    keeps_ = true;
    if (options_.until_sure) TryInOrder(ranked);
    const double likely = std::min(replan_.likely_grip, replan_.enough_grip);
    std::optional<Kept> best;
    for (int i = 0; i < options_.searches; ++i) {
      // The first one also knows what the starts hold.
      if (i > 0) best_.reset();
      if (!IsContent()) Search(ranked);
      if (best_ && (!best || best_->merit > best->merit)) best = best_;
      if (!best_ || !IsWanted() || !UsesGrip() || best->share >= likely) break;
    }
    if (!best) return {furthest_, std::nullopt};
    return {TransferOutcome::kSucceeded, std::move(best->grasp)};
  }

 private:
  bool IsWanted() const { return !options_.wanted || options_.wanted(); }

  // Whether what there is will do.
  bool IsContent() const {
    if (!options_.until_sure || !best_) return false;
    return UsesGrip() ? best_->merit.sure >= replan_.enough_grip
                      : best_->merit.epsilon > options_.epsilon_to_beat;
  }

  struct Sample {
    RigidTransform X_NH;
    Eigen::VectorXd motors;  // Before closing.
  };

  struct Rated {
    Sample sample;
    double value;  // Of Eq. (6).
  };

  // What chooses between grasps: how sure the grip is, then, as long as that is
  // not enough, how well the motors' forces balance, then eps.
  struct Merit {
    double sure{-2.0};  // Share of copies held, up to what is enough, less what
                        // it costs not to beat open-close; -2: no grasp.
    double unbalanced{0.0};  // Minus CalcGrip(); 0 when the grip is enough.
    double epsilon{0.0};

    auto operator<=>(const Merit&) const = default;
  };

  struct Kept {
    Grasp grasp;
    Merit merit;
    double share;   // Of the copies that are held.
    Sample sample;  // How it came about.
  };

  // Anneals until there is a grasp, one start after the other, farther on each
  // time it is called, and climbs from there.
  void Search(const std::vector<Rated>& ranked) {
    int annealings = 0;
    do {
      Anneal(ranked[cycle_ % ranked.size()], kReaches[cycle_ % 3]);
      ++cycle_;
    } while (!best_ && ++annealings < replan_.cycles && IsWanted());
    if (best_ && UsesGrip()) Climb();
  }

  // The best one first; an aimed one draws back where the open hand collides.
  std::vector<Rated> RankStarts(const std::vector<RigidTransform>& starts,
                                int refits) {
    std::vector<Rated> ranked;
    for (const RigidTransform& X_NH : starts) {
      Sample sample{X_NH, hand_.model().CalcActuators(task_.q_pregrasp)};
      TransferTask closed = task_;
      for (int refit = 0; refit <= refits; ++refit) {
        if (replan_.aimed_starts) DrawBack(sample);
        ranked.push_back({sample, Evaluate(sample, &closed.q)});
        if (!replan_.aimed_starts) break;
        // The fingers have met a surface of another size: fit what they are.
        sample.X_NH = Confine(FitWrist(hand_.model(), closed), task_,
                              parameters_.transfer);
      }
    }
    std::stable_sort(
        ranked.begin(), ranked.end(),
        [](const Rated& a, const Rated& b) { return a.value < b.value; });
    return ranked;
  }

  // Looks closely at starts until one will do.
  void TryInOrder(const std::vector<Rated>& ranked) {
    for (const Rated& start : ranked) {
      if (IsContent()) return;
      Evaluate(start.sample);
    }
  }

  // Against the approach, as far as the transfer's limits allow.
  void DrawBack(Sample& sample) const {
    const Eigen::Vector3d approach =
        sample.X_NH.rotation * hand_.model().approach_H();
    Sample drawn = sample;
    for (double retreat = 0.0; retreat <= parameters_.transfer.max_translation;
         retreat += kRetreatStep) {
      drawn.X_NH.translation = sample.X_NH.translation - retreat * approach;
      drawn.X_NH = Confine(drawn.X_NH, task_, parameters_.transfer);
      if (IsFree(drawn)) {
        sample = drawn;
        return;
      }
    }
  }

  bool IsFree(const Sample& sample) const {
    const auto X_HL = CalcLinkPoses(
        hand_.model(), hand_.model().CalcCoupledJoints(sample.motors));
    return EstimateCollidingLink(hand_, sample.X_NH, X_HL, solid_) < 0;
  }

  // Simulated annealing, as printed.
  void Anneal(const Rated& start, double reach) {
    Sample here = start.sample;
    double here_value = start.value;
    int since_gain = 0;
    for (int i = 0; i < replan_.iterations && since_gain < replan_.patience &&
                    IsWanted() && !IsContent();
         ++i) {
      const double cooling = static_cast<double>(i) / replan_.iterations;
      const int gains_before = num_gains_;
      const std::optional<Sample> next =
          DrawFree(here, reach * (1.0 - 0.8 * cooling));
      if (next) {
        const double value = Evaluate(*next);
        const double temperature =
            replan_.initial_temperature *
            std::pow(replan_.final_temperature / replan_.initial_temperature,
                     cooling);
        if (value < here_value ||
            random_.NextUniform() <
                std::exp((here_value - value) / temperature)) {
          here = *next;
          here_value = value;
        }
      }
      // Patience counts once there is something to be content with.
      since_gain = best_ && num_gains_ == gains_before ? since_gain + 1 : 0;
    }
  }

  // From the best grasp to better ones around it; once it is sure enough, as
  // long as eps grows.
  void Climb() {
    int since_gain = 0;
    for (int i = 0; i < options_.climb_samples && IsWanted() && !IsContent();
         ++i) {
      if (best_->merit.sure >= replan_.enough_grip &&
          since_gain >= replan_.patience) {
        break;
      }
      const int gains_before = num_gains_;
      const auto next = DrawFree(best_->sample, kClimbReaches[i % 2]);
      if (next) Evaluate(*next);
      since_gain = num_gains_ == gains_before ? since_gain + 1 : 0;
    }
  }

  // Of the best so far.
  Merit BestMerit() const { return best_ ? best_->merit : Merit{}; }

  double CalcCost(double epsilon) const {
    return epsilon > options_.epsilon_to_beat ? 0.0 : replan_.behind_cost;
  }

  bool UsesGrip() const { return options_.grip && replan_.grip_copies > 0; }

  // What a grasp must hold to be better than the best.
  double CalcShareToBeat(const Grasp& grasp) const {
    return std::max(kLeastGrip,
                    BestMerit().sure + CalcCost(grasp.quality.epsilon));
  }

  // @param share  Of the copies that are held.
  Merit MakeMerit(const Grasp& grasp, double share) const {
    const double epsilon = grasp.quality.epsilon;
    Merit merit{0.0, 0.0, epsilon};
    if (!UsesGrip()) return merit;
    merit.sure = std::min(share, replan_.enough_grip) - CalcCost(epsilon);
    if (share < replan_.enough_grip) {
      merit.unbalanced = -CalcGrip(hand_, grasp, solid_.mass(), parameters_);
    }
    return merit;
  }

  // Whether it is worth a closer look.
  bool MayBeBetter(const Grasp& grasp) const {
    const double epsilon = grasp.quality.epsilon;
    if (!best_ || epsilon > best_->merit.epsilon) return true;
    return UsesGrip() &&
           best_->merit.sure < replan_.enough_grip - CalcCost(epsilon);
  }

  // Closes the fingers and keeps the grasp if it is the best that counts. The
  // value of Eq. (6), or infinity in collision.
  // @param[out] q_closed  When given, the joints after closing, if any.
  double Evaluate(const Sample& sample, Eigen::VectorXd* q_closed = nullptr) {
    const Eigen::VectorXd q = hand_.model().CalcCoupledJoints(sample.motors);
    const EvaluatedGrasp evaluated = CloseAndJudge(
        hand_, sample.X_NH, q, solid_, parameters_, Precision::kEstimated);
    Note(ToOutcome(evaluated.failure));
    if (evaluated.failure == GraspFailure::kPalmCollision ||
        evaluated.failure == GraspFailure::kFingerCollision) {
      return std::numeric_limits<double>::infinity();
    }
    const Grasp& grasp = evaluated.grasp;
    if (q_closed != nullptr) *q_closed = grasp.configuration.q;
    const double grip =
        evaluated.ok() && replan_.grip_weight > 0.0
            ? std::min(kNoGrip,
                       CalcGrip(hand_, grasp, solid_.mass(), parameters_))
            : kNoGrip;
    if (keeps_ && evaluated.ok() && MayBeBetter(grasp) && Counts(grasp)) {
      Consider(sample, grasp);
    }
    return CalcReplanObjective(CalcGoals(grasp), grasp.configuration.q, task_.q,
                               grasp.quality.epsilon,
                               parameters_.hybrid.epsilon_floor, replan_) +
           replan_.grip_weight * grip;
  }

  // Keeps the grasp if it is the best that counts: by estimate first, since
  // what is kept must be exact.
  void Consider(const Sample& sample, const Grasp& estimate) {
    const Grasp timed = TimeFingers(hand_, estimate, solid_, parameters_,
                                    Precision::kEstimated);
    const double share = CalcShare(timed);
    if (!(MakeMerit(timed, share) > BestMerit())) return;
    if (Keep(sample, timed.q_pregrasp, share)) return;
    // Fingers that are open otherwise may be free, or reach it, exactly.
    const EvaluatedGrasp exact = CloseAndJudge(
        hand_, sample.X_NH, estimate.q_pregrasp, solid_, parameters_);
    Note(ToOutcome(exact.failure));
    if (!exact.ok()) return;
    const Grasp other = TimeFingers(hand_, exact.grasp, solid_, parameters_);
    Keep(sample, other.q_pregrasp, CalcShare(other));
  }

  double CalcShare(const Grasp& grasp) {
    return UsesGrip() ? copies_.CalcGripped(grasp, CalcShareToBeat(grasp))
                      : 0.0;
  }

  bool Keep(const Sample& sample, const Eigen::VectorXd& q_pregrasp,
            double share) {
    const EvaluatedGrasp exact =
        CloseAndJudge(hand_, sample.X_NH, q_pregrasp, solid_, parameters_);
    Note(ToOutcome(exact.failure));
    if (!exact.ok() || !Counts(exact.grasp)) return false;
    const Merit merit = MakeMerit(exact.grasp, share);
    if (!(merit > BestMerit()) || !CanBeReached(exact.grasp)) return false;
    best_ = {exact.grasp, merit, share, sample};
    ++num_gains_;
    return true;
  }

  bool Counts(const Grasp& grasp) {
    if (IsTransferOf(task_, grasp, parameters_.transfer)) return true;
    Note(TransferOutcome::kTooFar);
    return false;
  }

  bool CanBeReached(const Grasp& grasp) {
    if (IsReachable(hand_, grasp, solid_)) return true;
    Note(TransferOutcome::kUnreachable);
    return false;
  }

  // Where the source's contact points on the fingers are now.
  std::vector<ContactGoal> CalcGoals(const Grasp& grasp) const {
    const auto X_HL = CalcLinkPoses(hand_.model(), grasp.configuration.q);
    std::vector<ContactGoal> goals;
    for (const ContactTarget& target : task_.targets) {
      const RigidTransform X_NL = grasp.configuration.X_OH * X_HL[target.link];
      goals.push_back({X_NL * target.p_L, X_NL.rotation * target.nhat_L,
                       target.p_N, target.nhat_N});
    }
    return goals;
  }

  // A free sample near `around`; when the first collides, the paper adds more.
  std::optional<Sample> DrawFree(const Sample& around, double share) {
    for (int i = 0; i <= replan_.extra_samples; ++i) {
      const Sample sample = Draw(around, share);
      if (IsFree(sample)) return sample;
    }
    return std::nullopt;
  }

  Sample Draw(const Sample& around, double share) {
    const HandModel& hand = hand_.model();
    Sample sample = around;
    const Eigen::VectorXd example = hand.CalcActuators(task_.q_pregrasp);
    for (int a = 0; a < hand.num_actuators(); ++a) {
      const HandActuator& actuator = hand.actuators()[a];
      const double low =
          std::max(actuator.lower, example[a] - replan_.joint_range);
      const double up =
          std::min(actuator.upper, example[a] + replan_.joint_range);
      sample.motors[a] =
          std::clamp(around.motors[a] + share * replan_.joint_range *
                                            random_.NextUniform(-1.0, 1.0),
                     low, std::max(low, up));
    }
    if (replan_.move_wrist) {
      sample.X_NH.translation +=
          share * replan_.trust_translation * random_.NextInUnitBall();
      sample.X_NH.rotation =
          around.X_NH.rotation *
          random_.NextRotationWithin(share * replan_.trust_rotation);
      sample.X_NH = Confine(sample.X_NH, task_, parameters_.transfer);
    }
    return sample;
  }

  // Of all that went wrong, what came nearest to success is the reason given.
  void Note(TransferOutcome outcome) {
    if (outcome != TransferOutcome::kSucceeded && outcome > furthest_) {
      furthest_ = outcome;
    }
  }

  const HandShape& hand_;
  const TransferTask& task_;
  const Solid& solid_;
  const Parameters& parameters_;
  const ReplanParameters& replan_;
  const ReplanOptions options_;
  bool keeps_{true};  // Whether Evaluate() keeps the best.
  PerturbedCopies copies_;
  Random random_;
  std::optional<Kept> best_;  // Of this search.
  int num_gains_{0};
  int cycle_{0};  // Annealings so far.
  TransferOutcome furthest_{TransferOutcome::kPalmCollision};
};

}  // namespace

ReplanResult Replan(const HandShape& hand, const TransferTask& task,
                    const Solid& solid, const Parameters& parameters,
                    uint64_t seed, const ReplanOptions& options) {
  return Replanner(hand, task, solid, parameters, seed, options)
      .Run(MakeStarts(hand.model(), task, parameters));
}

double CalcPromise(const HandShape& hand, const TransferTask& task,
                   const Solid& solid, const Parameters& parameters) {
  return Replanner(hand, task, solid, parameters, 0, {})
      .RateStarts(MakeStarts(hand.model(), task, parameters));
}

ReplanResult Assemble(const HandShape& hand, const TransferTask& task,
                      const Grasp& transferred, const Solid& whole,
                      const Parameters& parameters, uint64_t seed,
                      const ReplanOptions& options) {
  TransferTask on_whole = task;
  on_whole.q_pregrasp = transferred.q_pregrasp;
  std::vector<RigidTransform> starts{transferred.configuration.X_OH};
  if (parameters.replan.aimed_starts) {
    for (const auto& X_NH : MakeStarts(hand.model(), task, parameters)) {
      starts.push_back(X_NH);
    }
  } else if (PalmCollides(hand, starts[0], transferred.q_pregrasp, whole)) {
    return {TransferOutcome::kPalmCollision, std::nullopt};
  }
  return Replanner(hand, on_whole, whole, parameters, seed, options)
      .Run(starts);
}

}  // namespace graspdb
