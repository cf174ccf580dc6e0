#include "formulation/measures/sampled_program.hpp"

#include <algorithm>
#include <numeric>

namespace stillbase {

SampledProgram::SampledProgram(const Formulation& formulation,
                               const std::vector<Scenario>& scenarios, std::optional<double> level,
                               double scale)
    : formulation_(formulation),
      scenarios_(scenarios),
      level_(level),
      scale_(scale),
      n_(formulation.num_variables()),
      m_(formulation.num_constraints()),
      count_(static_cast<int>(scenarios.size())),
      weights_(count_) {
  for (int k = 0; k < count_; ++k) weights_[k] = scenarios[static_cast<std::size_t>(k)].weight;
}

Eigen::VectorXd SampledProgram::lower() const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(num_variables());
  out.head(n_) = formulation_.lower();
  if (level_) out[n_] = -nlp::kInfinity;
  return out;
}

Eigen::VectorXd SampledProgram::upper() const {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(num_variables(), nlp::kInfinity);
  out.head(n_) = formulation_.upper();
  return out;
}

Eigen::VectorXd SampledProgram::constraint_lower() const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(num_constraints());
  out.head(m_) = formulation_.constraint_lower();
  return out;
}

Eigen::VectorXd SampledProgram::constraint_upper() const {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(num_constraints(), nlp::kInfinity);
  out.head(m_) = formulation_.constraint_upper();
  return out;
}

void SampledProgram::evaluate_value(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const {
  auto& here = out.workspace_as<ScenarioEvaluation>();
  formulation_.evaluate_scenarios(xtz.head(n_), scenarios_, false, here);
  out.constraints.resize(num_constraints());
  out.constraints.head(m_) = here.constraints;
  if (!level_) {
    out.objective = weights_.dot(here.values) / scale_;
    return;
  }
  const auto z = xtz.tail(count_);
  out.objective = xtz[n_] + weights_.dot(z) / (1 - *level_);
  out.constraints.tail(count_) = (z.array() + xtz[n_] - here.values.array() / scale_).matrix();
}

void SampledProgram::evaluate(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const {
  auto& here = out.workspace_as<ScenarioEvaluation>();
  formulation_.evaluate_scenarios(xtz.head(n_), scenarios_, true, here);
  out.constraints.resize(num_constraints());
  out.constraints.head(m_) = here.constraints;
  out.gradient.setZero(num_variables());
  out.jacobian.setZero(num_constraints(), num_variables());
  out.jacobian.topLeftCorner(m_, n_) = here.jacobian;
  if (!level_) {
    out.objective = weights_.dot(here.values) / scale_;
    out.gradient = here.gradients.transpose() * weights_ / scale_;
    return;
  }
  const auto z = xtz.tail(count_);
  out.objective = xtz[n_] + weights_.dot(z) / (1 - *level_);
  out.gradient[n_] = 1;
  out.gradient.tail(count_) = weights_ / (1 - *level_);
  out.constraints.tail(count_) = (z.array() + xtz[n_] - here.values.array() / scale_).matrix();
  out.jacobian.bottomLeftCorner(count_, n_) = here.gradients / -scale_;
  out.jacobian.block(m_, n_, count_, 1).setOnes();
  out.jacobian.bottomRightCorner(count_, count_).setIdentity();
}

void SampledProgram::lagrangian_hessian(const Eigen::VectorXd& xtz, double sigma,
                                        const Eigen::VectorXd& multipliers,
                                        Eigen::MatrixXd& out) const {
  const Eigen::VectorXd weights = level_ ? Eigen::VectorXd(multipliers.tail(count_) / -scale_)
                                         : Eigen::VectorXd(weights_ * (sigma / scale_));
  Eigen::MatrixXd inner;
  formulation_.scenario_hessian(xtz.head(n_), scenarios_, weights, multipliers.head(m_), inner);
  out.setZero(num_variables(), num_variables());
  out.topLeftCorner(n_, n_) = inner;
}

Eigen::VectorXd SampledProgram::lifted(const Eigen::VectorXd& x) const {
  if (!level_) return x;
  ScenarioEvaluation here;
  formulation_.evaluate_scenarios(x, scenarios_, false, here);
  const Eigen::VectorXd f = here.values / scale_;
  Eigen::VectorXd out(num_variables());
  const double t = tail_mean(f, weights_, *level_).quantile;
  out << x, t, (f.array() - t).max(0).matrix();
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
