#include "formulation/measures/scenario_program.hpp"

#include <algorithm>
#include <numeric>

#include <stillbase/formulation/measures/robust.hpp>

namespace stillbase {

ScenarioProgram::ScenarioProgram(const Formulation& formulation, std::vector<Scenario> scenarios,
                                 double scale, const CaptureProblem* follow)
    : ScenarioProgram(formulation, std::move(scenarios), std::nullopt, scale) {
  follow_ = follow;
  has_t_ = true;
}

ScenarioProgram::ScenarioProgram(const Formulation& formulation, std::vector<Scenario> scenarios,
                                 std::optional<double> level, double scale)
    : formulation_(formulation),
      scenarios_(std::move(scenarios)),
      scale_(scale),
      has_t_(level.has_value()),
      level_(level),
      n_(formulation.num_variables()),
      m_(formulation.num_constraints()),
      count_(static_cast<int>(scenarios_.size())),
      weights_(count_) {
  for (int k = 0; k < count_; ++k) weights_[k] = scenarios_[static_cast<std::size_t>(k)].weight;
}

std::vector<Scenario> ScenarioProgram::scenarios_at(const Eigen::VectorXd& x) const {
  if (follow_ == nullptr) return scenarios_;
  const std::vector<ConeMaximum> maxima =
      climb(*follow_, formulation_, formulation_.configuration(x), scenarios_);
  std::vector<Scenario> out;
  out.reserve(maxima.size());
  for (const ConeMaximum& maximum : maxima) out.push_back(maximum.scenario);
  return out;
}

Eigen::VectorXd ScenarioProgram::lower() const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(num_variables());
  out.head(n_) = formulation_.lower();
  // Not zero, though f is no less: a solver that steps onto that bound twice would take it for the
  // end, since its objective no longer changes.
  if (has_t_) out[n_] = -nlp::kInfinity;
  return out;
}

Eigen::VectorXd ScenarioProgram::upper() const {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(num_variables(), nlp::kInfinity);
  out.head(n_) = formulation_.upper();
  return out;
}

Eigen::VectorXd ScenarioProgram::constraint_lower() const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(num_constraints());
  out.head(m_) = formulation_.constraint_lower();
  return out;
}

Eigen::VectorXd ScenarioProgram::constraint_upper() const {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(num_constraints(), nlp::kInfinity);
  out.head(m_) = formulation_.constraint_upper();
  return out;
}

const ScenarioEvaluation& ScenarioProgram::evaluate_at(const Eigen::VectorXd& xtz, bool derivatives,
                                                       nlp::Evaluation& out) const {
  auto& here = out.workspace.as<ScenarioEvaluation>();
  const Eigen::VectorXd x = xtz.head(n_);
  here.far = derivatives ? out.far : nlp::kInfinity;
  if (follow_ != nullptr) {
    formulation_.evaluate_scenarios(x, scenarios_at(x), derivatives, here);
  } else {
    formulation_.evaluate_scenarios(x, scenarios_, derivatives, here);
  }
  out.constraints.resize(num_constraints());
  out.constraints.head(m_) = here.constraints;
  if (!has_t_) {
    out.objective = weights_.dot(here.values) / scale_;
    return here;
  }
  out.objective = xtz[n_];
  Eigen::ArrayXd most = Eigen::ArrayXd::Constant(count_, xtz[n_]);
  if (level_) {
    const auto z = xtz.tail(count_);
    out.objective += weights_.dot(z) / (1 - *level_);
    most += z.array();
  }
  out.constraints.tail(count_) = (most - here.values.array() / scale_).matrix();
  return here;
}

void ScenarioProgram::evaluate_value(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const {
  evaluate_at(xtz, false, out);
}

void ScenarioProgram::evaluate(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const {
  const ScenarioEvaluation& here = evaluate_at(xtz, true, out);
  out.gradient.setZero(num_variables());
  out.jacobian.setZero(num_constraints(), num_variables());
  out.jacobian.topLeftCorner(m_, n_) = here.jacobian;
  if (!has_t_) {
    out.gradient = here.gradients.transpose() * weights_ / scale_;
    return;
  }
  out.gradient[n_] = 1;
  out.jacobian.bottomLeftCorner(count_, n_) = here.gradients / -scale_;
  out.jacobian.block(m_, n_, count_, 1).setOnes();
  if (!level_) return;
  out.gradient.tail(count_) = weights_ / (1 - *level_);
  out.jacobian.bottomRightCorner(count_, count_).setIdentity();
}

void ScenarioProgram::lagrangian_hessian(const Eigen::VectorXd& xtz, double sigma,
                                         const Eigen::VectorXd& multipliers,
                                         Eigen::MatrixXd& out) const {
  const Eigen::VectorXd weights = has_t_ ? Eigen::VectorXd(multipliers.tail(count_) / -scale_)
                                         : Eigen::VectorXd(weights_ * (sigma / scale_));
  Eigen::MatrixXd inner;
  formulation_.scenario_hessian(xtz.head(n_), scenarios_, weights, multipliers.head(m_), inner);
  out.setZero(num_variables(), num_variables());
  out.topLeftCorner(n_, n_) = inner;
}

Eigen::VectorXd ScenarioProgram::lifted(const Eigen::VectorXd& x) const {
  if (!has_t_) return x;
  ScenarioEvaluation here;
  formulation_.evaluate_scenarios(x, scenarios_at(x), false, here);
  const Eigen::VectorXd f = here.values / scale_;
  Eigen::VectorXd out(num_variables());
  const double t = level_ ? tail_mean(f, weights_, *level_).quantile : f.maxCoeff();
  out.head(n_) = x;
  out[n_] = t;
  if (level_) out.tail(count_) = (f.array() - t).max(0).matrix();
  return out;
}

TailMean tail_mean(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double level) {
  std::vector<int> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&values](int a, int b) { return values[a] > values[b]; });
  // The largest value that no more than 1 - level of the weight exceeds.
  TailMean out;
  double above = 0;
  for (const int k : order) {
    out.quantile = values[k];
    above += weights[k];
    if (above >= (1 - level) * (1 - 1e-12)) break;
  }
  out.mean =
      out.quantile + weights.dot((values.array() - out.quantile).max(0).matrix()) / (1 - level);
  return out;
}

}  // namespace stillbase
