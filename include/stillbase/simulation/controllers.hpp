// Post-impact controllers of the paper's section V.
//
// They command joint torques from a model of the robot and a measured state; which model and how
// well measured is the simulation's matter (simulate.hpp). All of them assume F_h = 0, and F_b = 0
// but for the wheels that they command themselves.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/plan/post_impact.hpp>
#include <stillbase/simulation/grip.hpp>

namespace stillbase {

enum class ControllerKind {
  None,                 ///< free joints
  JointDamping,         ///< (19), gain scaled by Hhat_phi
  JointDampingLiteral,  ///< (19) as printed
  Rns,                  ///< (24) without its last term
  RnsDamped,            ///< (24)
  RnsHandback,          ///< (24), then the momentum is transferred to the base's wheels
  Detumble              ///< joints and base to rest in least time, the momentum to the wheels
};

/// "none", "joint_damping", "joint_damping_literal", "rns", "rns_damped", "rns_handback",
/// "detumble".
std::string to_string(ControllerKind kind);

/// The controller with this name; empty: there is none.
std::optional<ControllerKind> controller_from_name(std::string_view name);

/// Every name, in the order of the enumeration.
std::vector<std::string> controller_names();

/// True for the controllers that move the momentum to the arm.
bool is_reaction_null_space_control(ControllerKind kind);

struct Controller {
  ControllerKind kind = ControllerKind::None;
  double K_omega = 7;  ///< 1/s, the paper's
  double K_phi = 5;    ///< 1/s, the paper's; joint_damping_literal reads it as N m s/rad (N s/m)
  /// Where the arm cannot take over a direction of base momentum (singular value sigma of the
  /// angular coupling matrix), the direction is given up gradually, see momentum_edge().
  double rank_edge = 1e-4;     ///< sigma relative to the largest one
  double joint_rate_edge = 3;  ///< joint rate that carrying L_g would take, |L_g| / sigma, rad/s
  double handback_start = 2;   ///< rns_handback: s of rns_damped alone before it
  /// rns_handback, 1/s: the wheels take L_g K_handback, as far as they can. The end of the transfer
  /// is an exponential with this rate, so it has to be slow beside K_omega.
  double K_handback = 1;
  double K_detumble = 50;  ///< detumble, 1/s: of the momentum that is left for the last instants
  /// detumble: part of grip and joint torque limits that is kept back. Commands are held for a
  /// control period, in which the loads change, and the controller knows masses to some percent.
  double reserve = 0.05;
  /// Adds the torque that the model's joint friction takes: viscous phidot + coulomb
  /// tanh(phidot / friction_transition_rate). The tanh avoids chattering about zero rate.
  bool friction_compensation = false;
  double friction_transition_rate = 0.01;  ///< rad/s or m/s, > 0
};

/// Moment of the thrusters on the base, in B, N m: -gain Htilde_omega omega, each axis cut at
/// `torque`; zero within the dead band. They brake the base alone: what the arm holds of the
/// momentum stays there until a controller gives it back.
Vector3d thruster_torque(const ThrusterSpec& thrusters, const PlantTerms& terms,
                         const PlantState& state);

/// The controller with this name and the gains of a problem; empty: there is none.
std::optional<Controller> controller_of(const PostImpactSpec& spec, std::string_view name);
/// That of the first name, the plan's choice; empty: there is none.
std::optional<Controller> chosen_controller(const PostImpactSpec& spec);
/// Whether that is one of this kind.
bool chooses(const PostImpactSpec& spec, ControllerKind kind);

// Templates below are there for double; their definitions are the library's own.

/// The singular value below which a direction is given up:
/// max(rank_edge sigma_max, |L_g| / joint_rate_edge). The first only keeps numbers finite (real
/// arms on light satellites have sigma_min / sigma_max of 0.01 in ordinary postures, so it must be
/// small). The second bounds the joint rates and accelerations, folded-in postures included: it
/// leaves in the base what the arm could only carry by spinning.
template <class S>
S momentum_edge(const Controller& controller, const S& sigma_max, const S& L_g);

/// How much base momentum the arm can take: the angular coupling matrix A = Htilde_omegaphi in its
/// singular directions U (in B), sigma descending.
template <class S>
struct MomentumTransfer {
  Matrix3<S> U;        ///< columns: directions of base angular momentum
  Vector3<S> sigma;    ///< singular values of A
  Vector3<S> share;    ///< min(1, (sigma / edge)^2), edge as momentum_edge() says; 0 when A = 0
  Vector3<S> inverse;  ///< 1 / max(sigma, edge)^2; 0 when A = 0
  S rank;              ///< directions with full share

