// The encounter for any number type: double, Tangent, and the enclosing numbers of proof.
#pragma once

#include <stillbase/core/rotation.hpp>
#include <stillbase/encounter/encounter.hpp>

#include "core/tangent.hpp"

namespace stillbase {

/// A function of time from its value and rate at one instant: exact for numbers that carry first
/// derivatives. @param dt time from that instant, of value zero
template <class S, int Rows, int Cols>
Eigen::Matrix<S, Rows, Cols> extend_in_time(const Eigen::Matrix<double, Rows, Cols>& value,
                                            const Eigen::Matrix<double, Rows, Cols>& rate,
                                            const S& dt) {
  return value.template cast<S>() + rate.template cast<S>() * dt;
}

/// Euler's equations of the free target: omega' = -I^-1 (omega x I omega), in T, rad/s^2.
template <class S>
Vector3<S> free_angular_acceleration(const EncounterModel& model, const Vector3<S>& omega) {
  const Matrix3<S> I = model.target_inertia.cast<S>();
  const Matrix3<S> inverse = model.target_inverse_inertia.cast<S>();
  return -(inverse * Vector3<S>(omega.cross(Vector3<S>(I * omega))));
}

/// @param state at the value of `time`
template <class S>
TargetKinematics<S> target_kinematics(const EncounterModel& model, const TargetState& state,
                                      const S& time) {
  const S dt = time - S(value_of_number(time));  // zero, with the derivatives of the time
  const Matrix3d R_NT = state.pose.orientation.toRotationMatrix();
  const Vector3d omega = R_NT.transpose() * state.angular_velocity;
  return {extend_in_time<S, 3, 3>(R_NT, R_NT * skew<double>(omega), dt),
          extend_in_time<S, 3, 1>(state.pose.position, state.linear_velocity, dt),
          state.linear_velocity.cast<S>(),
          extend_in_time<S, 3, 1>(omega, free_angular_acceleration<double>(model, omega), dt)};
}

template <class S>
TargetKinematics<S> target_kinematics(const EncounterModel& model, const S& time) {
  return target_kinematics<S>(model, model.target_state(value_of_number(time)), time);
}

template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB,
                                        const TargetKinematics<S>& target) {
  ContactKinematics<S> out;
  out.R_EB = target.R_NT.transpose() * R_NB;
  out.velocity = target.R_NT.transpose() * target.velocity;
  out.omega = target.omega;
  out.point = target.position + target.R_NT * Vector3<S>(model.r.cast<S>());
  return out;
}

template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB) {
  ContactKinematics<S> out;
  if (model.frame == ContactFrame::Base) {
    out.R_EB.setIdentity();
  } else {
    out.R_EB = R_NB;
  }
  return out;
}

template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB,
                                        const S& time) {
  return model.follows_target()
             ? contact_kinematics<S>(model, R_NB, target_kinematics<S>(model, time))
             : contact_kinematics<S>(model, R_NB);
}

template <class S>
ContactRates<S> contact_rates(const EncounterModel& model, const TargetKinematics<S>& target,
                              const ContactKinematics<S>& contact) {
  ContactRates<S> out;
  out.omega_EB = -(contact.R_EB.transpose() * contact.omega);
  out.point = target.R_NT * contact.velocity_at(Vector3<S>(model.r.cast<S>()));
  out.omega = free_angular_acceleration<S>(model, contact.omega);
  return out;
}

/// [n; moment] in B of a direction and a moment per unit of impulse in E.
template <class S>
Vector6<S> unit_wrench(const Matrix3<S>& R_EB, const Vector3d& direction, const Vector3d& moment) {
  const Matrix3<S> R_BE = R_EB.transpose();
  Vector6<S> F;
  F.template head<3>() = R_BE * Vector3<S>(direction.cast<S>());
  F.template tail<3>() = R_BE * Vector3<S>(moment.cast<S>());
  return F;
}

/// n . (v_target - v_hand) along a direction of E where the target moves as it does nominally, m/s.
/// @param r contact point in T, m
/// @pre model.follows_target()
template <class S>
S speed_along(const ContactKinematics<S>& contact, const Vector3d& direction, const Vector3d& r) {
  return Vector3<S>(direction.cast<S>()).dot(contact.velocity_at(Vector3<S>(r.cast<S>())));
}

