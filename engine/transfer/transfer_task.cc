#include "engine/transfer/transfer_task.h"

#include "engine/quality/opposed_contacts.h"

namespace graspdb {
namespace {

// Of the transfer's limits, so that rounding does not lead beyond them.
constexpr double kWithinLimits = 0.98;
// How far the hand's frame reaches when the wrist is fitted, metres.
constexpr double kFrameLength = 0.05;

}  // namespace

bool IsTransferOf(const TransferTask& task, const Grasp& grasp,
                  const TransferLimits& limits) {
  const RigidTransform& X_NH = grasp.configuration.X_OH;
  if ((X_NH.translation - task.X_NH.translation).norm() >
          limits.max_translation ||
      CalcRotationAngle(X_NH.rotation.transpose() * task.X_NH.rotation) >
          limits.max_rotation) {
    return false;
  }
  std::vector<Contact> targets;
  for (const ContactTarget& target : task.targets) {
    targets.push_back({target.link, target.p_N, target.nhat_N, 0.0});
  }
  return ReachesOpposedTargets(grasp.contacts, targets,
                               limits.max_target_distance,
                               limits.min_opposed_contacts);
}

RigidTransform FitWrist(const HandModel& hand, const TransferTask& task) {
  const auto X_HL = CalcLinkPoses(hand, task.q);
  // The hand's own frame, where T* puts it, holds what targets leave free.
  const auto n = static_cast<int>(task.targets.size());
  Eigen::Matrix3Xd p_H(3, n + 4), p_N(3, n + 4);
  for (int i = 0; i < n; ++i) {
    const ContactTarget& target = task.targets[i];
    p_H.col(i) = X_HL[target.link] * target.p_L;
    p_N.col(i) = target.p_N;
  }
  p_H.rightCols<4>() << Eigen::Vector3d::Zero(),
      kFrameLength * Eigen::Matrix3d::Identity();
  for (int i = n; i < n + 4; ++i) {
    p_N.col(i) = task.X_NH * Eigen::Vector3d(p_H.col(i));
  }
  const Eigen::Matrix4d fit = Eigen::umeyama(p_H, p_N, false);
  return {fit.topLeftCorner<3, 3>(), fit.topRightCorner<3, 1>()};
}

RigidTransform Confine(const RigidTransform& X_NH, const TransferTask& task,
                       const TransferLimits& limits) {
  const RigidTransform& around = task.X_NH;
  RigidTransform confined = X_NH;
  const Eigen::Vector3d shift = X_NH.translation - around.translation;
  const double max_shift = kWithinLimits * limits.max_translation;
  if (shift.norm() > max_shift) {
    confined.translation =
        around.translation + shift * (max_shift / shift.norm());
  }
  const Eigen::AngleAxisd turn(around.rotation.transpose() * X_NH.rotation);
  const double max_turn = kWithinLimits * limits.max_rotation;
  if (turn.angle() > max_turn) {
    confined.rotation =
        around.rotation *
        Eigen::AngleAxisd(max_turn, turn.axis()).toRotationMatrix();
  }
  return confined;
}

}  // namespace graspdb
