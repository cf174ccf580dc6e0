// An encounter that differs from the nominal one.
#pragma once

#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// An encounter of the uncertainty set. Vectors are in the contact frame E, the one in which the
/// nominal direction n never changes: B or N when it is stated there, T (the target's) when it
/// follows from a contact feature. The hand's origin stays where it is.
struct Scenario {
  Vector3d direction = Vector3d::UnitX();      ///< of the impulse on the hand, unit, in E
  double weight = 1;                           ///< among its kind
  double closing_speed_offset = 0;             ///< added to the closing speed along n, m/s
  double restitution = 0;                      ///< e
  double target_mass_factor = 1;               ///< on the target's mass
  double target_inertia_factor = 1;            ///< on its inertia
  Vector3d contact_offset = Vector3d::Zero();  ///< of the contact point, m
  double time_offset = 0;        ///< s by which the target is ahead of its nominal motion
  Eigen::VectorXd joint_offset;  ///< added to the joint positions, n or empty
  /// s: the relative velocity is Vbar + L s, L L' the covariance of the residual velocity. The
  /// impulse is then the law's formula even where hand and target separate, linear in s.
  Vector6d velocity_error = Vector6d::Zero();

  bool has_velocity_error() const { return !velocity_error.isZero(0); }
};

/// The samples of the problem's uncertainty set, of equal weight: sample k depends on seed and k
/// alone. Directions are spread evenly over the cone (the wedge), everything else over its range;
/// the contact point over a disc normal to the direction (a line in a wedge's plane).
std::vector<Scenario> draw_scenarios(const CaptureProblem& problem);

/// The nominal encounter and `count` others whose directions lie evenly on the rim of the cone
/// (of a wedge: its two ends).
std::vector<Scenario> rim_scenarios(const CaptureProblem& problem, int count);

/// Name and unit of a quantity, and of the whole objective ("1" for several terms).
std::string to_string(ObjectiveQuantity quantity);
std::string unit_of(ObjectiveQuantity quantity);
std::string objective_name(const CaptureProblem& problem);
std::string objective_unit_name(const CaptureProblem& problem);
/// Whether a term of the objective takes a simulation (attitude_turned).
bool simulates_turn(const CaptureProblem& problem);
/// Of the objective's value: that of its quantity where objective_unit_name() is that one's unit,
/// else a length.
Power objective_power(const CaptureProblem& problem);

}  // namespace stillbase
