#include "formulation/objectives/differenced_terms.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/impact/summary.hpp>

namespace stillbase {

namespace {

/// What a user's function is evaluated at.
struct UserPoint {
  Configuration configuration;
  ImpactSummary impact;
};

UserPoint user_point(const CaptureModel& model, const Eigen::VectorXd& x, const Scenario& scenario,
                     const Placement<double>& at, const ScenarioImpact<double>& impact) {
  UserPoint point{model.configuration(x), summarize_scenario(model, at, impact, scenario)};
  if (scenario.joint_offset.size() > 0) point.configuration.phi += scenario.joint_offset;
  return point;
}

}  // namespace

DifferencedTerms::DifferencedTerms(const CaptureProblem& problem)
    : simulated_(simulated_terms(problem)), users_(problem.user.terms) {}

Eigen::VectorXd DifferencedTerms::value(const CaptureModel& model, const Eigen::VectorXd& x,
                                        const Scenario& scenario, double unit,
                                        const StopCondition& stop) const {
  const auto turns = static_cast<Eigen::Index>(3 * simulated_.size());
  Eigen::VectorXd out(turns + static_cast<Eigen::Index>(users_.size()));
  if (empty()) return out;
  const Placement<double> at = model.place<double>(x);
  const auto impact = model.impact(at, model.posture(at, scenario), scenario);
  if (!simulated_.empty()) {
    JointVectord phi = at.phi;
    if (scenario.joint_offset.size() > 0) phi += scenario.joint_offset;
    const Vector6d Delta_Omega = impact.p * impact.response.d.Delta_Omega;
    const JointVectord Delta_phidot = impact.p * impact.response.d.Delta_phidot;
    Eigen::Index row = 0;
    for (const AttitudeTurned& term : simulated_) {
      out.segment<3>(row) = term(phi, Delta_Omega, Delta_phidot, stop) / unit;
      row += 3;
    }
  }
  if (users_.empty()) return out;
  const UserPoint point = user_point(model, x, scenario, at, impact);
  Eigen::Index row = turns;
  for (const UserTerm& term : users_) {
    out[row++] = term.value(point.configuration, point.impact) / term.size / unit;
  }
  return out;
}

Eigen::MatrixXd DifferencedTerms::jacobian(const CaptureModel& model, const Eigen::VectorXd& x,
                                           const Scenario& scenario, double unit,
                                           const StopCondition& stop) const {
  const auto turns = static_cast<Eigen::Index>(3 * simulated_.size());
  Eigen::MatrixXd out(turns + static_cast<Eigen::Index>(users_.size()), x.size());
  const bool needs_differences =
      !simulated_.empty() || std::any_of(users_.begin(), users_.end(),
                                         [](const UserTerm& term) { return !term.gradient; });
  for (Eigen::Index i = 0; i < x.size() && needs_differences; ++i) {
    out.col(i) = difference_along(model.layout, x, i, [&](const Eigen::VectorXd& at) {
      return value(model, at, scenario, unit, stop);
    });
  }
  for (std::size_t i = 0; i < users_.size(); ++i) {
    const UserTerm& term = users_[i];
    if (!term.gradient) continue;
    const Placement<double> at = model.place<double>(x);
    const auto impact = model.impact(at, model.posture(at, scenario), scenario);
    const UserPoint point = user_point(model, x, scenario, at, impact);
    out.row(turns + static_cast<Eigen::Index>(i)) =
        users_gradient(term.name, term.gradient, point.configuration, point.impact, x.size()) /
        term.size / unit;
  }
  return out;
}

double DifferencedTerms::square(const Configuration& configuration, const ImpactSummary& impact,
                                const StopCondition& stop) const {
  double sum = 0;
  for (const AttitudeTurned& term : simulated_) {
    sum += term(configuration.phi, impact.Omega_after(), impact.phidot_after(), stop).squaredNorm();
  }
  for (const UserTerm& term : users_) {
    sum += std::pow(term.value(configuration, impact) / term.size, 2);
  }
  return sum;
}

Eigen::RowVectorXd users_gradient(const std::string& name, const UserGradient& gradient,
                                  const Configuration& configuration, const ImpactSummary& impact,
                                  Eigen::Index N) {
  const Eigen::VectorXd out = gradient(configuration, impact);
  if (out.size() == N) return out.transpose();
  throw std::invalid_argument(fmt::format(
      "gradient of {}: has {} components, the search has {} variables", name, out.size(), N));
}

ImpactSummary summarize_scenario(const CaptureModel& model, const Placement<double>& at,
                                 const ScenarioImpact<double>& impact, const Scenario& scenario) {
  JointVectord phi = at.phi;
  if (scenario.joint_offset.size() > 0) phi += scenario.joint_offset;
  const double speed = impact.encounter.closing_speed;
  if (model.encounter.is_rigid_contact()) {
    return summarize_contact(model.problem.robot, phi, model.problem.resistance, impact.rigid,
                             speed);
  }
  return summarize_impact(model.problem.robot, phi, model.problem.resistance,
                          impact.p * impact.encounter.F, speed);
}

}  // namespace stillbase