  /// A^d b = A' U diag(inverse) U' b: joint accelerations for a rate b of coupling momentum. The
  /// pseudoinverse where the share is 1; nowhere larger than |b| / edge.
  JointVector<S> joint_rates(const Matrix3X<S>& A, const Vector3<S>& b) const;
  /// The part of an angular momentum (B components) that the arm cannot take over.
  Vector3<S> unreachable(const Vector3<S>& momentum) const;
};

/// @param L_g angular momentum about the system centroid (any axes), N m s
template <class S>
MomentumTransfer<S> compute_momentum_transfer(const Controller& controller,
                                              const Matrix3X<S>& Htilde_omegaphi,
                                              const Vector3<S>& L_g);

/// Joint torques that the controller commands (n), before any limit, N m or N.
///
/// none: 0.
/// joint_damping: tau = -Hhat_phi K_phi phidot + chat, so phi'' = -K_phi phidot by (18).
///   Differs from (19): which prints -K_phi phidot while giving K_phi in 1/s.
/// joint_damping_literal: tau = -K_phi phidot + chat, (19) as printed.
/// rns, rns_damped: the joint acceleration
///     phi'' = -A^+ (Htilde_omega dot_omega + ctilde_omega) - P_RNSomega K_phi phidot,
///     dot_omega = -K_omega omega (23), last term (22) in rns_damped only,
///   and its torque by (18), tau = Hhat_phi phi'' + chat. With full row rank of A = Htilde_omegaphi
///   this is (24).
///   Differs from (22): which prints K_omega where K_phi is meant.
///   Differs from (21): whose text puts a hat on the H_phi of the last term; a tilde is right.
///   Differs from (24): where A loses rank, (24) demands a dot_omega that the arm cannot give
///   and so disturbs the directions that it can. Here the wanted Htilde_omega dot_omega +
///   ctilde_omega is projected onto the range of A (damped near the edge, see MomentumTransfer);
///   (18) then takes the dot_omega that really comes. Angular momentum along a lost direction u
///   stays in the base: u' Htilde_omega omega = u' L_g.
/// Joint coordinates of different units (prismatic beside revolute) are weighed as they stand.
JointVectord control_torque(const Controller& controller, const PlantTerms& terms,
                            const PlantState& state);

struct ControlCommand {
  JointVectord tau;                             ///< n, before any limit, N m or N
  Vector3d wheel_torque = Vector3d::Zero();     ///< u, on the base, in B, N m; the wheels get -u
  Vector3d thruster_torque = Vector3d::Zero();  ///< on the base, in B, N m
};

/// control_torque(), and for rns_handback and detumble the wheels as well.
///
/// rns_handback: "The impact momentum, conserved now in manipulator motion with the lowest possible
/// velocity, can be gradually re-transfered to the base to be then managed by the additional base
/// actuators" (the paper's last remark in section V). From handback_start on the wheels brake the
/// system: u = -K_handback L_g, scaled down to what they can give. The arm feeds it to them:
///     phi'' = -A^+ (Htilde_omega dot_omega + ctilde_omega - t_b) - P_RNSomega K_phi phidot,
///     t_b = u - omega x h_w (h_w the wheels' momentum),
///   (9) with the moment t_b on the base, so that the base stays as still as under rns_damped while
///   A phidot and with it the joint rates run out. A full wheel leaves the remaining momentum in
///   the arm.
/// detumble: see detumble_command(). Without wheels it stops the joints alone.
/// @param elapsed s since the impact
/// @param period s for which the command is held; 0: for none
ControlCommand control_command(const Controller& controller, const WheelSpec& wheels,
                               const RobotModel& robot, const PlantTerms& terms,
                               const PlantState& state, double elapsed, const Grasp& grasp = {},
                               double period = 0);

/// The law of detumble: joint accelerations phi'' = -a K_phi phidot and wheel torque
///   u = -b k L_g, k = min(K_detumble, min_i tau_i / |L_g,i|),
/// a and b in [0, 1], chosen one after the other as large as the loads allow. All axes of the
/// momentum vanish at one instant, after max_i |L_g,i| / tau_i while b = 1 and the base keeps its
/// attitude: no wheels need less.
///
/// Joint torques and grip wrench are affine in a and b. None exceeds its limit (less
/// Controller::reserve), nor, where coasting itself (a = b = 0) does, what coasting takes.
/// Axes whose wheel is full are left out of u, and no wheel is driven beyond its capacity within
/// a control period.
/// @param period s between commands; 0: none is held
ControlCommand detumble_command(const Controller& controller, const WheelSpec& wheels,
                                const Grasp& grasp, const RobotModel& robot,
                                const PlantTerms& terms, const PlantState& state, double period);

}  // namespace stillbase
