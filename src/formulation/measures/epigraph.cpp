#include "formulation/measures/epigraph.hpp"

#include <stillbase/formulation/measures/robust.hpp>

namespace stillbase {

namespace {

Eigen::VectorXd joined(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd out(a.size() + b.size());
  out << a, b;
  return out;
}

}  // namespace

std::vector<Scenario> EpigraphProgram::scenarios_at(const Eigen::VectorXd& x) const {
  if (follow_ == nullptr) return scenarios_;
  std::vector<Scenario> out;
  for (const ConeMaximum& maximum :
       climb(*follow_, formulation_, formulation_.configuration(x), scenarios_)) {
    out.push_back(maximum.scenario);
  }
  return out;
}

int EpigraphProgram::num_constraints() const {
  return formulation_.num_constraints() + static_cast<int>(scenarios_.size());
}

Eigen::VectorXd EpigraphProgram::lower() const {
  // Not zero, though f is no less: a solver that steps onto that bound twice would take it for the
  // end, since its objective no longer changes.
  return joined(formulation_.lower(), Eigen::VectorXd::Constant(1, -nlp::kInfinity));
}
Eigen::VectorXd EpigraphProgram::upper() const {
  return joined(formulation_.upper(), Eigen::VectorXd::Constant(1, nlp::kInfinity));
}
Eigen::VectorXd EpigraphProgram::constraint_lower() const {
  const auto count = static_cast<Eigen::Index>(scenarios_.size());
  return joined(formulation_.constraint_lower(), Eigen::VectorXd::Zero(count));
}
Eigen::VectorXd EpigraphProgram::constraint_upper() const {
  const auto count = static_cast<Eigen::Index>(scenarios_.size());
  return joined(formulation_.constraint_upper(), Eigen::VectorXd::Constant(count, nlp::kInfinity));
}

void EpigraphProgram::evaluate_value(const Eigen::VectorXd& xs, nlp::Evaluation& out) const {
  const Eigen::Index n = xs.size() - 1;
  auto& here = out.workspace_as<ScenarioEvaluation>();
  formulation_.evaluate_scenarios(xs.head(n), scenarios_at(xs.head(n)), false, here);
  out.objective = xs[n];
  out.constraints = joined(here.constraints, (xs[n] - here.values.array() / scale_).matrix());
}

void EpigraphProgram::evaluate(const Eigen::VectorXd& xs, nlp::Evaluation& out) const {
  const Eigen::Index n = xs.size() - 1, m = formulation_.num_constraints(),
                     count = static_cast<Eigen::Index>(scenarios_.size());
  auto& here = out.workspace_as<ScenarioEvaluation>();
  formulation_.evaluate_scenarios(xs.head(n), scenarios_at(xs.head(n)), true, here);
  out.objective = xs[n];
  out.gradient = Eigen::VectorXd::Unit(n + 1, n);
  out.constraints = joined(here.constraints, (xs[n] - here.values.array() / scale_).matrix());
  out.jacobian.setZero(m + count, n + 1);
  out.jacobian.topLeftCorner(m, n) = here.jacobian;
  out.jacobian.bottomLeftCorner(count, n) = here.gradients / -scale_;
  out.jacobian.bottomRightCorner(count, 1).setOnes();
}

void EpigraphProgram::lagrangian_hessian(const Eigen::VectorXd& xs, double /*sigma*/,
                                         const Eigen::VectorXd& multipliers,
                                         Eigen::MatrixXd& out) const {
  const Eigen::Index n = xs.size() - 1, m = formulation_.num_constraints();
  Eigen::MatrixXd inner;
  formulation_.scenario_hessian(xs.head(n), scenarios_,
                                multipliers.tail(multipliers.size() - m) / -scale_,
                                multipliers.head(m), inner);
  out.setZero(n + 1, n + 1);
  out.topLeftCorner(n, n) = inner;
}

Eigen::VectorXd EpigraphProgram::lifted(const Eigen::VectorXd& x) const {
  ScenarioEvaluation here;
  formulation_.evaluate_scenarios(x, scenarios_at(x), false, here);
  return joined(x, Eigen::VectorXd::Constant(1, here.values.maxCoeff() / scale_));
}

}  // namespace stillbase
