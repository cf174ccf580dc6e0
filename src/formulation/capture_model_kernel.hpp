// The lines of capture_model.hpp, for any number type.
#pragma once

#include "encounter/encounter_kernel.hpp"
#include "formulation/capture_model.hpp"
#include "formulation/variables/rotation_kernel.hpp"

namespace stillbase {

template <class S>
TargetKinematics<S> CaptureModel::target_at(const S& time) const {
  if (!latest_motion) return target_kinematics<S>(encounter, time);
  return target_kinematics<S>(encounter, latest_motion->state(value_of_number(time)), time);
}

template <class S>
Placement<S> CaptureModel::place(const VectorX<S>& x) const {
  Placement<S> out;
  out.x = x;
  out.phi = problem.start.template cast<S>();
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    out.phi[layout.joints[i]] = x[static_cast<int>(i)];
  }
  out.time = layout.time < 0 ? S(problem.variables.contact_time_lower) : x[layout.time];
  const Matrix3<S> stated = problem.base.orientation.toRotationMatrix().cast<S>();
  out.R_NB = stated;
  if (layout.attitude_size == 1) {
    const Vector3<S> axis = problem.variables.base_attitude_axis.cast<S>();
    out.R_NB = rotation_matrix<S>(axis * x[layout.attitude]) * stated;
    out.attitude_rates.col(0) = out.R_NB.transpose() * axis;
  } else if (layout.attitude_size == 3) {
    const Vector3<S> a = x.template segment<3>(layout.attitude);
    out.R_NB = stated * rotation_matrix<S>(a);
    out.attitude_rates = right_jacobian<S>(a);
  }
  if (encounter.follows_target()) {
    const TargetKinematics<S> target = target_at<S>(out.time);
    out.contact = contact_kinematics<S>(encounter, out.R_NB, target);
    out.rates = contact_rates<S>(encounter, target, out.contact);
  } else {
    out.contact = contact_kinematics<S>(encounter, out.R_NB);
  }
  return out;
}

template <class S>
PostureImpact<S> CaptureModel::posture(const Placement<S>& at) const {
  return evaluate_posture<S>(problem.robot, resistance, at.phi);
}

template <class S>
PostureImpact<S> CaptureModel::posture(const Placement<S>& at, const Scenario& scenario) const {
  if (scenario.joint_offset.size() == 0) return posture(at);
  const JointVector<S> phi = at.phi + scenario.joint_offset.template cast<S>();
  return evaluate_posture<S>(problem.robot, resistance, phi);
}

template <class S>
ScenarioImpact<S> CaptureModel::encounter_of(const Placement<S>& at,
                                             const Scenario& scenario) const {
  ScenarioImpact<S> out;
  if (scenario.time_offset != 0 && encounter.follows_target()) {
    const auto target = target_at<S>(at.time + S(scenario.time_offset));
    const ContactKinematics<S> contact = contact_kinematics<S>(encounter, at.R_NB, target);
    out.rates = contact_rates<S>(encounter, target, contact);
    out.encounter = encounter_along<S>(encounter, contact, scenario);
  } else {
    out.rates = at.rates;
    out.encounter = encounter_along<S>(encounter, at.contact, scenario);
  }
  out.closing_speed_rate =
      closing_speed_rate<S>(encounter, out.encounter.contact, out.rates, scenario);
  if (encounter.is_rigid_contact()) {
    const ContactKinematics<S>& contact = out.encounter.contact;
    set_rigid_contact<S>(encounter, contact, scenario, out.rigid);
    out.target_rates = target_at_hand_rates<S>(encounter, contact, out.rates, scenario);
  }
  if (residual && scenario.has_velocity_error()) {
    add_velocity_error<S>(scenario, at.time + S(scenario.time_offset), out);
  }
  return out;
}

