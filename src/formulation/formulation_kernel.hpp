// Where base and target are, what the impulse of a scenario does, and what the objective makes of
// it: for any number type.
#pragma once

#include "core/tangent.hpp"
#include "encounter/encounter_kernel.hpp"
#include "formulation/formulation_parts.hpp"

namespace stillbase {

namespace {

/// sin(sqrt(x)) / sqrt(x), smooth in x at zero.
template <class S>
S sinc_of_square(const S& x) {
  using std::sin;
  using std::sqrt;
  if (x > S(0.09)) {
    const S t = sqrt(x);
    return sin(t) / t;
  }
  return S(1) -
         x * (S(1. / 6) -
              x * (S(1. / 120) - x * (S(1. / 5040) - x * (S(1. / 362880) - x * S(1. / 39916800)))));
}

/// (t - sin t) / t^3 with t = sqrt(x).
template <class S>
S third_order_sine_remainder(const S& x) {
  using std::sin;
  using std::sqrt;
  if (x > S(0.09)) {
    const S t = sqrt(x);
    return (t - sin(t)) / (t * x);
  }
  return S(1. / 6) -
         x * (S(1. / 120) -
              x * (S(1. / 5040) -
                   x * (S(1. / 362880) - x * (S(1. / 39916800) - x * S(1. / 6227020800.)))));
}

/// Rotation matrix of a rotation vector; differentiable at zero, unlike the norm in it.
template <class S>
Matrix3<S> rotation_matrix(const Vector3<S>& a) {
  const S x = a.squaredNorm();
  const S half = sinc_of_square<S>(x / S(4));
  const Matrix3<S> A = skew<S>(a);
  Matrix3<S> R = A * sinc_of_square(x) + A * A * (half * half / S(2));
  for (int i = 0; i < 3; ++i) R(i, i) += S(1);
  return R;
}

/// J_r: exp(a + da) = exp(a) exp(J_r(a) da).
template <class S>
Matrix3<S> right_jacobian(const Vector3<S>& a) {
  const S x = a.squaredNorm();
  const S half = sinc_of_square<S>(x / S(4));
  const Matrix3<S> A = skew<S>(a);
  Matrix3<S> J = A * A * third_order_sine_remainder(x) - A * (half * half / S(2));
  for (int i = 0; i < 3; ++i) J(i, i) += S(1);
  return J;
}

}  // namespace

template <class S>
Local<S> Formulation::Parts::localise(const VectorX<S>& x) const {
  Local<S> out;
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
  out.contact = contact_kinematics<S>(model, out.R_NB, out.time);
  out.rates = contact_rates<S>(model, out.R_NB, out.contact);
  return out;
}

template <class S>
PostureImpact<S> Formulation::Parts::posture(const Local<S>& local) const {
  return evaluate_posture<S>(problem.robot, resistance, local.phi);
}

template <class S>
PostureImpact<S> Formulation::Parts::posture(const Local<S>& local,
                                             const Scenario& scenario) const {
  if (scenario.joint_offset.size() == 0) return posture(local);
  const JointVector<S> phi = local.phi + scenario.joint_offset.template cast<S>();
  return evaluate_posture<S>(problem.robot, resistance, phi);
}

template <class S>
ScenarioImpact<S> Formulation::Parts::encounter(const Local<S>& local,
                                                const Scenario& scenario) const {
  ScenarioImpact<S> out;
  if (scenario.time_offset != 0 && model.follows_target()) {
    const S time = local.time + S(scenario.time_offset);
    const ContactKinematics<S> contact = contact_kinematics<S>(model, local.R_NB, time);
    out.rates = contact_rates<S>(model, local.R_NB, contact);
    out.encounter = encounter_along<S>(model, contact, scenario);
  } else {
    out.rates = local.rates;
    out.encounter = encounter_along<S>(model, local.contact, scenario);
  }
  out.closing_speed_rate = closing_speed_rate<S>(model, out.encounter.contact, out.rates, scenario);
  return out;
}

template <class S>
ScenarioImpact<S> Formulation::Parts::impact(const Local<S>& local, const PostureImpact<S>& posture,
                                             const Scenario& scenario) const {
  ScenarioImpact<S> out = encounter<S>(local, scenario);
  out.response = respond<S>(posture, out.encounter.F);
  if (model.magnitude_is_given()) {
    out.p = S(model.magnitude);
  } else if (out.encounter.closing_speed > S(0)) {
    out.p = out.encounter.closing_speed * S(1 + scenario.restitution) /
            (out.response.hand_inverse_mass + S(out.encounter.target_inverse_mass));
  }
  return out;
}

template <class S>
JointVector<S> term_quantity(const ObjectiveTerm& term, const PostureImpact<S>& posture,
                             const ImpactResponse<S>& response) {
  const S inverse_size(1 / term.size);
  switch (term.quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return response.base * inverse_size;
    case ObjectiveQuantity::BaseAngularVelocity:
      return response.omega() * inverse_size;
    case ObjectiveQuantity::TotalAngularMomentum:
      return response.total * inverse_size;
    case ObjectiveQuantity::BaseMomentum: {
      Vector6<S> momentum = posture.inertia.H_b * response.d.Delta_Omega;
      momentum.template tail<3>() *= S(1 / term.length);
      return momentum * inverse_size;
    }
    case ObjectiveQuantity::ImpulseMagnitude:
      return JointVector<S>::Constant(1, inverse_size);
    case ObjectiveQuantity::JointRateNorm:
      return response.d.Delta_phidot * inverse_size;
    case ObjectiveQuantity::AttitudeTurned:
      break;  // no function of the jump alone: turns.cpp
  }
  return JointVector<S>();
}

template <class S>
void add_term_weights(const ObjectiveTerm& term, const JointVector<S>& u,
                      ResponseWeights<S>& weights) {
  const S inverse_size(1 / term.size);
  switch (term.quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      weights.base += u * inverse_size;
      break;
    case ObjectiveQuantity::BaseAngularVelocity:
      weights.omega += u * inverse_size;
      break;
    case ObjectiveQuantity::TotalAngularMomentum:
      weights.total += u * inverse_size;
      break;
    case ObjectiveQuantity::BaseMomentum:
      weights.momentum.template head<3>() += u.template head<3>() * inverse_size;
      weights.momentum.template tail<3>() += u.template tail<3>() * S(1 / term.size / term.length);
      break;
    case ObjectiveQuantity::ImpulseMagnitude:
      break;  // constant per unit of impulse
    case ObjectiveQuantity::JointRateNorm:
      if (weights.phidot.size() == 0) weights.phidot.setZero(u.size());
      weights.phidot += u * inverse_size;
      break;
    case ObjectiveQuantity::AttitudeTurned:
      break;
  }
}

template <class S>
void Formulation::Parts::add_contact_turn(const ContactRates<S>& rates, const Vector3<S>& g,
                                          ScalarGradient<S>& gradient) const {
  if (model.frame != ContactFrame::Base) gradient.theta += g;
  gradient.t += g.dot(rates.omega_EB);
}

template <class S>
void Formulation::Parts::add_wrench_turn(const ScenarioImpact<S>& hit, const Vector6<S>& by_F,
                                         ScalarGradient<S>& gradient) const {
  // Turning B by theta (in B) changes the wrench in B by F x theta.
  const Vector3<S> by_f = by_F.template head<3>(), by_t = by_F.template tail<3>();
  const Vector3<S> f = hit.encounter.F.template head<3>(), t = hit.encounter.F.template tail<3>();
  add_contact_turn<S>(hit.rates, by_f.cross(f) + by_t.cross(t), gradient);
}

template <class S>
void Formulation::Parts::add_speed_rate(const ScenarioImpact<S>& hit, const S& along_p,
                                        ScalarGradient<S>& gradient) const {
  if (model.magnitude_is_given() || !(hit.encounter.closing_speed > S(0))) return;
  gradient.t += along_p / hit.encounter.closing_speed * hit.closing_speed_rate;
}

template <class S>
ScalarGradient<S> Formulation::Parts::impact_gradient(const PostureImpact<S>& posture,
                                                      const ScenarioImpact<S>& hit,
                                                      const ResponseWeights<S>& weights) const {
  const auto raw = response_gradient<S>(problem.robot, posture, hit.response, weights);
  ScalarGradient<S> out(n());
  out.phi = raw.phi;
  add_wrench_turn<S>(hit, raw.F, out);
  return out;
}

template <class S>
ScalarGradient<S> Formulation::Parts::scaled_gradient(const PostureImpact<S>& posture,
                                                      const ScenarioImpact<S>& hit,
                                                      ResponseWeights<S> weights,
                                                      const S& along_p) const {
  // p = (1+e) v_n / (F' W_h F + n' W_t n), along_p = p d psi / d p.
  if (!model.magnitude_is_given() && hit.p > S(0)) {
    weights.hand_inverse_mass =
        -along_p / (hit.response.hand_inverse_mass + S(hit.encounter.target_inverse_mass));
  }
  ScalarGradient<S> out = impact_gradient<S>(posture, hit, weights);
  add_speed_rate<S>(hit, along_p, out);
  return out;
}

template <class S>
S Formulation::Parts::objective(const PostureImpact<S>& posture,
                                const ScenarioImpact<S>& hit) const {
  const S scale = hit.p / S(objective_unit);
  S sum(0);
  for (const ObjectiveTerm& term : problem.objective) {
    sum += term_quantity<S>(term, posture, hit.response).squaredNorm();
  }
  return scale * scale * sum / S(2);
}

template <class S>
ScalarGradient<S> Formulation::Parts::objective_gradient(const PostureImpact<S>& posture,
                                                         const ScenarioImpact<S>& hit) const {
  const S scale = hit.p / S(objective_unit);
  const S s2 = scale * scale;
  S sum(0);
  ResponseWeights<S> weights;
  for (const ObjectiveTerm& term : problem.objective) {
    const JointVector<S> y = term_quantity<S>(term, posture, hit.response);
    sum += y.squaredNorm();
    add_term_weights<S>(term, y * s2, weights);
  }
  return scaled_gradient<S>(posture, hit, weights, s2 * sum);
}

template <class S>
VectorX<S> Formulation::Parts::compress(const Local<S>& local,
                                        const ScalarGradient<S>& gradient) const {
  VectorX<S> out = VectorX<S>::Zero(layout.size);
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    out[static_cast<int>(i)] = gradient.phi[layout.joints[i]];
  }
  for (int i = 0; i < layout.attitude_size; ++i) {
    out[layout.attitude + i] = local.attitude_rates.col(i).dot(gradient.theta);
  }
  if (layout.time >= 0) out[layout.time] = gradient.t;
  return out;
}

