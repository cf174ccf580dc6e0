// The kernel on double, and the start points.
#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/constraints/rows_kernel.hpp"

namespace stillbase {

template Local<double> Formulation::Parts::localise(const VectorX<double>&) const;
template PostureImpact<double> Formulation::Parts::posture(const Local<double>&) const;
template ScenarioImpact<double> Formulation::Parts::impact(const Local<double>&,
                                                           const PostureImpact<double>&,
                                                           const Scenario&) const;
template double Formulation::Parts::objective(const PostureImpact<double>&,
                                              const ScenarioImpact<double>&) const;
template ScalarGradient<double> Formulation::Parts::objective_gradient(
    const PostureImpact<double>&, const ScenarioImpact<double>&) const;
template double Formulation::Parts::value_of(const Row&, const Local<double>&,
                                             const PostureImpact<double>&,
                                             const ScenarioImpact<double>&) const;
template ScalarGradient<double> Formulation::Parts::gradient_of(
    const Row&, const Local<double>&, const PostureImpact<double>&,
    const ScenarioImpact<double>&) const;
template double Formulation::Parts::value_and_gradient(const Row&, const Local<double>&,
                                                       const PostureImpact<double>&,
                                                       const ScenarioImpact<double>&,
                                                       ScalarGradient<double>&) const;
template VectorX<double> Formulation::Parts::compress(const Local<double>&,
                                                      const ScalarGradient<double>&) const;
template ScalarGradient<double> Formulation::Parts::scaled_gradient(const PostureImpact<double>&,
                                                                    const ScenarioImpact<double>&,
                                                                    ResponseWeights<double>,
                                                                    const double&) const;
template JointVector<double> term_quantity(const ObjectiveTerm&, const PostureImpact<double>&,
                                           const ImpactResponse<double>&);
template void add_term_weights(const ObjectiveTerm&, const JointVector<double>&,
                               ResponseWeights<double>&);

void Formulation::Parts::compress_into(
    const Local<double>& local, const ScalarGradient<double>& gradient,
    Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> out) const {
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    out[static_cast<int>(i)] = gradient.phi[layout.joints[i]];
  }
  for (int i = 0; i < layout.attitude_size; ++i) {
    out[layout.attitude + i] = local.attitude_rates.col(i).dot(gradient.theta);
  }
  if (layout.time >= 0) out[layout.time] = gradient.t;
}

Eigen::VectorXd Formulation::Parts::start_point(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(layout.size);
  for (int i = 0; i < layout.size; ++i) {
    double low = layout.lower[i], high = layout.upper[i];
    if (!std::isfinite(low) || !std::isfinite(high)) {
      low = std::isfinite(low) ? low : (std::isfinite(high) ? high - 2 * kPi : -kPi);
      high = std::isfinite(high) ? high : low + 2 * kPi;
    }
    x[i] = low + u[i] * (high - low);
  }
  if (layout.attitude_size == 3) {
    const double limit = problem.variables.base_attitude_max;
    const double a = u[layout.attitude], b = u[layout.attitude + 1], c = u[layout.attitude + 2];
    if (problem.variables.base_attitude == AttitudeFreedom::Cone) {
      // The axis even over its cap, the roll even over a turn.
      const Vector3d& axis = problem.variables.base_attitude_axis;
      const auto [e_1, e_2] = tangent_basis(axis);
      const double tilt = std::acos(1 - a * (1 - std::cos(limit)));
      const Vector3d about = std::cos(2 * kPi * b) * e_1 + std::sin(2 * kPi * b) * e_2;
      const Eigen::Quaterniond turn =
          rotation_exp(tilt * about) * rotation_exp(kPi * (2 * c - 1) * axis);
      const Eigen::Quaterniond& stated = problem.base.orientation;
      x.segment<3>(layout.attitude) = rotation_log(stated.conjugate() * turn * stated);
    } else if (limit > 3.14159) {
      // Uniform over rotations (Shoemake, Graphics Gems III, 1992).
      const Eigen::Quaterniond q(
          std::sqrt(a) * std::cos(2 * kPi * c), std::sqrt(1 - a) * std::sin(2 * kPi * b),
          std::sqrt(1 - a) * std::cos(2 * kPi * b), std::sqrt(a) * std::sin(2 * kPi * c));
      x.segment<3>(layout.attitude) = rotation_log(q);
    } else {
      const double z = 2 * a - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
      x.segment<3>(layout.attitude) =
          limit * std::cbrt(c) * Vector3d(r * std::cos(2 * kPi * b), r * std::sin(2 * kPi * b), z);
    }
  }
  return x;
}

Configuration Formulation::Parts::configuration(const Eigen::VectorXd& x) const {
  Configuration out;
  out.phi = layout.joint_positions(problem, x);
  out.base = problem.base;
  out.base.orientation = layout.attitude_of(problem, x);
  out.contact_time = layout.contact_time(problem, x);
  out.feature = problem.variables.feature;
  const bool follows = problem.variables.base_position != PositionFreedom::Fixed;
  const bool stated_in_N = model.hand_point && model.hand_frame == Frame::Inertial;
  if (follows && (model.hand_follows_target() || stated_in_N)) {
    const Vector3d point = model.hand_point ? *model.hand_point : localise<double>(x).contact.point;
    const auto kinematics = compute_kinematics<double>(problem.robot, out.phi);
    out.base.position = point - out.base.orientation * kinematics.r_bh;
  }
  return out;
}

}  // namespace stillbase