template <class S>
void CaptureModel::add_velocity_error(const Scenario& scenario, const S& time,
                                      ScenarioImpact<S>& impact) const {
  const double t = value_of_number(time);
  const auto derivative = [&](int order) {
    return residual->applied(scenario.velocity_error, t, order);
  };
  const S dt = time - S(t);  // zero, with the derivatives of the time
  const Vector6d rate_now = derivative(1);
  const Vector6<S> error = extend_in_time<S, 6, 1>(derivative(0), rate_now, dt);
  const Vector6<S> rate = extend_in_time<S, 6, 1>(rate_now, derivative(2), dt);
  const Vector3<S> d = scenario.direction.cast<S>();
  impact.encounter.closing_speed += d.dot(error.template head<3>());
  impact.closing_speed_rate += d.dot(rate.template head<3>());
  if (!encounter.is_rigid_contact()) return;
  // [v; omega] at the hand, and the velocity of the centroid v - omega x r.
  const Matrix3<S> R_BE = impact.encounter.contact.R_EB.transpose();
  TargetAtHand<S>& target = impact.rigid.target;
  const auto add = [&](const Vector6<S>& at_hand, Vector3<S>& velocity, Vector3<S>& omega) {
    const Vector3<S> turning = R_BE * at_hand.template tail<3>();
    velocity += R_BE * at_hand.template head<3>() - turning.cross(target.r);
    omega += turning;
  };
  add(error, target.velocity, target.omega);
  add(rate, impact.target_rates.velocity, impact.target_rates.omega);
  if (!encounter.hand_moves()) return;
  const auto add_apart = [&](const Vector6<S>& at_hand, Vector6<S>& apart) {
    apart.template head<3>() += R_BE * at_hand.template head<3>();
    apart.template tail<3>() += R_BE * at_hand.template tail<3>();
  };
  add_apart(error, impact.rigid.apart);
  add_apart(rate, impact.apart_rate);
}

template <class S>
ScenarioImpact<S> CaptureModel::impact(const Placement<S>& at, const PostureImpact<S>& posture,
                                       const Scenario& scenario) const {
  ScenarioImpact<S> out = encounter_of<S>(at, scenario);
  if (encounter.is_rigid_contact()) {
    out.response = respond_to_contact<S>(posture, out.rigid);
    out.p = S(1);
    return out;
  }
  out.response = respond<S>(posture, out.encounter.F);
  if (encounter.magnitude_is_given()) {
    out.p = S(encounter.magnitude);
  } else if (out.encounter.closing_speed > S(0) || scenario.has_velocity_error()) {
    out.p = out.encounter.closing_speed * S(1 + scenario.restitution) /
            (out.response.hand_inverse_mass + S(out.encounter.target_inverse_mass));
  }
  return out;
}

template <class S>
void CaptureModel::add_contact_turn(const ContactRates<S>& rates, const Vector3<S>& g,
                                    ScalarGradient<S>& gradient) const {
  if (encounter.frame != ContactFrame::Base) gradient.theta += g;
  gradient.t += g.dot(rates.omega_EB);
}

template <class S>
void CaptureModel::add_wrench_turn(const ScenarioImpact<S>& impact, const Vector6<S>& by_F,
                                   ScalarGradient<S>& gradient) const {
  // Turning B by theta (in B) changes the wrench in B by F x theta.
  const Vector6<S>& F = impact.encounter.F;
  const Vector3<S> by_f = by_F.template head<3>(), by_t = by_F.template tail<3>();
  const Vector3<S> f = F.template head<3>(), t = F.template tail<3>();
  add_contact_turn<S>(impact.rates, by_f.cross(f) + by_t.cross(t), gradient);
}

template <class S>
void CaptureModel::add_target_change(const ScenarioImpact<S>& impact, const Vector3<S>& turn,
                                     const Vector3<S>& velocity, const Vector3<S>& omega,
                                     ScalarGradient<S>& gradient) const {
  add_contact_turn<S>(impact.rates, turn, gradient);
  gradient.t += velocity.dot(impact.target_rates.velocity) + omega.dot(impact.target_rates.omega);
}

template <class S>
ScalarGradient<S> CaptureModel::contact_change(const ScenarioImpact<S>& impact,
                                               const ContactGradient<S>& by_contact) const {
  ScalarGradient<S> out(n());
  out.phi = by_contact.phi;
  add_target_change<S>(impact, by_contact.turn, by_contact.velocity, by_contact.omega, out);
  if (encounter.hand_moves()) out.t += by_contact.apart.dot(impact.apart_rate);
  return out;
}