template <class S>
VectorX<S> Formulation::Parts::lagrangian_gradient(const VectorX<S>& x,
                                                   const std::vector<Scenario>& scenarios,
                                                   const Eigen::VectorXd& weights,
                                                   const Eigen::VectorXd& multipliers) const {
  const Local<S> local = localise<S>(x);
  const PostureImpact<S> at = posture<S>(local);
  VectorX<S> out = VectorX<S>::Zero(layout.size);
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    const double weight = weights[static_cast<int>(k)];
    if (weight == 0) continue;
    const bool displaced = scenarios[k].joint_offset.size() > 0;
    const PostureImpact<S> own = displaced ? posture<S>(local, scenarios[k]) : PostureImpact<S>();
    const PostureImpact<S>& posture_k = displaced ? own : at;
    const ScenarioImpact<S> hit_k = impact<S>(local, posture_k, scenarios[k]);
    out += compress<S>(local, objective_gradient<S>(posture_k, hit_k)) * S(weight);
  }
  const ScenarioImpact<S> nominal = impact<S>(local, at, predicted());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double multiplier = multipliers[static_cast<int>(i)];
    if (multiplier == 0) continue;
    out += compress<S>(local, gradient_of<S>(rows[i], local, at, nominal)) * S(multiplier);
  }
  return out;
}

}  // namespace stillbase
