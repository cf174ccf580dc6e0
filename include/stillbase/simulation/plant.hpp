// The robot as it moves: state, equation of motion (3) and conserved quantities.
//
// Assumptions: rigid bodies, no gravity, hand free of contact (F_h = 0). Virtual rotor inertia sits
// on the joint diagonal of H_phi at all times, so nothing jumps when the impact is over.
#pragma once

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

/// Everything that changes while the robot moves.
struct PlantState {
  Pose base;                          ///< T_NB
  JointVectord phi;                   ///< joint positions, n, rad or m
  Vector6d Omega = Vector6d::Zero();  ///< base velocity [v; omega] in B, m/s, rad/s
  JointVectord phidot;                ///< joint rates, n, rad/s or m/s
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

/// Solves (3) with F_h = 0: H [dot Omega; phi''] = [F_b; tau] - [c_b; c_phi].
/// @param F_b wrench on the base [force; moment about the base centroid] in B, N, N m
/// @param tau all joint torques, friction included (n), N m or N
PlantAcceleration compute_acceleration(const PlantTerms& terms, const Vector6d& F_b,
                                       const JointVectord& tau);

/// Friction torques of the joints (n): -(viscous phidot + coulomb tanh(phidot / transition_rate)).
/// The tanh stands for the sign: the integrators need a continuous force. Joints therefore creep
/// instead of sticking, and the equation is stiff with rate coulomb / (inertia * transition_rate).
/// @param transition_rate rad/s or m/s, > 0
JointVectord joint_friction(const RobotModel& robot, const JointVectord& phidot,
                            double transition_rate);

/// Kinetic energy 1/2 [Omega; phidot]' H [Omega; phidot], J; rotors included (each counted with its
/// rate relative to its own link, as the diagonal term has it).
double kinetic_energy(const InertiaMatrices<double>& inertia, const PlantState& state);

/// The state right after an impulse at the hand, (6). Pose and joint positions stay.
/// @param Fbar impulse [f; t] at the hand in B, N s, N m s
PlantState state_after_impact(const RobotModel& robot, const JointResistance& resistance,
                              const PlantState& before, const Vector6d& Fbar);

}  // namespace stillbase