template <class S>
Encounter<S> encounter_along(const EncounterModel& model, const ContactKinematics<S>& contact,
                             const Scenario& scenario) {
  Encounter<S> out;
  out.contact = contact;
  const Vector3d& d = scenario.direction;
  const Vector3d r = model.r + scenario.contact_offset;
  out.F =
      unit_wrench<S>(contact.R_EB, d, Vector3d(model.moment + scenario.contact_offset.cross(d)));
  out.closing_speed =
      (model.follows_target() ? speed_along<S>(contact, d, r) : S(model.closing_speed)) +
      S(scenario.closing_speed_offset);
  if (model.magnitude_is_given()) return out;
  out.target_inverse_mass = 1 / (model.target_mass * scenario.target_mass_factor);
  if (model.is_rigid()) {
    const double by_rotation = target_inverse_mass(kInfinity, model.target_inverse_inertia, r, d);
    out.target_inverse_mass += by_rotation / scenario.target_inertia_factor;
  }
  return out;
}

template <class S>
TargetAtHand<S> target_at_hand(const EncounterModel& model, const ContactKinematics<S>& contact,
                               const Scenario& scenario) {
  const Matrix3<S> R_BE = contact.R_EB.transpose();
  const Vector3d r = model.r + scenario.contact_offset;
  const auto turned = [&R_BE](const Matrix3d& I) -> Matrix3<S> {
    return R_BE * I.cast<S>() * R_BE.transpose();
  };
  TargetAtHand<S> out;
  out.inverse_mass = S(1 / (model.target_mass * scenario.target_mass_factor));
  Vector3<S> velocity = contact.velocity;
  if (model.is_rigid()) {
    out.inertia = turned(model.target_inertia * scenario.target_inertia_factor);
    out.inverse_inertia = turned(model.target_inverse_inertia / scenario.target_inertia_factor);
    out.r = R_BE * Vector3<S>(r.cast<S>());
    out.omega = R_BE * contact.omega;
  } else {
    out.inertia.setZero();
    out.inverse_inertia.setZero();
    out.r.setZero();
    out.omega.setZero();
    velocity = model.follows_target()
                   ? contact.velocity_at(Vector3<S>(r.cast<S>()))
                   : Vector3<S>(Vector3d(model.closing_speed * model.n).cast<S>());
  }
  velocity += Vector3d(scenario.closing_speed_offset * model.n).cast<S>();
  out.velocity = R_BE * velocity;
  return out;
}

template <class S>
TargetAtHandRates<S> target_at_hand_rates(const EncounterModel& model,
                                          const ContactKinematics<S>& contact,
                                          const ContactRates<S>& rates, const Scenario& scenario) {
  TargetAtHandRates<S> out;
  if (!model.follows_target()) return out;
  const Matrix3<S> R_BE = contact.R_EB.transpose();
  // The velocity of the centroid is constant in N.
  Vector3<S> velocity = contact.velocity.cross(contact.omega);
  if (model.is_rigid()) {
    out.omega = R_BE * rates.omega;
  } else {
    const Vector3<S> r = Vector3d(model.r + scenario.contact_offset).cast<S>();
    velocity += rates.omega.cross(r);
  }
  out.velocity = R_BE * velocity;
  return out;
}

template <class S>
void set_rigid_contact(const EncounterModel& model, const ContactKinematics<S>& contact,
                       const Scenario& scenario, RigidContact<S>& out) {
  out.law = model.law;
  out.target = target_at_hand<S>(model, contact, scenario);
  out.matched = model.matched;
  if (!model.hand_moves()) return;
  out.rates = model.arrival_rates;
  const Matrix3<S> R_BE = contact.R_EB.transpose();
  const Vector6<S> apart = model.apart.cast<S>();
  out.n = R_BE * Vector3<S>(model.n.cast<S>());
  out.apart.template head<3>() = R_BE * apart.template head<3>();
  out.apart.template tail<3>() = R_BE * apart.template tail<3>();
}

template <class S>
S closing_speed_rate(const EncounterModel& model, const ContactKinematics<S>& contact,
                     const ContactRates<S>& rates, const Scenario& scenario) {
  if (!model.follows_target()) return S(0);
  const Vector3<S> r = Vector3d(model.r + scenario.contact_offset).cast<S>();
  const Vector3<S> d = scenario.direction.cast<S>();
  return d.dot(rates.omega.cross(r) - contact.omega.cross(contact.velocity));
}

template <class S>
Matrix3<S> wanted_hand_axes(const EncounterModel& model, const Matrix3<S>& R_NB,
                            const Matrix3<S>& R_EB) {
  if (!model.stated_hand_axes) {
    return R_EB.transpose() * Matrix3<S>(model.hand_axes.cast<S>());
  }
  const Matrix3<S> R = model.stated_hand_axes->cast<S>();
  return model.hand_frame == Frame::Base ? R : Matrix3<S>(R_NB.transpose() * R);
}

}  // namespace stillbase
