// Terms of the objective that come from outside the library.
#include "formulation/formulation_kernel.hpp"

namespace stillbase {

double Formulation::Parts::user_objective(const Eigen::VectorXd& x,
                                          const Scenario& scenario) const {
  if (user_terms.empty()) return 0;
  const Local<double> local = localise<double>(x);
  const auto at = posture(local, scenario);
  const auto hit_here = impact(local, at, scenario);
  Configuration where = configuration(x);
  if (scenario.joint_offset.size() > 0) where.phi += scenario.joint_offset;
  const ImpactSummary impact =
      summarize_impact(problem.robot, where.phi, problem.resistance,
                       hit_here.p * hit_here.encounter.F, hit_here.encounter.closing_speed);
  double sum = 0;
  for (const UserTerm& term : user_terms) {
    sum += std::pow(term.value(where, impact) / (term.size * objective_unit), 2) / 2;
  }
  return sum;
}

Eigen::VectorXd Formulation::Parts::user_gradient(const Eigen::VectorXd& x,
                                                  const Scenario& scenario) const {
  constexpr double kStep = 1e-5;
  Eigen::VectorXd out(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(x.size(), i);
    out[i] =
        (user_objective(x + step, scenario) - user_objective(x - step, scenario)) / (2 * kStep);
  }
  return out;
}

}  // namespace stillbase
