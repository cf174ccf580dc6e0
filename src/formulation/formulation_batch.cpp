#include <algorithm>
#include <limits>

#include "formulation/formulation_kernel.hpp"

namespace stillbase {

namespace {

/// 1/2 |y|^2 / unit^2 for a unit impulse.
BatchObjective batch_objective(const CaptureProblem& problem, double unit) {
  BatchObjective out;
  for (const ObjectiveTerm& term : problem.objective) {
    const double weight = 1 / (term.size * term.size * unit * unit);
    switch (term.quantity) {
      case ObjectiveQuantity::BaseAngularMomentum:
        out.base += weight;
        break;
      case ObjectiveQuantity::BaseAngularVelocity:
        out.omega += weight;
        break;
      case ObjectiveQuantity::TotalAngularMomentum:
        out.total += weight;
        break;
      case ObjectiveQuantity::BaseMomentum:
        out.linear += weight;
        out.angular += weight / (term.length * term.length);
        break;
      case ObjectiveQuantity::ImpulseMagnitude:
        out.impulse += weight;
        break;
      case ObjectiveQuantity::JointRateNorm:
        out.joint_rates += weight;
        break;
      case ObjectiveQuantity::AttitudeTurned:
        break;  // simulated one by one
    }
  }
  return out;
}

}  // namespace

bool Formulation::Parts::in_packs(const std::vector<Scenario>& scenarios) const {
  return turns.empty() && user_terms.empty() && scenarios.size() >= kWorthPacks &&
         batch_lanes(n()) > 1;
}

void Formulation::Parts::resize_batch(Eigen::Index count) const {
  batch.phi.resize(count, n());
  batch.F.resize(count, 6);
  const Eigen::Index by_law = problem.impulse.source == ImpulseSource::Given ? 0 : count;
  batch.approach.resize(by_law);
  batch.target_inverse_mass.resize(by_law);
}

void Formulation::Parts::put_in_batch(const Local<double>& local, const ScenarioImpact<double>& hit,
                                      const Scenario& scenario, Eigen::Index row) const {
  batch.phi.row(row) = local.phi.transpose();
  if (scenario.joint_offset.size() > 0) batch.phi.row(row) += scenario.joint_offset.transpose();
  batch.F.row(row) = hit.encounter.F.transpose();
  if (model.magnitude_is_given()) return;
  batch.approach[row] = (1 + scenario.restitution) * std::max(hit.encounter.closing_speed, 0.0);
  batch.target_inverse_mass[row] = hit.encounter.target_inverse_mass;
}

void Formulation::Parts::evaluate_batch(bool derivatives) const {
  evaluate_objective(problem.robot, resistance, batch, batch_objective(problem, objective_unit),
                     derivatives, batch_values);
  if (problem.impulse.source != ImpulseSource::Given) return;
  const double p2 = problem.impulse.magnitude * problem.impulse.magnitude;
  batch_values.psi *= p2;
  if (!derivatives) return;
  batch_values.gradient *= p2;
  batch_values.gradient_F *= p2;
}

void Formulation::Parts::evaluate_in_packs(const Local<double>& local,
                                           const std::vector<Scenario>& scenarios, bool derivatives,
                                           ScenarioEvaluation& out) const {
  const auto count = static_cast<Eigen::Index>(scenarios.size());
  resize_batch(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
    put_in_batch(local, encounter(local, scenario), scenario, k);
  }
  evaluate_batch(derivatives);
  out.values = batch_values.psi;
  if (!derivatives) return;
  for (Eigen::Index k = 0; k < count; ++k) {
    const ScenarioImpact<double> met = encounter(local, scenarios[static_cast<std::size_t>(k)]);
    const double along_p = 2 * batch_values.psi[k];
    ScalarGradient<double> gradient(n());
    gradient.phi = batch_values.gradient.row(k);
    add_wrench_turn<double>(met, batch_values.gradient_F.row(k), gradient);
    add_speed_rate<double>(met, along_p, gradient);
    out.gradients.row(k) = compress(local, gradient);
  }
}

Eigen::MatrixXd Formulation::evaluate_points(const std::vector<Eigen::VectorXd>& points,
                                             const std::vector<Scenario>& scenarios) const {
  const Parts& parts = *parts_;
  const auto each = static_cast<Eigen::Index>(scenarios.size());
  const auto count = static_cast<Eigen::Index>(points.size());
  parts.evaluations += static_cast<long>(points.size());
  parts.resize_batch(count * each);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Local<double> local = parts.localise<double>(points[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < each; ++k) {
      const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
      parts.put_in_batch(local, parts.encounter(local, scenario), scenario, i * each + k);
    }
  }
  parts.evaluate_batch(false);
  Eigen::MatrixXd out = parts.batch_values.psi.reshaped(each, count).transpose();
  if (parts.turns.empty() && parts.user_terms.empty()) return out;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd& x = points[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < each; ++k) {
      const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
      if (!parts.turns.empty() && parts.simulations_stop.reached()) {
        out(i, k) = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      out(i, k) += parts.turn_vector(x, scenario).squaredNorm() / 2;
      out(i, k) += parts.user_objective(x, scenario);
    }
  }
  return out;
}

}  // namespace stillbase
