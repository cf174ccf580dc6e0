// One impact at each of many postures: several postures at a time in the lanes of wide registers,
// which is two and a half to five times faster per posture than one after the other.
//
// For start points, samples of uncertain postures, sweeps. Every quantity is a column over the
// postures (count rows). Results agree with evaluate_posture() and response_gradient() to rounding.
// Robots with more than 16 joints go through the plain code.
#pragma once

#include <stillbase/impact/gradient.hpp>

namespace stillbase {

/// What hits the robot in which posture.
struct ImpactBatch {
  Eigen::MatrixXd phi;  ///< joint positions, count x n; finite
  Eigen::MatrixXd F;    ///< wrench [f; t] at the hand in B, count x 6; unit force with a law
  /// Contact law p = approach / (F' W_h F + target_inverse_mass), see normal_impulse(). Both empty:
  /// F is the whole impulse, p = 1.
  Eigen::VectorXd approach;             ///< (1+e) v_n, m/s
  Eigen::VectorXd target_inverse_mass;  ///< n' W_t n, 1/kg
};

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

/// psi = 1/2 p^2 (omega |Delta omega|^2 + base |base|^2 + total |total|^2), per unit of p inside.
struct BatchObjective {
  double omega = 0;
  double base = 0;
  double total = 0;
};

struct BatchObjectiveValues {
  Eigen::VectorXd psi;       ///< count
  Eigen::MatrixXd gradient;  ///< d psi / d phi with F and the target's part of p fixed, count x n
};

/// @param out resized; allocates only when its sizes change
void evaluate_objective(const RobotModel& robot, const ImpactResistance& resistance,
                        const ImpactBatch& batch, const BatchObjective& objective,
                        BatchObjectiveValues& out);

}  // namespace stillbase
