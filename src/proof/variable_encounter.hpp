// The encounter over a box of the variables: posture, wrench per unit of impulse, where the hand
// must be, which axes it must have, closing speed. For dual intervals and Taylor models.
//
// Directions, speeds and hand axes are those of encounter/encounter_kernel.hpp, instantiated on
// enclosing numbers. Three things are written here:
// - Which variables a box has. They are the planner's (formulation/variables/layout.hpp), in its
//   order: free joints, rotation of the base from the stated attitude, contact time. The rotation
//   is an angle about an axis of N, or given by modified Rodrigues parameters (rotation_by): they
//   are rational, and the unit ball holds every rotation. The base position is none: a free station
//   follows the hand.
// - The motion of the target over a span of times, enclosed (spin.hpp): the planner's own motion is
//   an integration in floating point.
// - What is the same at every point of the box is taken as the doubles that the planner uses, which
//   keeps enclosures narrow: the wrench while neither attitude nor time are free, the target's axes
//   and its contact point while the time is not.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include <stillbase/encounter/encounter.hpp>

#include "encounter/encounter_kernel.hpp"
#include "proof/spin.hpp"

namespace stillbase::proof {

enum class VariableKind {
  Joint,          ///< position of a joint, rad or m
  BaseAngle,      ///< rotation of the base about `axis`, rad
  BaseParameter,  ///< component of sigma along `axis`, see rotation_by()
  Time            ///< contact time / VariableEncounter::time_unit
};

/// One entry x of a box.
struct Variable {
  VariableKind kind;
  double lower = 0, upper = 0;
  bool is_periodic = false;          ///< an angle, and all angles are allowed
  int joint = -1;                    ///< of a Joint
  Vector3d axis = Vector3d::Zero();  ///< of the base, unit, in N; those of sigma at right angles
  double middle = 0;                 ///< of the turn in which a periodic one is searched
};

/// An encounter, and the variables that it is a function of.
struct VariableEncounter : EncounterModel {
  std::vector<Variable> variables;
  JointVectord start;        ///< n, positions of the joints that are not free
  double parameter_max = 1;  ///< of |sigma|
  double time_unit = 1;      ///< s, a power of two: about a radian of the target's rotation
  double earliest_time = 0;  ///< s
  /// Of the base's tilt: the axis of N whose angle to the same axis of B is limited.
  Vector3d tilt_axis = Vector3d::UnitZ();

  // Stated base pose, and the nominal encounter there at the earliest contact time, as doubles.
  Matrix3d R_NB = Matrix3d::Identity();
  Vector3d base_position = Vector3d::Zero();
  Encounter<double> stated;
  Vector3d stated_hand_point = Vector3d::Zero();  ///< where the hand must be, in B, m

  // The target, of which the direction is a feature's normal.
  std::optional<SpinEnclosure> spin;     ///< with the time free
  TargetState estimate;                  ///< of its motion
  Matrix3d R_NT = Matrix3d::Identity();  ///< at the earliest contact time

  int num_variables() const { return static_cast<int>(variables.size()); }
  bool has(VariableKind kind) const {
    return std::any_of(variables.begin(), variables.end(),
                       [kind](const Variable& variable) { return variable.kind == kind; });
  }
  bool is_attitude_free() const {
    return has(VariableKind::BaseAngle) || has(VariableKind::BaseParameter);
  }
  /// Whether the encounter is the same at every point.
  bool is_fixed() const { return !is_attitude_free() && !has(VariableKind::Time); }
};

/// All values of the variables; sides beyond them are zero.
/// @pre N >= num_variables()
template <int N>
Box<N> domain_of(const VariableEncounter& encounter) {
  Box<N> box;
  for (std::size_t i = 0; i < encounter.variables.size(); ++i) {
    const Variable& variable = encounter.variables[i];
    const Interval turn = Interval(variable.middle) + Interval(-kPi.upper(), kPi.upper());
    box.side[i] = variable.is_periodic ? turn : Interval(variable.lower, variable.upper);
  }
  return box;
}

/// The encounter over a box.
template <class S>
struct EncounterRange {
  JointVector<S> phi;  ///< n
  Matrix3<S> R_NB;
  S parameters_squared = S(0.0);  ///< |sigma|^2
  ContactKinematics<S> contact;   ///< velocities with the time free only
  Vector6<S> F;                   ///< [n; moment] in B
  Vector3<S> contact_point;       ///< of hand and target in N, m: the stated one or the feature's
  Vector3<S> hand_point;          ///< the same in B, where the base position is stated
  S closing_speed = S(0.0);       ///< m/s

  auto R_BE() const { return contact.R_EB.transpose(); }
};

/// Rotation by the angle theta about the unit axis a, sigma = a tan(theta / 4), |sigma| <= 1 for
/// all angles up to pi (Schaub and Junkins, J. Astronaut. Sci. 44, 1996, with the sign that maps B
/// to N):
///   E + (8 K^2 + 4 (1 - |sigma|^2) K) / (1 + |sigma|^2)^2, K = skew(sigma).
/// @param size_squared |sigma|^2
template <class S>
Matrix3<S> rotation_by(const Vector3<S>& sigma, const S& size_squared) {
  // By the unit quaternion (w, r): E + 2 w skew(r) + 2 skew(r)^2.
  const S twice_inverse = inverse_of(size_squared + S(1.0)) * S(2.0);
  const S w = twice_inverse - S(1.0);
  const Vector3<S> r = sigma * twice_inverse;
  Matrix3<S> R;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    R(i, i) = S(1.0) - (square(r[j]) + square(r[k])) * S(2.0);
    R(k, j) = (r[j] * r[k] + w * r[i]) * S(2.0);
    R(j, k) = (r[j] * r[k] - w * r[i]) * S(2.0);
  }
  return R;
}

/// For Dual, Quadratic and Form.
/// @param x at least num_variables() entries
template <class S>
EncounterRange<S> encounter_over(const VariableEncounter& model, std::span<const S> x);

}  // namespace stillbase::proof
