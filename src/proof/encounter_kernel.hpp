// The encounter over a box of the variables: posture, wrench per unit of impulse, where the hand
// must be, which axes it must have, closing speed. For dual intervals of any size.
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
#include "proof/interval.hpp"
#include "proof/spin.hpp"

/// Dual numbers are wide: their matrices take the joints of the determinants and some locked ones.
template <int N>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Dual<N>> = 8;

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

/// Attitude and rate of the target over a span of time.
template <class S>
struct TargetTurn {
  Matrix3<S> R_NT;
  Vector3<S> omega;  ///< in T, rad/s
};

/// A function of time over the box of `time`, from enclosures of it and of its rate.
template <int N>
Dual<N> in_time(const Number& value, const Number& rate, const Dual<N>& time) {
  Dual<N> out(value.v);
  for (std::size_t i = 0; i < out.d.size(); ++i) out.d[i] = rate.v * time.d[i];
  return out;
}

template <int N, int Rows, int Cols>
Eigen::Matrix<Dual<N>, Rows, Cols> in_time(const Eigen::Matrix<Number, Rows, Cols>& value,
                                           const Eigen::Matrix<Number, Rows, Cols>& rate,
                                           const Dual<N>& time) {
  Eigen::Matrix<Dual<N>, Rows, Cols> out;
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    out.data()[i] = in_time(value.data()[i], rate.data()[i], time);
  }
  return out;
}

/// Attitude and rate of the target with their derivatives in time.
template <int N>
TargetTurn<Dual<N>> turn_over(const SpinEnclosure& spin, const Dual<N>& time) {
  const SpinRange range = spin.over(time.v);
  return {in_time(range.R, range.R_rate, time), in_time(range.omega, range.omega_rate, time)};
}

/// Rotation by `angle` about a constant unit axis: E + sin K + (1 - cos) K^2.
template <class S>
Matrix3<S> rotation_about(const Vector3d& axis, const S& angle) {
  const Matrix3<S> K = skew<double>(axis).template cast<S>();
  Matrix3<S> R = K * sin(angle) + Matrix3<S>(K * K) * (S(1.0) - cos(angle));
  for (int i = 0; i < 3; ++i) R(i, i) += S(1.0);
  return R;
}

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

/// @param x num_variables() entries
template <class S>
EncounterRange<S> encounter_over(const VariableEncounter& model, std::span<const S> x) {
  EncounterRange<S> out;
  out.phi = model.start.template cast<S>();
  for (std::size_t i = 0; i < model.free.size(); ++i) out.phi[model.free[i]] = x[i];
  out.R_NB = model.R_NB.template cast<S>();
  if (model.attitude_is_free) {
    const S& angle = x[static_cast<std::size_t>(model.attitude_index())];
    out.R_NB = rotation_about<S>(model.attitude_axis, angle) * out.R_NB;
  }
  if (!model.turn_basis.empty()) {
    Vector3<S> sigma = Vector3<S>::Zero();
    for (std::size_t i = 0; i < model.turn_basis.size(); ++i) {
      const S& entry = x[static_cast<std::size_t>(model.attitude_index()) + i];
      sigma += Vector3<S>(model.turn_basis[i].template cast<S>()) * entry;
      out.turn_size_squared += square(entry);
    }
    out.R_NB = rotation_by<S>(sigma, out.turn_size_squared) * out.R_NB;
  }

  out.closing_speed = S(model.stated.closing_speed);
  if (!model.follows_target()) {
    out.contact = contact_kinematics<S>(model, out.R_NB);
  } else if (model.time_is_free) {
    const S time = x[static_cast<std::size_t>(model.time_index())] * S(model.time_unit);
    const TargetTurn<S> turn = turn_over(*model.spin, time);
    const Vector3<S> velocity = model.estimate.linear_velocity.template cast<S>();
    const Vector3<S> position = Vector3<S>(model.estimate.pose.position.template cast<S>()) +
                                velocity * (time - S(model.estimate.time));
    const TargetKinematics<S> target{turn.R_NT, position, velocity, turn.omega};
    out.contact = contact_kinematics<S>(model, out.R_NB, target);
    out.closing_speed = speed_along<S>(out.contact, model.n, model.r);
  } else {
    out.contact.R_EB = Matrix3<S>(model.R_NT.transpose().template cast<S>()) * out.R_NB;
    out.contact.point = model.stated.contact.point.template cast<S>();
  }
  out.contact_point =
      model.hand_point ? Vector3<S>(model.hand_point->template cast<S>()) : out.contact.point;
  if (model.is_fixed()) {
    out.F = model.stated.F.template cast<S>();
    out.hand_point = model.stated_hand_point.template cast<S>();
    return out;
  }
  out.F = unit_wrench<S>(out.contact.R_EB, model.n, model.moment);
  if (model.hand_point && model.hand_frame == Frame::Base) {
    out.hand_point = out.contact_point;
  } else {
    out.hand_point =
        out.R_NB.transpose() *
        Vector3<S>(out.contact_point - Vector3<S>(model.base_position.template cast<S>()));
  }
  return out;
}

/// Cosine of the angle between the axis of the base that points along attitude_axis in the stated
/// attitude, and attitude_axis.
template <class S>
S tilt_cosine(const VariableEncounter& model, const EncounterRange<S>& at) {
  const Vector3d in_B = model.R_NB.transpose() * model.attitude_axis;
  const Vector3<S> axis = at.R_NB * Vector3<S>(in_B.cast<S>());
  return axis.dot(Vector3<S>(model.attitude_axis.cast<S>()));
}

}  // namespace stillbase::proof
