// Motion of the robot under the controllers of the paper's section V, written a second time: dense
// equations of motion of `reference`, the control laws as joint accelerations, and an integrator of
// its own. Shares nothing with `simulation` but the robot model.
#pragma once

#include <stillbase/core/interrupt.hpp>
#include <stillbase/reference/reference.hpp>

namespace stillbase::reference {

/// Pose and velocities, velocities of the base in B.
struct Motion {
  Pose base;  ///< T_NB
  State state;
};

/// The law that commands the joints.
struct ControlLaw {
  enum class Kind {
    Free,                 ///< tau = 0
    JointDamping,         ///< phi'' = -K_phi phidot
    JointDampingLiteral,  ///< (19) as printed: tau = -K_phi phidot + chat
    Rns,                  ///< (24) without its last term
    RnsDamped             ///< (24)
  };
  Kind kind = Kind::Free;
  double K_omega = 0;    ///< 1/s
  double K_phi = 0;      ///< 1/s; JointDampingLiteral: N m s/rad
  double rank_edge = 0;  ///< least singular value that counts, over the largest one
  double joint_rate_edge =
      1;              ///< the same as a joint rate: sigma >= |L_g| / joint_rate_edge, rad/s
  double period = 0;  ///< s between commands, held in between; 0: at every instant
};

/// The robot that moves and the one that the law knows.
struct ControlledRobot {
  const RobotModel& robot;
  const RobotModel& known;
  Eigen::VectorXd added_inertia;  ///< n, on the diagonal of H_phi of both; may be empty
};

struct ControlledMotion {
  std::vector<Motion> samples;            ///< at the instants asked for
  Eigen::VectorXd peak_demanded_torques;  ///< n, max |tau_k| over the commands, before limits
  bool complete = false;                  ///< false: stopped, or the step fell below rounding
};

/// Torques that a law commands at a state, n, N m or N, before limits.
///
/// The wanted joint acceleration u gives, with no wrench on base and hand, dot Omega from the
/// base's rows of H [dot Omega; u] + c = [0; tau], and tau from the joints' rows. Reaction null
/// space laws:
///   u = -A^d (Htilde_omega dot_omega + ctilde_omega) - (1 - A^d A) K_phi phidot,
///   dot_omega = -K_omega omega, A = Htilde_omegaphi = U Sigma V',
///   A^d = V diag(sigma / max(sigma, edge)^2) U',
///   edge = max(rank_edge sigma_max, |L_g| / joint_rate_edge).
Eigen::VectorXd control_torque(const ControlledRobot& subject, const ControlLaw& law,
                               const State& state);

/// Integrates from `start` at time 0 by Dormand and Prince's method 5(4), with steps that end at
/// every command and sample. Torques are cut at max_effort; a joint at its max_velocity or beyond
/// gets none in that direction. No stops, friction, wheels or thrusters.
/// @param times of the samples, s, ascending, the first one 0
/// @param tolerance of a step: error over 1 + |state|, in SI units
ControlledMotion controlled_motion(const ControlledRobot& subject, const ControlLaw& law,
                                   const Motion& start, const std::vector<double>& times,
                                   double tolerance, const StopCondition& stop);

}  // namespace stillbase::reference
