// Exact second derivatives: the gradient's own lines, differentiated forwards along each variable.
#include <algorithm>

#include "formulation/formulation_parts.hpp"
#include "formulation/objectives/jump_objective_kernel.hpp"

namespace stillbase {

VectorX<Tangent> Formulation::Parts::lagrangian_gradient(const VectorX<Tangent>& x,
                                                         const std::vector<Scenario>& scenarios,
                                                         const Eigen::VectorXd& weights,
                                                         const Eigen::VectorXd& multipliers) const {
  const Placement<Tangent> at = model.place<Tangent>(x);
  const PostureImpact<Tangent> stated = model.posture<Tangent>(at);
  VectorX<Tangent> out = VectorX<Tangent>::Zero(x.size()), row(x.size());
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    const double weight = weights[static_cast<int>(k)];
    if (weight == 0) continue;
    const auto add = [&](const PostureImpact<Tangent>& posture) {
      const auto impact = model.impact<Tangent>(at, posture, scenarios[k]);
      model.compress_into(at, jump.gradient<Tangent>(model, posture, impact, objective_unit), row);
      out += row * Tangent(weight);
    };
    if (scenarios[k].joint_offset.size() > 0) {
      add(model.posture<Tangent>(at, scenarios[k]));
    } else {
      add(stated);
    }
  }
  const ScenarioImpact<Tangent> nominal = model.impact<Tangent>(at, stated, model.nominal);
  const ConstraintPoint<Tangent> point{model, at, stated, nominal};
  for (std::size_t i = 0; i < rows.kept.size(); ++i) {
    const double multiplier = multipliers[static_cast<int>(i)];
    if (multiplier != 0) rows.kept[i]->add_gradient(point, multiplier, out);
  }
  return out;
}

void Formulation::scenario_hessian(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                                   const Eigen::VectorXd& weights,
                                   const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const {
  const Eigen::Index size = x.size();
  VectorX<Tangent> at = x.cast<Tangent>();
  out.resize(size, size);
  for (Eigen::Index first = 0; first < size; first += Tangent::kDirections) {
    const Eigen::Index directions = std::min<Eigen::Index>(Tangent::kDirections, size - first);
    for (Eigen::Index k = 0; k < directions; ++k) at[first + k].set_derivative(1, k);
    const VectorX<Tangent> gradient =
        parts_->lagrangian_gradient(at, scenarios, weights, multipliers);
    for (Eigen::Index k = 0; k < directions; ++k) {
      at[first + k].set_derivative(0, k);
      for (Eigen::Index j = 0; j < size; ++j) out(j, first + k) = gradient[j].derivative(k);
    }
  }
  out = ((out + out.transpose()) / 2).eval();  // equal but for rounding
}

void Formulation::lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                                     const Eigen::VectorXd& multipliers,
                                     Eigen::MatrixXd& out) const {
  scenario_hessian(x, {parts_->model.nominal}, Eigen::VectorXd::Constant(1, sigma), multipliers,
                   out);
}

}  // namespace stillbase
