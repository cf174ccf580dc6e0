#include <stillbase/capture/formulation.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/contact.hpp>

#include "capture/formulation_parts.hpp"

namespace stillbase {

double impulse_magnitude(const CaptureProblem& problem, const Encounter& encounter,
                         double hand_inverse_mass) {
  if (encounter.magnitude_given) return problem.impulse.magnitude;
  return normal_impulse(problem.impulse.restitution, encounter.closing_speed, hand_inverse_mass,
                        encounter.target_inverse_mass);
}

std::string to_string(ObjectiveQuantity quantity) {
  switch (quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return "base_angular_momentum";
    case ObjectiveQuantity::BaseAngularVelocity:
      return "base_angular_velocity";
    case ObjectiveQuantity::TotalAngularMomentum:
      return "total_angular_momentum";
  }
  return "";
}

std::string unit_of(ObjectiveQuantity quantity) {
  return quantity == ObjectiveQuantity::BaseAngularVelocity ? "rad/s" : "N m s";
}

Formulation::Formulation(const CaptureProblem& problem) : parts_(std::make_unique<Parts>(problem)) {
  // The middle of |y| over evenly spread points makes the objective of order one.
  std::vector<double> sizes;
  for (int sample = 0; sample < 15; ++sample) {
    const Local local = parts_->localise(
        parts_->start_point(low_discrepancy_point(sample, parts_->start_dimension(), 0)));
    const auto posture =
        evaluate_posture<double>(problem.robot, parts_->resistance, local.configuration.phi);
    const auto response = respond<double>(posture, local.encounter.F);
    sizes.push_back(parts_->magnitude(local, response) * parts_->quantity(response).norm());
  }
  std::nth_element(sizes.begin(), sizes.begin() + 7, sizes.end());
  if (sizes[7] > 0) parts_->objective_unit = sizes[7];
}

Formulation::~Formulation() = default;

int Formulation::num_variables() const { return parts_->layout.size; }
int Formulation::num_constraints() const { return static_cast<int>(parts_->rows.size()); }
Eigen::VectorXd Formulation::lower() const { return parts_->layout.lower; }
Eigen::VectorXd Formulation::upper() const { return parts_->layout.upper; }

Eigen::VectorXd Formulation::constraint_lower() const {
  Eigen::VectorXd out(num_constraints());
  for (int i = 0; i < out.size(); ++i) out[i] = parts_->rows[static_cast<std::size_t>(i)].lower;
  return out;
}

Eigen::VectorXd Formulation::constraint_upper() const {
  Eigen::VectorXd out(num_constraints());
  for (int i = 0; i < out.size(); ++i) out[i] = parts_->rows[static_cast<std::size_t>(i)].upper;
  return out;
}

int Formulation::num_equations() const {
  return static_cast<int>(std::count_if(parts_->rows.begin(), parts_->rows.end(),
                                        [](const Row& row) { return row.lower == row.upper; }));
}

void Formulation::evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  ++parts_->evaluations;
  const Local local = parts_->localise(x);
  const auto posture =
      evaluate_posture<double>(parts_->problem.robot, parts_->resistance, local.configuration.phi);
  const auto response = respond<double>(posture, local.encounter.F);
  const double scale = parts_->magnitude(local, response) / parts_->objective_unit;
  out.objective = (scale * parts_->quantity(response)).squaredNorm() / 2;
  out.constraints.resize(num_constraints());
  for (int i = 0; i < num_constraints(); ++i) {
    out.constraints[i] =
        parts_->value_of(parts_->rows[static_cast<std::size_t>(i)], local, posture, response);
  }
}

