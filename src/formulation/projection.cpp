#include "formulation/projection.hpp"

#include <algorithm>
#include <utility>

#include <stillbase/core/linear_algebra.hpp>

#include "nlp/restoration.hpp"

namespace stillbase {

void evaluate_equations(const Formulation& formulation, const Eigen::VectorXd& x, bool with_zero,
                        Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian) {
  formulation.evaluate_violated(x, true, with_zero, residual, jacobian);
}

Eigen::MatrixXd open_directions(const Formulation& formulation, const Eigen::VectorXd& x,
                                bool with_zero) {
  constexpr double kRank = 1e-9;
  constexpr double kNothing = 1e-12;  // slopes over typical sizes: only rounding is left
  Eigen::VectorXd residual;
  Eigen::MatrixXd equations;
  evaluate_equations(formulation, x, with_zero, residual, equations);
  // Square at least, so that the right singular vectors are all there.
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(std::max(equations.rows(), x.size()), x.size());
  J.topRows(equations.rows()) = equations;
  const Svd svd = right_svd(J);
  const int rank = svd.sigma[0] > kNothing ? numerical_rank(svd.sigma, kRank) : 0;
  return svd.V.rightCols(x.size() - rank);
}

Eigen::VectorXd in_shortest_turns(const Formulation& formulation, const Eigen::VectorXd& x,
                                  double other_turn) {
  const Eigen::VectorXd shortest = formulation.variables(formulation.configuration(x));
  return (shortest - x).norm() > other_turn ? shortest : x;
}

ProjectionResult project_onto_constraints(const Formulation& formulation, const Eigen::VectorXd& x0,
                                          bool zero_objective, int max_iterations,
                                          const ProjectionOptions& options) {
  const Eigen::VectorXd lower = formulation.lower();
  const Eigen::VectorXd upper = formulation.upper();
  const bool is_coarse = zero_objective && !formulation.has_hessian();
  const double exact = is_coarse ? options.exact_simulated : options.exact;
  ProjectionResult out{x0.cwiseMax(lower).cwiseMin(upper), kInfinity};
  Eigen::VectorXd r, r_trial;
  Eigen::MatrixXd J, J_trial;
  formulation.evaluate_violated(out.x, false, zero_objective, r, J);
  int slow = 0;  // steps, the last ones
  for (int iteration = 0; iteration < max_iterations && slow < options.slow_steps; ++iteration) {
    if (r.size() == 0 || r.cwiseAbs().maxCoeff() < exact) break;
    Eigen::VectorXd step = nlp::step_within_box(J, r, out.x, lower, upper);
    const double longest = step.cwiseAbs().maxCoeff();
    if (!(longest > 0)) break;
    if (longest > options.longest_step) step *= options.longest_step / longest;
    const double before = r.squaredNorm();
    double alpha = 1;
    bool accepted = false;
    for (int halving = 0; halving < options.halvings; ++halving, alpha /= 2) {
      const Eigen::VectorXd trial = (out.x + alpha * step).cwiseMax(lower).cwiseMin(upper);
      formulation.evaluate_violated(trial, false, zero_objective, r_trial, J_trial);
      if (r_trial.squaredNorm() < before) {
        out.x = trial;
        std::swap(r, r_trial);
        std::swap(J, J_trial);
        accepted = true;
        break;
      }
    }
    if (!accepted) break;
    slow = r.squaredNorm() > (1 - options.least_fall) * before ? slow + 1 : 0;
  }
  out.violation = r.size() == 0 ? 0 : r.cwiseAbs().maxCoeff();
  out.x = formulation.within_limits(out.x);
  return out;
}

}  // namespace stillbase
