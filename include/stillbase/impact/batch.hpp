// One impact at each of many postures: several postures at a time in the lanes of wide registers,
// which is two and a half to five times faster per posture than one after the other.
//
// For start points, samples of uncertain postures, sweeps. Every quantity is a column over the
// postures (count rows). Results agree with evaluate_posture() and response_gradient() to rounding.
// Robots with more than 16 joints go through the plain code.
#pragma once

#include <stillbase/impact/contact_response.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/impact/response_parts.hpp>

namespace stillbase {

/// Postures per step for a robot of n joints on this processor; 1: no faster than one by one.
int batch_lanes(int n);

/// Postures and the wrenches at the hand.
struct ImpactBatch {
  Eigen::MatrixXd phi;  ///< joint positions, count x n; finite
  Eigen::MatrixXd F;    ///< wrench [f; t] at the hand in B, count x 6; unit force with a law
  /// Contact law p = approach / (F' W_h F + target_inverse_mass), see normal_impulse(). Both empty:
  /// F is the whole impulse, p = 1.
  Eigen::VectorXd approach;             ///< (1+e) v_n, m/s
  Eigen::VectorXd target_inverse_mass;  ///< n' W_t n, 1/kg
  /// A sticking contact or a latch: count x kTargetNumbers, see put_target(); F is not read then.
  /// Empty: there is none. For evaluate_objective() alone.
  Eigen::MatrixXd target;
  ContactLaw law = ContactLaw::Frictionless;  ///< of `target`
  /// All rows of phi are the same: the posture is evaluated once.
  bool is_one_posture = false;
};

inline constexpr int kTargetNumbers = 28;
/// Calls visit(number) for all of a target, in the order of the columns of ImpactBatch::target.
template <class Target, class Visit>
void for_each_number(Target& target, const Visit& visit) {
  visit(target.inverse_mass);
  for (int i = 0; i < 9; ++i) visit(target.inertia(i % 3, i / 3));
  for (int i = 0; i < 9; ++i) visit(target.inverse_inertia(i % 3, i / 3));
  for (int i = 0; i < 3; ++i) visit(target.r[i]);
  for (int i = 0; i < 3; ++i) visit(target.velocity[i]);
  for (int i = 0; i < 3; ++i) visit(target.omega[i]);
}
/// Sets a row of ImpactBatch::target. @param batch its matrix has its size
void put_target(const TargetAtHand<double>& target, Eigen::Index row, ImpactBatch& batch);

/// Responses to F, per unit of p.
struct ImpactBatchValues {
  Eigen::MatrixXd Delta_Omega;        ///< [Delta v; Delta omega] in B, count x 6
  Eigen::MatrixXd base;               ///< Htilde_omega Delta omega, count x 3
  Eigen::MatrixXd total;              ///< Delta L_g, count x 3
  Eigen::VectorXd hand_inverse_mass;  ///< F' W_h F
  Eigen::VectorXd p;                  ///< of the contact law
};

/// @param out resized; allocates only when its sizes change
void evaluate_postures(const RobotModel& robot, const ImpactResistance& resistance,
                       const ImpactBatch& batch, ImpactBatchValues& out);

/// psi = 1/2 p^2 sum over the parts of part' G part, the parts per unit of p.
using BatchObjective = PartMetrics;

struct BatchObjectiveValues {
  Eigen::VectorXd psi;  ///< count
  /// d psi / d phi with F and the target's part of p fixed, count x n.
  Eigen::MatrixXd gradient;
  /// d psi / d F with approach and target_inverse_mass fixed, count x 6.
  Eigen::MatrixXd gradient_F;
  /// With a target in place of it: [turn; velocity; omega] of ContactGradient, count x 9.
  Eigen::MatrixXd gradient_target;
};

/// @param derivatives false: psi alone, the gradients stay as they are
/// @param out resized; allocates only when its sizes change
void evaluate_objective(const RobotModel& robot, const ImpactResistance& resistance,
                        const ImpactBatch& batch, const BatchObjective& objective, bool derivatives,
                        BatchObjectiveValues& out);

}  // namespace stillbase
