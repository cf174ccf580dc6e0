// The controllers of the paper's section V and those that move momentum to the base's wheels,
// written a second time: as joint accelerations and moments on the base, with the dense dynamics of
// `reference`. Shares nothing with `simulation` but the robot model.
#pragma once

#include <cstdint>
#include <optional>

#include <stillbase/core/constants.hpp>
#include <stillbase/reference/reference.hpp>

#include "reference/spring_contact.hpp"

namespace stillbase::reference {

/// Pose and velocities, velocities of the base in B.
struct Motion {
  Pose base;  ///< T_NB
  State state;
  /// h_w of the base's wheels relative to B, in B, N m s.
  Eigen::Vector3d wheel_momentum = Eigen::Vector3d::Zero();
  std::optional<BodyMotion> target = {};  ///< with ControlledRobot::contact
};

/// The law that commands the joints and the base's wheels.
struct ControlLaw {
  enum class Kind {
    Free,                 ///< tau = 0
    JointDamping,         ///< phi'' = -K_phi phidot
    JointDampingLiteral,  ///< (19) as printed: tau = -K_phi phidot + chat
    Rns,                  ///< (24) without its last term
    RnsDamped,            ///< (24)
    RnsHandback,          ///< (24), from `handback_start` on with u = -K_handback L_g of the wheels
    Detumble              ///< joints and momentum braked as fast as the loads allow
  };
  Kind kind = Kind::Free;
  double K_omega = 0;    ///< 1/s
  double K_phi = 0;      ///< 1/s; JointDampingLiteral: N m s/rad
  double rank_edge = 0;  ///< least singular value that counts, over the largest one
  double joint_rate_edge =
      1;                      ///< the same as a joint rate: sigma >= |L_g| / joint_rate_edge, rad/s
  double period = 0;          ///< s between commands, held in between; 0: at every instant
  double handback_start = 0;  ///< s
  double K_handback = 0;      ///< 1/s
  double K_detumble = 0;      ///< 1/s
  double reserve = 0;         ///< Detumble: part of the limits of joints and grip that it keeps
  /// Adds viscous phidot + coulomb tanh(phidot / friction_rate), rad/s or m/s; 0: it does not.
  double friction_rate = 0;
};

/// One reaction wheel per axis of B.
struct Wheels {
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< N m; all zero: there are none
  Eigen::Vector3d capacity = Eigen::Vector3d::Constant(kInfinity);  ///< N m s
  bool exist() const { return torque.maxCoeff() > 0; }
};

/// A pair of thrusters per axis of B: -gain Htilde_omega omega, each axis cut at `torque`, off
/// while |omega| is below `dead_band`.
struct Thrusters {
  double torque = 0;     ///< N m; 0: there are none
  double gain = 0;       ///< 1/s
  double dead_band = 0;  ///< rad/s
};

/// Normal errors of what a law is told, drawn at every command: base rates, then position and rate
/// of one joint after the other.
struct Sensors {
  double base_rate_error = 0;       ///< rad/s, standard deviation
  double joint_position_error = 0;  ///< rad or m
  double joint_rate_error = 0;      ///< rad/s or m/s
  std::size_t delay = 0;            ///< commands
  std::uint64_t seed = 1, stream = 0;
};

/// The robot that moves and the one that the law knows.
struct ControlledRobot {
  const RobotModel& robot;
  const RobotModel& known;
  Eigen::VectorXd added_inertia;  ///< n, on the diagonal of H_phi of both; may be empty
  /// `known` without the target that it holds; null: it holds none.
  const RobotModel* known_empty = nullptr;
  double grip_force = kInfinity;   ///< N, that the grip of the held target bears
  double grip_moment = kInfinity;  ///< N m, about the hand's origin
  Wheels wheels = {};
  Thrusters thrusters = {};
  std::optional<Sensors> sensors = {};  ///< empty: the law is told the state
  bool has_friction = false;            ///< viscous and Coulomb, of the joints of `robot`
  double stop_restitution = 0;          ///< part of its rate that a joint keeps at a stop, reversed
  double least_rebound = 1e-5;          ///< rad/s (m/s): a joint that would leave more slowly rests
  std::optional<SpringContact> contact = {};  ///< of the hand; empty: it meets nothing
};

/// What a law commands.
struct Command {
  Eigen::VectorXd tau;                                  ///< n, N m or N
  Eigen::Vector3d wheels = Eigen::Vector3d::Zero();     ///< u on the base, in B, N m; dh_w/dt = -u
  Eigen::Vector3d thrusters = Eigen::Vector3d::Zero();  ///< on the base, in B, N m
};

/// compute() with the added inertia on the joints' diagonal of H.
/// @param added_inertia n, or empty
Dynamics dynamics_of(const RobotModel& robot, const Eigen::VectorXd& added_inertia,
                     const State& state);

/// Moment of the wheels' momentum on the base as it turns, in B, N m: h_w x omega.
Eigen::Vector3d gyroscopic_moment(const Wheels& wheels, const Motion& motion);

/// The robot with a body rigidly in its hand; the origin of B stays.
/// @param body its inertia and r in the hand's axes; mass zero: the robot
RobotModel holding(RobotModel robot, const MetBody& body);

/// What a law commands at a state, joint torques before limits.
///
/// The wanted joint acceleration w gives, with the moment t_b = u - omega x h_w on the base and no
/// wrench on the hand, dot Omega from the base's rows of H [dot Omega; w] + c = [0; t_b; tau], and
/// tau from the joints' rows. Reaction null space laws:
///   w = -A^d (Htilde_omega dot_omega + ctilde_omega - t_b) - (1 - A^d A) K_phi phidot,
///   dot_omega = -K_omega omega, A = Htilde_omegaphi = U Sigma V',
///   A^d = V diag(sigma / max(sigma, edge)^2) U',
///   edge = max(rank_edge sigma_max, |L_g| / joint_rate_edge).
/// u of RnsHandback is shortened until no wheel gives more than its torque, u of Detumble is
/// -b L_g / max(1 / K_detumble, 2 period, max_i |L_g,i| / torque_i) beside w = -a K_phi phidot: a,
/// then b, are the largest parts in [0, 1] that keep the loads. The moments on the wheels lead none
/// beyond its capacity within a period; one that is full to a part of 1e-9 takes no more, and does
/// not count in either.
/// @param time s, since the start
Command command_of(const ControlledRobot& subject, const ControlLaw& law, const Motion& motion,
                   double time);

}  // namespace stillbase::reference
