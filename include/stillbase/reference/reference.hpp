// A second, plain implementation of the dynamics, by summed body Jacobians: H = sum J_i' M_i J_i.
//
// Written apart from `dynamics` and sharing nothing with it but the robot model, so that one can
// contradict the other. Slow and simple on purpose.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase::reference {

/// State of the robot seen from B (velocities may be empty: zero).
struct State {
  Eigen::VectorXd phi;                                                      ///< n
  Eigen::VectorXd phidot;                                                   ///< n
  Eigen::Matrix<double, 6, 1> Omega = Eigen::Matrix<double, 6, 1>::Zero();  ///< [v; omega] in B
};

/// Frames of the bodies in B at joint positions phi (n): axes and origin of body k, as RobotModel
/// defines them.
std::vector<Pose> body_poses(const RobotModel& robot, const Eigen::VectorXd& phi);

/// All dynamics quantities at a state, in B, dense.
struct Dynamics {
  double mass = 0;
  Eigen::Vector3d centroid;       ///< system centroid in B
  Eigen::Vector3d hand_position;  ///< in B
  Eigen::Matrix3d hand_rotation;  ///< hand axes in B
  Eigen::MatrixXd H;              ///< (6+n) x (6+n), order [Omega; phidot]
  Eigen::VectorXd c;              ///< (6+n) bias of (3)
  Eigen::MatrixXd J;              ///< 6 x (6+n), hand velocity = J [Omega; phidot]
  Eigen::Vector3d P, L_g;         ///< momentum (1)
  Eigen::Matrix3d Htilde_omega;
  Eigen::MatrixXd Htilde_omegaphi;  ///< 3 x n
};
/// The bias comes from body accelerations by the derivative of the body Jacobians along the motion
/// (exact products, no differences).
Dynamics compute(const RobotModel& robot, const State& state);

/// X of A X = B, A symmetric and positive definite, by LDL'.
Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// What an impulse does, solved densely from (6).
struct Impact {
  Eigen::Matrix<double, 6, 1> Delta_Omega;
  Eigen::VectorXd Delta_phidot;
  Eigen::Vector3d total, base, coupling;  ///< angular momenta, N m s
  double hand_inverse_mass = 0;           ///< f' W_h f / |f|^2, 1/kg
};
/// @param added_inertia n, added to the joint diagonal; locked: n flags or empty
Impact impact(const Dynamics& dynamics, const Eigen::VectorXd& added_inertia,
              const std::vector<bool>& locked, const Eigen::Matrix<double, 6, 1>& Fbar);

/// A body that the hand meets, right before the contact; in B.
struct MetBody {
  double mass = 0;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();   ///< about its centroid; zero: a point mass
  Eigen::Vector3d r = Eigen::Vector3d::Zero();         ///< from its centroid to the hand, m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the centroid, m/s
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();     ///< rad/s
};

/// Twist of the body [v of its centroid; omega] per twist [v; omega] of its point at the hand.
Eigen::Matrix<double, 6, 6> centroid_from_hand(const MetBody& body);

/// Impulse [f; t] on the hand of a robot at rest where the hand's point and the body's move on
/// together, with one angular velocity too (`is_held`) or without a moment. By Gauss's principle:
/// the velocities after it are those that differ least, in kinetic energy, from those before among
/// all that keep together; solved with its multipliers, which are the impulse.
/// @param added_inertia, locked as in impact()
/// @pre a body that is held has an inertia
Eigen::Matrix<double, 6, 1> impulse_that_joins(const Dynamics& dynamics,
                                               const Eigen::VectorXd& added_inertia,
                                               const std::vector<bool>& locked, const MetBody& body,
                                               bool is_held);

}  // namespace stillbase::reference
