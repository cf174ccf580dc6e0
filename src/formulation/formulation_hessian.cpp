// Exact second derivatives: the kernel's own gradient, differentiated forwards along each variable.
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "formulation/constraints/rows_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/jump_kernel.hpp"

namespace stillbase {

void Formulation::scenario_hessian(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                                   const Eigen::VectorXd& weights,
                                   const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const {
  const Eigen::Index size = x.size();
  VectorX<Tangent> at = x.cast<Tangent>();
  out.resize(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    at[i].d = 1;
    const VectorX<Tangent> gradient =
        parts_->lagrangian_gradient<Tangent>(at, scenarios, weights, multipliers);
    at[i].d = 0;
    for (Eigen::Index j = 0; j < size; ++j) out(j, i) = gradient[j].d;
  }
  out = ((out + out.transpose()) / 2).eval();  // equal but for rounding
}

void Formulation::lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                                     const Eigen::VectorXd& multipliers,
                                     Eigen::MatrixXd& out) const {
  scenario_hessian(x, {parts_->predicted()}, Eigen::VectorXd::Constant(1, sigma), multipliers, out);
}

}  // namespace stillbase
