#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/parameters/parameters.h"

namespace graspdb {

/** A finger contact c_i(Θ) and where it should be on the novel object, d_i. */
struct ContactGoal {
  Eigen::Vector3d p_NF;    ///< c_i: on the finger, in the object's frame, m.
  Eigen::Vector3d nhat_F;  ///< n_c: out of the finger.
  Eigen::Vector3d p_ND;    ///< d_i: on the object.
  Eigen::Vector3d nhat_D;  ///< n_d: out of the object.
};

/** μ₁ ∑ |c_i − d_i|² with lengths over parameters.length_unit.
 @paper{Eq. (6), first term} */
double CalcPositionTerm(const std::vector<ContactGoal>& goals,
                        const ReplanParameters& parameters);

/** ∑ e^{μ₂ n_c · n_d}: least where the normals oppose each other.
 @paper{Eq. (6), second term} */
double CalcOppositionTerm(const std::vector<ContactGoal>& goals,
                          const ReplanParameters& parameters);

/** ∑ e^{μ₃ (low − θ)} + e^{μ₃ (θ − up)} with low and up joint_range below and
 above the example's joints. @paper{Eq. (6), third term} */
double CalcJointTerm(const Eigen::VectorXd& q, const Eigen::VectorXd& q_example,
                     const ReplanParameters& parameters);

/** The objective of local replanning, to be minimised. The last term is
 CalcQualityTerm() with weight μ₄. @paper{Eq. (6)} */
double CalcReplanObjective(const std::vector<ContactGoal>& goals,
                           const Eigen::VectorXd& q,
                           const Eigen::VectorXd& q_example, double epsilon,
                           double epsilon_floor,
                           const ReplanParameters& parameters);

}  // namespace graspdb
