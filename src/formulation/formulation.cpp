#include <stillbase/formulation/formulation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/core/random.hpp>

#include "formulation/formulation_kernel.hpp"

namespace stillbase {

Formulation::Formulation(const CaptureProblem& problem, std::vector<UserTerm> user_terms)
    : parts_(std::make_unique<Parts>(problem)) {
  parts_->turns = turns_after_impact(problem);
  parts_->user_terms = std::move(user_terms);
  // The middle of |y| over evenly spread points makes the objective of order one.
  std::vector<double> sizes;
  for (int sample = 0; sample < 15; ++sample) {
    const Eigen::VectorXd x =
        parts_->start_point(low_discrepancy_point(sample, parts_->start_dimension(), 0));
    const Local<double> local = parts_->localise<double>(x);
    const auto posture = parts_->posture(local);
    const auto hit = parts_->impact<double>(local, posture, parts_->predicted());
    sizes.push_back(std::sqrt(
        parts_->turn_vector(x, parts_->predicted()).squaredNorm() +
        2 * (parts_->objective(posture, hit) + parts_->user_objective(x, parts_->predicted()))));
  }
  std::nth_element(sizes.begin(), sizes.begin() + 7, sizes.end());
  if (sizes[7] > 0) parts_->objective_unit = sizes[7];
  set_implied_rows_aside();
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

void Formulation::Parts::evaluate_one_by_one(const Local<double>& local,
                                             const PostureImpact<double>& stated,
                                             const ScenarioImpact<double>* predicted,
                                             const std::vector<Scenario>& scenarios,
                                             bool derivatives, ScenarioEvaluation& out) const {
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    const Scenario& scenario = scenarios[k];
    const auto row = static_cast<Eigen::Index>(k);
    // No std::optional of a posture: g++ 12 fills its 70 kB with zeros, a third of a local solve.
    const auto take = [&](const PostureImpact<double>& at, const ScenarioImpact<double>& hit_k) {
      out.values[row] = objective(at, hit_k);
      if (derivatives) compress_into(local, objective_gradient(at, hit_k), out.gradients.row(row));
    };
    if (scenario.joint_offset.size() > 0) {
      const PostureImpact<double> displaced = posture(local, scenario);
      take(displaced, impact(local, displaced, scenario));
    } else if (predicted != nullptr && &scenarios == &prediction) {
      take(stated, *predicted);
    } else {
      take(stated, impact(local, stated, scenario));
    }
    if (!turns.empty() && simulations_stop.reached()) {
      out.values[row] = std::numeric_limits<double>::quiet_NaN();
      if (derivatives) out.gradients.row(row).setConstant(out.values[row]);
      continue;
    }
    if (!turns.empty()) {
      const Eigen::VectorXd y = turn_vector(local.x, scenario);
      out.values[row] += y.squaredNorm() / 2;
      if (derivatives) out.gradients.row(row) += y.transpose() * turn_jacobian(local.x, scenario);
    }
    if (user_terms.empty()) continue;
    out.values[row] += user_objective(local.x, scenario);
    if (derivatives) out.gradients.row(row) += user_gradient(local.x, scenario);
  }
}

void Formulation::evaluate_scenarios(const Eigen::VectorXd& x,
                                     const std::vector<Scenario>& scenarios, bool derivatives,
                                     ScenarioEvaluation& out) const {
  ++parts_->evaluations;
  const Parts& parts = *parts_;
  const Local<double> local = parts.localise<double>(x);
  const PostureImpact<double> posture = parts.posture(local);
  const int count = static_cast<int>(scenarios.size()), m = num_constraints();
  out.values.resize(count);
  out.constraints.resize(m);
  if (derivatives) {
    out.gradients.resize(count, num_variables());
    out.jacobian.resize(m, num_variables());
  }
  ScenarioImpact<double> predicted;
  const bool has_hit = parts.rows_need_hit || &scenarios == &parts.prediction;
  if (has_hit) predicted = parts.impact(local, posture, parts.prediction.front());
  if (parts.in_packs(scenarios)) {
    parts.evaluate_in_packs(local, scenarios, derivatives, out);
  } else {
    parts.evaluate_one_by_one(local, posture, has_hit ? &predicted : nullptr, scenarios,
                              derivatives, out);
  }
  ScalarGradient<double> gradient(parts.n());
  for (int i = 0; i < m; ++i) {
    const Row& row = parts.rows[static_cast<std::size_t>(i)];
    if (!derivatives) {
      out.constraints[i] = parts.value_of(row, local, posture, predicted);
      continue;
    }
    out.constraints[i] = parts.value_and_gradient(row, local, posture, predicted, gradient);
    parts.compress_into(local, gradient, out.jacobian.row(i));
  }
}

void Formulation::evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  ScenarioEvaluation& here = parts_->at_last;
  evaluate_scenarios(x, parts_->prediction, false, here);
  out.objective = here.values[0];
  out.constraints = here.constraints;
}

