// Many scenarios at one point, and at many points: in the lanes of wide registers where that pays.
#include <algorithm>
#include <limits>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

void Formulation::evaluate_scenarios(const Eigen::VectorXd& x,
                                     const std::vector<Scenario>& scenarios, bool derivatives,
                                     ScenarioEvaluation& out) const {
  const Parts& parts = *parts_;
  const CaptureModel& model = parts.model;
  parts_->count(1);
  const auto at = model.place<double>(x);
  const auto count = static_cast<Eigen::Index>(scenarios.size());
  out.values.resize(count);
  out.constraints.resize(num_constraints());
  if (derivatives) {
    out.gradients.resize(count, x.size());
    out.jacobian.resize(num_constraints(), x.size());
  }
  const bool in_packs = parts.in_packs(scenarios);
  const auto posture = in_packs ? parts.posture_of_rows(at) : model.posture(at);
  if (in_packs) {
    parts.evaluate_in_packs(at, scenarios, derivatives, out);
  } else {
    for (Eigen::Index k = 0; k < count; ++k) {
      const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
      // No std::optional of a posture: g++ 12 fills all of it with zeros.
      const auto take = [&](const PostureImpact<double>& own) {
        const auto impact = model.impact(at, own, scenario);
        if (derivatives) {
          GradientRow gradient = out.gradients.row(k);
          out.values[k] = parts.objective(at, own, impact, scenario, &gradient);
        } else {
          out.values[k] = parts.objective(at, own, impact, scenario, nullptr);
        }
      };
      if (scenario.joint_offset.size() > 0) {
        take(model.posture(at, scenario));
      } else {
        take(posture);
      }
    }
  }
  const auto nominal = parts.impact_of_rows(at, posture);
  parts.evaluate_rows({model, at, posture, nominal}, out.constraints,
                      derivatives ? &out.jacobian : nullptr, out.far);
}

bool Formulation::Parts::in_packs(const std::vector<Scenario>& scenarios) const {
  constexpr std::size_t kWorthPacks = 3;  // fewer scenarios are faster one by one
  return differenced.empty() && scenarios.size() >= kWorthPacks && batch_lanes(model.n()) > 1 &&
         !model.encounter.hand_moves();
}

void Formulation::Parts::resize_batch(Eigen::Index count, ImpactBatch& batch) const {
  batch.phi.resize(count, model.n());
  batch.F.resize(count, 6);
  const EncounterModel& encounter = model.encounter;
  batch.law = encounter.law;
  batch.target.resize(encounter.is_rigid_contact() ? count : 0, kTargetNumbers);
  const bool is_whole = encounter.magnitude_is_given() || encounter.is_rigid_contact();
  const Eigen::Index by_law = is_whole ? 0 : count;
  batch.approach.resize(by_law);
  batch.target_inverse_mass.resize(by_law);
}

void Formulation::Parts::put_in_batch(const Placement<double>& at,
                                      const ScenarioImpact<double>& impact,
                                      const Scenario& scenario, Eigen::Index row,
                                      ImpactBatch& batch) const {
  const Encounter<double>& encounter = impact.encounter;
  batch.phi.row(row) = at.phi.transpose();
  if (scenario.joint_offset.size() > 0) batch.phi.row(row) += scenario.joint_offset.transpose();
  batch.F.row(row) = encounter.F.transpose();
  if (model.encounter.is_rigid_contact()) return put_target(impact.rigid.target, row, batch);
  if (model.encounter.magnitude_is_given()) return;
  const double speed = scenario.has_velocity_error() ? encounter.closing_speed
                                                     : std::max(encounter.closing_speed, 0.0);
  batch.approach[row] = (1 + scenario.restitution) * speed;
  batch.target_inverse_mass[row] = encounter.target_inverse_mass;
}

void Formulation::Parts::evaluate_batch(bool derivatives, const ImpactBatch& batch,
                                        BatchObjectiveValues& out) const {
  stillbase::evaluate_objective(model.problem.robot, model.resistance, batch,
                                jump.metrics(objective_unit), derivatives, out);
  if (!model.encounter.magnitude_is_given()) return;
  const double p2 = model.encounter.magnitude * model.encounter.magnitude;
  out.psi *= p2;
  if (!derivatives) return;
  out.gradient *= p2;
  out.gradient_F *= p2;
}

void Formulation::Parts::evaluate_in_packs(const Placement<double>& at,
                                           const std::vector<Scenario>& scenarios, bool derivatives,
                                           ScenarioEvaluation& out) const {
  const auto count = static_cast<Eigen::Index>(scenarios.size());
  resize_batch(count, out.batch);
  out.batch.is_one_posture = std::none_of(scenarios.begin(), scenarios.end(), [](const auto& one) {
    return one.joint_offset.size() > 0;
  });
  for (Eigen::Index k = 0; k < count; ++k) {
    const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
    put_in_batch(at, model.encounter_of(at, scenario), scenario, k, out.batch);
  }
  evaluate_batch(derivatives, out.batch, out.batch_values);
  out.values = out.batch_values.psi;
  if (!derivatives) return;
  ScalarGradient<double> gradient(model.n());
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto impact = model.encounter_of(at, scenarios[static_cast<std::size_t>(k)]);
    gradient.phi = out.batch_values.gradient.row(k);
    gradient.theta.setZero();
    gradient.t = 0;
    if (model.encounter.is_rigid_contact()) {
      const auto& of_target = out.batch_values.gradient_target;
      model.add_target_change<double>(impact, of_target.row(k).segment<3>(0),
                                      of_target.row(k).segment<3>(3),
                                      of_target.row(k).segment<3>(6), gradient);
      model.compress_into(at, gradient, out.gradients.row(k));
      continue;
    }
    model.add_wrench_turn<double>(impact, out.batch_values.gradient_F.row(k), gradient);
    model.add_speed_rate<double>(impact, 2 * out.values[k], gradient);
    model.compress_into(at, gradient, out.gradients.row(k));
  }
}

Eigen::MatrixXd Formulation::evaluate_points(const std::vector<Eigen::VectorXd>& points,
                                             const std::vector<Scenario>& scenarios) const {
  const Parts& parts = *parts_;
  const CaptureModel& model = parts.model;
  const auto each = static_cast<Eigen::Index>(scenarios.size());
  const auto count = static_cast<Eigen::Index>(points.size());
  parts_->count(static_cast<long>(points.size()));
  if (model.encounter.hand_moves()) {  // packs are of hands at rest
    Eigen::MatrixXd out(count, each);
    ScenarioEvaluation here;
    for (Eigen::Index i = 0; i < count; ++i) {
      evaluate_scenarios(points[static_cast<std::size_t>(i)], scenarios, false, here);
      out.row(i) = here.values.transpose();
    }
    return out;
  }
  ImpactBatch batch;
  parts.resize_batch(count * each, batch);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = model.place<double>(points[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < each; ++k) {
      const Scenario& scenario = scenarios[static_cast<std::size_t>(k)];
      parts.put_in_batch(at, model.encounter_of(at, scenario), scenario, i * each + k, batch);
    }
  }
  BatchObjectiveValues values;
  parts.evaluate_batch(false, batch, values);
  Eigen::MatrixXd out = values.psi.reshaped(each, count).transpose();
  if (parts.differenced.empty()) return out;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = model.place<double>(points[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < each; ++k) {
      parts.add_differenced(at, scenarios[static_cast<std::size_t>(k)], out(i, k), nullptr);
    }
  }
  return out;
}

}  // namespace stillbase
