#include "formulation/projection.hpp"

#include <algorithm>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

/// Residual of everything that is violated, with its Jacobian.
void residual(const Formulation& formulation, const Eigen::VectorXd& x, bool zero_objective,
              Eigen::VectorXd& r, Eigen::MatrixXd& J) {
  ScenarioEvaluation at_x;  // of no scenario: the objective may take a simulation
  formulation.evaluate_scenarios(x, {}, true, at_x);
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  const Eigen::VectorXd violation = nlp::signed_violation(at_x.constraints, lower, upper);
  std::vector<int> rows;
  for (int i = 0; i < violation.size(); ++i) {
    if (lower[i] == upper[i] || violation[i] != 0) rows.push_back(i);
  }
  const int m = static_cast<int>(rows.size());
  Eigen::VectorXd y;
  Eigen::MatrixXd J_y(0, x.size());
  if (zero_objective) formulation.objective_vector(x, y, J_y);
  const int extra = static_cast<int>(y.size());
  r.resize(m + extra);
  J.resize(m + extra, x.size());
  for (int i = 0; i < m; ++i) {
    r[i] = violation[rows[static_cast<std::size_t>(i)]];
    J.row(i) = at_x.jacobian.row(rows[static_cast<std::size_t>(i)]);
  }
  r.tail(extra) = y;
  J.bottomRows(extra) = J_y;
}

}  // namespace

ProjectionResult project_onto_constraints(const Formulation& formulation, const Eigen::VectorXd& x0,
                                          bool zero_objective, int max_iterations) {
  const Eigen::VectorXd lower = formulation.lower();
  const Eigen::VectorXd upper = formulation.upper();
  constexpr double kMaxStep = 0.5;  // rad: beyond it the linear model does not hold
  // Simulations have larger rounding errors and cost too much for the last digits.
  const double exact = zero_objective && !formulation.has_hessian() ? 1e-11 : 1e-14;
  ProjectionResult out{x0.cwiseMax(lower).cwiseMin(upper), kInfinity};
  Eigen::VectorXd r, r_trial;
  Eigen::MatrixXd J, J_trial;
  residual(formulation, out.x, zero_objective, r, J);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (r.size() == 0 || r.cwiseAbs().maxCoeff() < exact) break;
    // Variables that the step would push through a bound are held, then the step is computed for
    // the others.
    std::vector<bool> held(static_cast<std::size_t>(x0.size()), false);
    Eigen::VectorXd step;
    for (int pass = 0; pass <= x0.size(); ++pass) {
      Eigen::MatrixXd A = J;
      for (int i = 0; i < x0.size(); ++i) {
        if (held[static_cast<std::size_t>(i)]) A.col(i).setZero();
      }
      step = -least_norm_solution(A, r, 1e-9);
      bool changed = false;
      for (int i = 0; i < x0.size(); ++i) {
        const bool out_of_box =
            (out.x[i] <= lower[i] && step[i] < 0) || (out.x[i] >= upper[i] && step[i] > 0);
        if (out_of_box && !held[static_cast<std::size_t>(i)]) {
          held[static_cast<std::size_t>(i)] = true;
          changed = true;
        }
      }
      if (!changed) break;
    }
    const double longest = step.cwiseAbs().maxCoeff();
    if (!(longest > 0)) break;
    if (longest > kMaxStep) step *= kMaxStep / longest;
    const double before = r.squaredNorm();
    double alpha = 1;
    bool accepted = false;
    for (int halving = 0; halving < 12; ++halving, alpha /= 2) {
      const Eigen::VectorXd trial = (out.x + alpha * step).cwiseMax(lower).cwiseMin(upper);
      residual(formulation, trial, zero_objective, r_trial, J_trial);
      if (r_trial.squaredNorm() < before) {
        out.x = trial;
        r = r_trial;
        J = J_trial;
        accepted = true;
        break;
      }
    }
    if (!accepted) break;
  }
  out.violation = r.size() == 0 ? 0 : r.cwiseAbs().maxCoeff();
  return out;
}

}  // namespace stillbase
