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

#include <optional>
#include <span>
#include <vector>

#include <stillbase/encounter/encounter.hpp>

#include "encounter/encounter_kernel.hpp"
#include "proof/spin.hpp"

namespace stillbase::proof {

/// An encounter, and the variables that it is a function of.
struct VariableEncounter : EncounterModel {
  // Variables. Entry i < free.size() of x is the position of joint free[i].
  JointVectord start;                ///< n, positions of the joints that are not free
  std::vector<int> free;             ///< indices of the free joints
  std::vector<double> lower, upper;  ///< one per free joint; not used for continuous joints
  bool attitude_is_free = false;     ///< the next entry: angle about attitude_axis, rad
  Vector3d attitude_axis = Vector3d::UnitZ();  ///< unit, in N
  double attitude_max = 0;                     ///< rad; pi or more: all angles
  /// Or: the next entries x, sigma = sum x_i turn_basis[i]. Unit, in N, at right angles.
  std::vector<Vector3d> turn_basis;
  double turn_size_max = 1;               ///< of |sigma|
  bool time_is_free = false;              ///< the last entry: contact time / time_unit
  double time_lower = 0, time_upper = 0;  ///< s; equal: fixed
  double time_unit = 1;  ///< s, a power of two: about a radian of the target's rotation

  // Stated base pose, and the nominal encounter there at the earliest contact time, as doubles.
  Matrix3d R_NB = Matrix3d::Identity();
  Vector3d base_position = Vector3d::Zero();
  Encounter<double> stated;
  Vector3d stated_hand_point = Vector3d::Zero();  ///< where the hand must be, in B, m

  // The target, of which the direction is a feature's normal.
  std::optional<SpinEnclosure> spin;     ///< with the time free
  TargetState estimate;                  ///< of its motion
  Matrix3d R_NT = Matrix3d::Identity();  ///< at the earliest contact time

  int num_variables() const { return time_index() + time_is_free; }
  int attitude_index() const { return static_cast<int>(free.size()); }
  int num_attitudes() const { return attitude_is_free + static_cast<int>(turn_basis.size()); }
  int time_index() const { return attitude_index() + num_attitudes(); }
  /// Whether the encounter is the same at every point.
  bool is_fixed() const { return num_attitudes() == 0 && !time_is_free; }
};

/// The encounter over a box.
template <class S>
struct EncounterRange {
  JointVector<S> phi;  ///< n
  Matrix3<S> R_NB;
  S turn_size_squared = S(0.0);  ///< |sigma|^2, with a free attitude
  ContactKinematics<S> contact;  ///< velocities with the time free only
  Vector6<S> F;                  ///< [n; moment] in B
  Vector3<S> contact_point;      ///< of hand and target in N, m: the stated one, else the feature's
  Vector3<S> hand_point;         ///< the same in B, where the base position is stated
  S closing_speed = S(0.0);      ///< m/s

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
/// @param x num_variables() entries
template <class S>
EncounterRange<S> encounter_over(const VariableEncounter& model, std::span<const S> x);

/// Cosine of the angle between the axis of the base that points along attitude_axis in the stated
/// attitude, and attitude_axis.
template <class S>
S tilt_cosine(const VariableEncounter& model, const EncounterRange<S>& at) {
  const Vector3d in_B = model.R_NB.transpose() * model.attitude_axis;
  const Vector3<S> axis = at.R_NB * Vector3<S>(in_B.cast<S>());
  return axis.dot(Vector3<S>(model.attitude_axis.cast<S>()));
}

}  // namespace stillbase::proof