template <class S>
void CaptureModel::add_speed_rate(const ScenarioImpact<S>& impact, const S& along_p,
                                  ScalarGradient<S>& gradient) const {
  const S& speed = impact.encounter.closing_speed;
  // Errors of the velocity count as if the contact could pull; without them p and along_p are zero.
  if (encounter.magnitude_is_given() || value_of_number(speed) == 0) return;
  gradient.t += along_p / speed * impact.closing_speed_rate;
}

template <class S>
ScalarGradient<S> CaptureModel::impact_gradient(const PostureImpact<S>& posture,
                                                const ScenarioImpact<S>& impact,
                                                const ResponseWeights<S>& weights) const {
  if (encounter.is_rigid_contact()) {
    return contact_change<S>(impact, contact_gradient<S>(problem.robot, posture, impact.rigid,
                                                         impact.response, weights));
  }
  ScalarGradient<S> out(n());
  const auto raw = response_gradient<S>(problem.robot, posture, impact.response, weights);
  out.phi = raw.phi;
  add_wrench_turn<S>(impact, raw.F, out);
  return out;
}

template <class S>
ScalarGradient<S> CaptureModel::motion_before_gradient(const PostureImpact<S>& posture,
                                                       const ScenarioImpact<S>& impact,
                                                       const HandMotionWeights<S>& weights) const {
  return contact_change<S>(
      impact, stillbase::motion_before_gradient<S>(problem.robot, posture, impact.rigid, weights));
}

template <class S>
ScalarGradient<S> CaptureModel::scaled_gradient(const PostureImpact<S>& posture,
                                                const ScenarioImpact<S>& impact,
                                                ResponseWeights<S> weights,
                                                const S& along_p) const {
  if (encounter.is_rigid_contact()) return impact_gradient<S>(posture, impact, weights);
  // p = (1+e) v_n / (F' W_h F + n' W_t n), along_p = p d psi / d p.
  if (!encounter.magnitude_is_given() && impact.p != S(0)) {
    weights.hand_inverse_mass =
        -along_p / (impact.response.hand_inverse_mass + S(impact.encounter.target_inverse_mass));
  }
  ScalarGradient<S> out = impact_gradient<S>(posture, impact, weights);
  add_speed_rate<S>(impact, along_p, out);
  return out;
}

/// The member templates on S, instantiated.
#define STILLBASE_INSTANTIATE_CAPTURE_MODEL(S)                                                  \
  template Placement<S> CaptureModel::place(const VectorX<S>&) const;                           \
  template PostureImpact<S> CaptureModel::posture(const Placement<S>&) const;                   \
  template PostureImpact<S> CaptureModel::posture(const Placement<S>&, const Scenario&) const;  \
  template ScenarioImpact<S> CaptureModel::encounter_of(const Placement<S>&, const Scenario&)   \
      const;                                                                                    \
  template ScenarioImpact<S> CaptureModel::impact(const Placement<S>&, const PostureImpact<S>&, \
                                                  const Scenario&) const;                       \
  template ScalarGradient<S> CaptureModel::impact_gradient(                                     \
      const PostureImpact<S>&, const ScenarioImpact<S>&, const ResponseWeights<S>&) const;      \
  template ScalarGradient<S> CaptureModel::motion_before_gradient(                              \
      const PostureImpact<S>&, const ScenarioImpact<S>&, const HandMotionWeights<S>&) const;    \
  template ScalarGradient<S> CaptureModel::scaled_gradient(                                     \
      const PostureImpact<S>&, const ScenarioImpact<S>&, ResponseWeights<S>, const S&) const;   \
  template void CaptureModel::add_contact_turn(const ContactRates<S>&, const Vector3<S>&,       \
                                               ScalarGradient<S>&) const;                       \
  template void CaptureModel::add_wrench_turn(const ScenarioImpact<S>&, const Vector6<S>&,      \
                                              ScalarGradient<S>&) const;                        \
  template void CaptureModel::add_target_change(const ScenarioImpact<S>&, const Vector3<S>&,    \
                                                const Vector3<S>&, const Vector3<S>&,           \
                                                ScalarGradient<S>&) const;                      \
  template ScalarGradient<S> CaptureModel::contact_change(const ScenarioImpact<S>&,             \
                                                          const ContactGradient<S>&) const;     \
  template void CaptureModel::add_speed_rate(const ScenarioImpact<S>&, const S&,                \
                                             ScalarGradient<S>&) const

}  // namespace stillbase
