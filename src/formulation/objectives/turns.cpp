// Terms of the objective that take a simulation, over the variables of a formulation.
#include <algorithm>

#include "formulation/formulation_kernel.hpp"

namespace stillbase {

Eigen::VectorXd Formulation::Parts::turn_vector(const Eigen::VectorXd& x,
                                                const Scenario& scenario) const {
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(turns.size()));
  if (turns.empty()) return out;
  const Local<double> local = localise<double>(x);
  const auto met = impact(local, posture(local, scenario), scenario);
  JointVectord phi = local.phi;
  if (scenario.joint_offset.size() > 0) phi += scenario.joint_offset;
  const Vector6d Delta_Omega = met.p * met.response.d.Delta_Omega;
  const JointVectord Delta_phidot = met.p * met.response.d.Delta_phidot;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    out.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        turns[i](phi, Delta_Omega, Delta_phidot, simulations_stop) / objective_unit;
  }
  return out;
}

Eigen::MatrixXd Formulation::Parts::turn_jacobian(const Eigen::VectorXd& x,
                                                  const Scenario& scenario) const {
  constexpr double kStep = 1e-5;
  const Eigen::Index height = 3 * static_cast<Eigen::Index>(turns.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(height, x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    // Beyond its bound a joint would meet its stop at once: one-sided there.
    Eigen::VectorXd a = x, b = x;
    a[i] = std::min(x[i] + kStep, std::max(x[i], layout.upper[i]));
    b[i] = std::max(x[i] - kStep, std::min(x[i], layout.lower[i]));
    if (a[i] == b[i]) continue;
    out.col(i) = (turn_vector(a, scenario) - turn_vector(b, scenario)) / (a[i] - b[i]);
  }
  return out;
}

}  // namespace stillbase