void Formulation::evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  ++parts_->evaluations;
  const Parts& parts = *parts_;
  const Local local = parts.localise(x);
  const auto posture =
      evaluate_posture<double>(parts.problem.robot, parts.resistance, local.configuration.phi);
  const auto response = respond<double>(posture, local.encounter.F);

  // psi = 1/2 |p y|^2 with p of the contact law, both smooth in the response.
  const Vector3d y = parts.quantity(response);
  const double p = parts.magnitude(local, response);
  const double scale = p / parts.objective_unit;
  out.objective = (scale * y).squaredNorm() / 2;
  const double s2 = scale * scale;
  ResponseWeights<double> weights = parts.quantity_weights(s2 * y);
  double d_closing_speed = 0;
  if (!local.encounter.magnitude_given && p > 0) {
    weights.hand_inverse_mass =
        -s2 * y.squaredNorm() / (response.hand_inverse_mass + local.encounter.target_inverse_mass);
    d_closing_speed = s2 * y.squaredNorm() / local.encounter.closing_speed;
  }
  ScalarGradient gradient = parts.impact_gradient(local, posture, response, weights);
  gradient.t += d_closing_speed * local.closing_speed_rate;
  out.gradient = parts.compress(x, gradient);

  const int m = num_constraints();
  out.constraints.resize(m);
  out.jacobian.resize(m, num_variables());
  for (int i = 0; i < m; ++i) {
    const Row& row = parts.rows[static_cast<std::size_t>(i)];
    out.constraints[i] = parts.value_of(row, local, posture, response);
    out.jacobian.row(i) = parts.compress(x, parts.gradient_of(row, local, posture, response));
  }
}

void Formulation::objective_vector(const Eigen::VectorXd& x, Vector3d& y,
                                   Eigen::MatrixXd& jacobian) const {
  ++parts_->evaluations;
  const Parts& parts = *parts_;
  const Local local = parts.localise(x);
  const auto posture =
      evaluate_posture<double>(parts.problem.robot, parts.resistance, local.configuration.phi);
  const auto response = respond<double>(posture, local.encounter.F);
  const double p = parts.magnitude(local, response);
  const double scale = p / parts.objective_unit;
  const Vector3d y_unit = parts.quantity(response);
  y = scale * y_unit;
  jacobian.resize(3, num_variables());
  for (int i = 0; i < 3; ++i) {
    ResponseWeights<double> weights = parts.quantity_weights(scale * Vector3d::Unit(i));
    double d_closing_speed = 0;
    if (!local.encounter.magnitude_given && p > 0) {
      weights.hand_inverse_mass =
          -y[i] / (response.hand_inverse_mass + local.encounter.target_inverse_mass);
      d_closing_speed = y[i] / local.encounter.closing_speed;
    }
    ScalarGradient gradient = parts.impact_gradient(local, posture, response, weights);
    gradient.t += d_closing_speed * local.closing_speed_rate;
    jacobian.row(i) = parts.compress(x, gradient);
  }
}

double Formulation::objective_unit() const { return parts_->objective_unit; }

void Formulation::lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                                     const Eigen::VectorXd& multipliers,
                                     Eigen::MatrixXd& out) const {
  // Central differences lose about h^2 and rounding / h: both near 1e-10 at this step.
  constexpr double kStep = 1e-5;
  const Eigen::Index size = x.size();
  nlp::Evaluation here;
  const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    evaluate(at, here);
    return sigma * here.gradient + here.jacobian.transpose() * multipliers;
  };
  out.resize(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(size, i);
    out.col(i) = (gradient(x + step) - gradient(x - step)) / (2 * kStep);
  }
  out = ((out + out.transpose()) / 2).eval();
}

Configuration Formulation::configuration(const Eigen::VectorXd& x) const {
  const Local local = parts_->localise(x);
  Configuration out = local.configuration;
  const bool follows = parts_->problem.variables.base_position != PositionFreedom::Fixed;
  const bool stated_in_N = parts_->hand_point && parts_->problem.hand.frame == Frame::Inertial;
  if (follows && (parts_->hand_follows_contact() || stated_in_N)) {
    const auto kinematics = compute_kinematics<double>(parts_->problem.robot, out.phi);
    const Vector3d point = parts_->hand_point ? *parts_->hand_point : local.contact->point;
    out.base.position = point - local.R_NB * kinematics.r_bh;
  }
  return out;
}

