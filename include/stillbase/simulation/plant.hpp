// The robot as it moves: state, equation of motion (3) and conserved quantities.
//
// Assumptions: rigid bodies, no gravity. Virtual rotor inertia sits on the joint diagonal of H_phi
// at all times, so nothing jumps when the impact is over. The bodies of the base's wheels are part
// of the base; only their momentum relative to it is a state.
#pragma once

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

/// Everything that changes while the robot moves.
struct PlantState {
  Pose base;                                   ///< T_NB
  JointVectord phi;                            ///< joint positions, n, rad or m
  Vector6d Omega = Vector6d::Zero();           ///< base velocity [v; omega] in B, m/s, rad/s
  JointVectord phidot;                         ///< joint rates, n, rad/s or m/s
  Vector3d wheel_momentum = Vector3d::Zero();  ///< of the base's wheels relative to B, in B, N m s
  /// Angular impulse that the thrusters have given since the start, in N, N m s.
  Vector3d thruster_impulse = Vector3d::Zero();
};

/// The target as it moves.
struct TargetPlantState {
  Pose pose;                                     ///< T_NT
  Vector3d velocity = Vector3d::Zero();          ///< of the centroid in N, m/s
  Vector3d angular_velocity = Vector3d::Zero();  ///< in T, rad/s
};

/// The robot at rest in a posture.
PlantState state_at_rest(const Pose& base, const JointVectord& phi);

/// The terms of (3) at one state. Plant and controllers share them, H_phi holds the rotor inertia.
struct PlantTerms {
  Kinematics<double> kinematics;
  InertiaMatrices<double> inertia;  ///< H_phi with the rotor inertia on its diagonal
  TildeInertia<double> tilde;
  BiasForces<double> bias;

  /// @param rotor_inertia n; from added_plant_inertia()
  PlantTerms(const RobotModel& robot, const JointVectord& rotor_inertia, const PlantState& state);
};

struct PlantAcceleration {
  Vector6d dot_Omega;    ///< derivative of the B components of Omega
  JointVectord phiddot;  ///< n
};

/// Solves (3): H [dot Omega; phi''] = [F_b; tau] - [c_b; c_phi].
/// @param F_b wrench on the base [force; moment about the base centroid] in B, N, N m; a wrench on
/// the hand goes in as R_bh' F_h
/// @param tau all joint torques, friction included (n), N m or N; a wrench on the hand adds
/// J_phi' F_h
/// @param held n flags, empty: none; held joints have phi'' = 0 (they stick, or rest at a stop)
PlantAcceleration compute_acceleration(const PlantTerms& terms, const Vector6d& F_b,
                                       const JointVectord& tau, const std::vector<bool>& held = {});

/// The same without the terms, by what is quickest for the robot and the processor: with vectors in
/// wide registers, by the inertia matrix, or by articulated bodies (articulated_body.hpp). The
/// routes differ by rounding.
/// @param rotor_inertia n; from added_plant_inertia()
PlantAcceleration compute_acceleration(const RobotModel& robot, const JointVectord& rotor_inertia,
                                       const PlantState& state, const Vector6d& F_b,
                                       const JointVectord& tau, const std::vector<bool>& held = {});

/// Torque that holds a joint: beside tau, with which (3) gives this acceleration,
///   r = H_bphi' dot Omega + H_phi phi'' + c_phi - tau (n). Zero for joints that are not held.
JointVectord holding_torque(const PlantTerms& terms, const PlantAcceleration& acceleration,
                            const JointVectord& tau);

/// Gives joint k the rate `rate` by an impulse between its two bodies (a stop, a brake); nothing
/// else acts, so both momenta of the robot stay.
/// @param held n flags, empty: none; joints whose rate stays
void impose_joint_rate(const PlantTerms& terms, int k, double rate, const std::vector<bool>& held,
                       PlantState& state);

/// Kinetic energy 1/2 [Omega; phidot]' H [Omega; phidot], J; rotors included (each counted with its
/// rate relative to its own link, as the diagonal term has it).
double kinetic_energy(const InertiaMatrices<double>& inertia, const PlantState& state);

/// The state right after an impulse at the hand, (6). Pose and joint positions stay.
/// @param Fbar impulse [f; t] at the hand in B, N s, N m s
PlantState state_after_impact(const RobotModel& robot, const JointResistance& resistance,
                              const PlantState& before, const Vector6d& Fbar);

}  // namespace stillbase
