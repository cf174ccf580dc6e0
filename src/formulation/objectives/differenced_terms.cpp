#include "formulation/objectives/differenced_terms.hpp"

#include <cmath>

#include <stillbase/impact/summary.hpp>

namespace stillbase {

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
  Configuration where = model.configuration(x);
  if (scenario.joint_offset.size() > 0) where.phi += scenario.joint_offset;
  const ImpactSummary summary = summarize_scenario(model, at, impact, scenario);
  Eigen::Index row = turns;
  for (const UserTerm& term : users_) out[row++] = term.value(where, summary) / term.size / unit;
  return out;
}

Eigen::MatrixXd DifferencedTerms::jacobian(const CaptureModel& model, const Eigen::VectorXd& x,
                                           const Scenario& scenario, double unit,
                                           const StopCondition& stop) const {
  const auto height = static_cast<Eigen::Index>(3 * simulated_.size() + users_.size());
  Eigen::MatrixXd out(height, x.size());
  for (Eigen::Index i = 0; i < x.size() && height > 0; ++i) {
    out.col(i) = difference_along(model.layout, x, i, [&](const Eigen::VectorXd& at) {
      return value(model, at, scenario, unit, stop);
    });
  }
  return out;
}

double DifferencedTerms::square(const Configuration& configuration, const ImpactSummary& impact,
                                const StopCondition& stop) const {
  double sum = 0;
  for (const AttitudeTurned& term : simulated_) {
    sum += term(configuration.phi, impact.Delta_Omega, impact.Delta_phidot, stop).squaredNorm();
  }
  for (const UserTerm& term : users_) {
    sum += std::pow(term.value(configuration, impact) / term.size, 2);
  }
  return sum;
}

ImpactSummary summarize_scenario(const CaptureModel& model, const Placement<double>& at,
                                 const ScenarioImpact<double>& impact, const Scenario& scenario) {
  JointVectord phi = at.phi;
  if (scenario.joint_offset.size() > 0) phi += scenario.joint_offset;
  return summarize_impact(model.problem.robot, phi, model.problem.resistance,
                          impact.p * impact.encounter.F, impact.encounter.closing_speed);
}

}  // namespace stillbase