Encounter Formulation::encounter(const Configuration& configuration) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(num_variables());
  const VariableLayout& layout = parts_->layout;
  if (layout.time >= 0) x[layout.time] = configuration.contact_time;
  // Attitude variables from the attitude itself: only R_NB matters here.
  if (layout.attitude_size == 3) {
    x.segment<3>(layout.attitude) =
        rotation_log(parts_->problem.base.orientation.conjugate() * configuration.base.orientation);
  } else if (layout.attitude_size == 1) {
    x[layout.attitude] =
        rotation_log(configuration.base.orientation * parts_->problem.base.orientation.conjugate())
            .dot(parts_->problem.variables.base_attitude_axis);
  }
  return parts_->localise(x).encounter;
}

int Formulation::start_dimension() const { return parts_->start_dimension(); }

Eigen::VectorXd Formulation::start_point(const Eigen::VectorXd& u) const {
  return parts_->start_point(u);
}

double Formulation::distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  const VariableLayout& layout = parts_->layout;
  double sum = 0;
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    double d = a[static_cast<int>(i)] - b[static_cast<int>(i)];
    if (parts_->problem.robot.joints[static_cast<std::size_t>(layout.joints[i])].type ==
        JointType::Continuous) {
      d = wrap_angle(d);
    }
    sum += d * d;
  }
  if (layout.attitude_size > 0) {
    const double angle = layout.attitude_of(parts_->problem, a)
                             .angularDistance(layout.attitude_of(parts_->problem, b));
    sum += angle * angle;
  }
  if (layout.time >= 0) sum += std::pow(a[layout.time] - b[layout.time], 2);
  return std::sqrt(sum);
}

Eigen::VectorXd Formulation::normalised(const Eigen::VectorXd& x) const {
  Eigen::VectorXd out = x;
  const VariableLayout& layout = parts_->layout;
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    if (parts_->problem.robot.joints[static_cast<std::size_t>(layout.joints[i])].type ==
        JointType::Continuous) {
      out[static_cast<int>(i)] = wrap_angle(out[static_cast<int>(i)]);
    }
  }
  return out;
}

std::vector<ConstraintValue> Formulation::report(const Eigen::VectorXd& x) const {
  const Parts& parts = *parts_;
  const Local local = parts.localise(x);
  const auto posture =
      evaluate_posture<double>(parts.problem.robot, parts.resistance, local.configuration.phi);
  const auto response = respond<double>(posture, local.encounter.F);
  std::vector<ConstraintValue> out;
  const auto add = [&out](const std::string& name, double value, double lower, double upper) {
    out.push_back({name, value, lower, upper, std::max({lower - value, value - upper, 0.0})});
  };
  bool has_closing_speed = false;
  for (const Row& row : parts.rows) {
    add(row.name, parts.value_of(row, local, posture, response), row.lower, row.upper);
    has_closing_speed = has_closing_speed || row.kind == RowKind::ClosingSpeed;
  }
  if (!has_closing_speed && !local.encounter.magnitude_given) {
    add("closing_speed", local.encounter.closing_speed, parts.problem.constraints.closing_speed_min,
        kInfinity);
  }
  for (std::size_t i = 0; i < parts.layout.joints.size(); ++i) {
    const int k = parts.layout.joints[i];
    if (parts.problem.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous) {
      continue;
    }
    const int j = static_cast<int>(i);
    add("joint_limit_" + parts.problem.robot.joints[static_cast<std::size_t>(k)].name, x[j],
        parts.layout.lower[j], parts.layout.upper[j]);
  }
  return out;
}

long Formulation::evaluations() const { return parts_->evaluations; }

}  // namespace stillbase