void Formulation::evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  ScenarioEvaluation& here = parts_->at_last;
  evaluate_scenarios(x, parts_->prediction, true, here);
  out.objective = here.values[0];
  out.gradient = here.gradients.row(0);
  out.constraints = here.constraints;
  out.jacobian = here.jacobian;
}

Scenario Formulation::predicted_scenario() const { return parts_->predicted(); }

void Formulation::objective_vector(const Eigen::VectorXd& x, Eigen::VectorXd& y,
                                   Eigen::MatrixXd& jacobian) const {
  ++parts_->evaluations;
  const Parts& parts = *parts_;
  const Local<double> local = parts.localise<double>(x);
  const auto posture = parts.posture(local);
  const auto hit = parts.impact(local, posture, parts.predicted());
  const double scale = hit.p / parts.objective_unit;
  std::vector<double> values;
  std::vector<Eigen::VectorXd> rows;
  for (const ObjectiveTerm& term : parts.problem.objective) {
    const JointVectord y_term = term_quantity<double>(term, posture, hit.response);
    for (Eigen::Index i = 0; i < y_term.size(); ++i) {
      ResponseWeights<double> weights;
      const JointVectord u = scale * JointVectord::Unit(y_term.size(), i);
      add_term_weights<double>(term, u, weights);
      values.push_back(scale * y_term[i]);
      rows.push_back(
          parts.compress(local, parts.scaled_gradient(posture, hit, weights, values.back())));
    }
  }
  const auto jumps = static_cast<Eigen::Index>(values.size());
  const Eigen::VectorXd turned = parts.turn_vector(x, parts.predicted());
  y.resize(jumps + turned.size());
  y.head(jumps) = Eigen::Map<const Eigen::VectorXd>(values.data(), jumps);
  y.tail(turned.size()) = turned;
  jacobian.resize(y.size(), num_variables());
  for (Eigen::Index i = 0; i < jumps; ++i) jacobian.row(i) = rows[static_cast<std::size_t>(i)];
  if (turned.size() == 0) return;
  jacobian.bottomRows(turned.size()) = parts.turn_jacobian(x, parts.predicted());
}

bool Formulation::has_hessian() const {
  return parts_->turns.empty() && parts_->user_terms.empty();
}

const std::vector<UserTerm>& Formulation::user_terms() const { return parts_->user_terms; }

double Formulation::objective_unit() const { return parts_->objective_unit; }

Configuration Formulation::configuration(const Eigen::VectorXd& x) const {
  return parts_->configuration(x);
}

Eigen::VectorXd Formulation::variables(const Configuration& configuration) const {
  Eigen::VectorXd x(num_variables());
  const VariableLayout& layout = parts_->layout;
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    x[static_cast<int>(i)] = configuration.phi[layout.joints[i]];
  }
  if (layout.time >= 0) x[layout.time] = configuration.contact_time;
  if (layout.attitude_size == 3) {
    x.segment<3>(layout.attitude) =
        rotation_log(parts_->problem.base.orientation.conjugate() * configuration.base.orientation);
  } else if (layout.attitude_size == 1) {
    x[layout.attitude] =
        rotation_log(configuration.base.orientation * parts_->problem.base.orientation.conjugate())
            .dot(parts_->problem.variables.base_attitude_axis);
  }
  return x;
}

const EncounterModel& Formulation::encounter_model() const { return parts_->model; }

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
  const Local<double> local = parts.localise<double>(x);
  const auto posture = parts.posture(local);
  const auto hit = parts.impact(local, posture, parts.predicted());
  std::vector<ConstraintValue> out;
  const auto add = [&out](const std::string& name, double value, double lower, double upper) {
    out.push_back({name, value, lower, upper, std::max({lower - value, value - upper, 0.0})});
  };
  bool has_closing_speed = false;
  for (const Row& row : parts.rows) {
    add(row.name, parts.value_of(row, local, posture, hit), row.lower, row.upper);
    has_closing_speed = has_closing_speed || row.kind == RowKind::ClosingSpeed;
  }
  for (const Row& row : parts.implied_rows) {
    add(row.name, parts.value_of(row, local, posture, hit), row.lower, row.upper);
  }
  if (!has_closing_speed && !parts.model.magnitude_is_given()) {
    add("closing_speed", hit.encounter.closing_speed, parts.problem.constraints.closing_speed_min,
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

void Formulation::give_up_simulations_at(const StopCondition& stop) {
  parts_->simulations_stop = stop;
}

const StopCondition& Formulation::simulations_stop() const { return parts_->simulations_stop; }

}  // namespace stillbase
