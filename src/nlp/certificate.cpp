#include <stillbase/nlp/certificate.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::nlp {

Eigen::VectorXd solve_nonnegative_least_squares(const Eigen::MatrixXd& A,
                                                const Eigen::VectorXd& b) {
  const Eigen::Index k = A.cols();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(k);
  std::vector<Eigen::Index> passive;  // indices of the unknowns that may be positive
  std::vector<bool> banned(static_cast<std::size_t>(k), false);
  const double epsilon = 1e-13 * b.norm();

  // Least squares over the passive unknowns, the others zero.
  const auto solve_passive = [&] { return PivotedQr(A(Eigen::all, passive)).solve(b); };

  // Each pass lowers the residual, so no passive set repeats; the bound is for rounding.
  for (Eigen::Index pass = 0; pass < 3 * k + 10; ++pass) {
    const Eigen::VectorXd slope = A.transpose() * (b - A * y);
    Eigen::Index entering = -1;
    double steepest = 0.0;
    for (Eigen::Index j = 0; j < k; ++j) {
      const bool is_passive = std::find(passive.begin(), passive.end(), j) != passive.end();
      const double relative = slope[j] / std::max(A.col(j).norm(), 1e-300);
      if (!is_passive && !banned[j] && relative > std::max(epsilon, steepest)) {
        entering = j;
        steepest = relative;
      }
    }
    if (entering < 0) break;
    passive.push_back(entering);

    Eigen::VectorXd trial = solve_passive();
    if (trial[static_cast<Eigen::Index>(passive.size()) - 1] <= 0.0) {
      // Its slope was rounding noise (a column dependent on the passive ones).
      passive.pop_back();
      banned[entering] = true;
      continue;
    }
    std::fill(banned.begin(), banned.end(), false);
    while (!passive.empty() && trial.minCoeff() <= 0.0) {
      double alpha = 1.0;
      for (std::size_t p = 0; p < passive.size(); ++p) {
        const double t = trial[static_cast<Eigen::Index>(p)], old = y[passive[p]];
        if (t <= 0.0) alpha = std::min(alpha, old / (old - t));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t p = 0; p < passive.size(); ++p) {
        double& value = y[passive[p]];
        const double t = trial[static_cast<Eigen::Index>(p)];
        const bool leaves = t <= 0.0 && value / (value - t) <= alpha;
        value = leaves ? 0.0 : value + alpha * (t - value);
        if (!leaves) kept.push_back(passive[p]);
      }
      passive = std::move(kept);
      if (!passive.empty()) trial = solve_passive();
    }
    y.setZero();
    for (std::size_t p = 0; p < passive.size(); ++p) {
      y[passive[p]] = trial[static_cast<Eigen::Index>(p)];
    }
  }
  return y;
}

namespace {

// One sign-constrained multiplier: that of the upper bound (sign +1) or the lower one (sign -1) of
// a constraint or of a variable.
struct ActiveBound {
  Eigen::Index index;
  double sign;
  double distance;
};

void find_active(const Eigen::VectorXd& value, const Eigen::VectorXd& lower,
                 const Eigen::VectorXd& upper, double tolerance,
                 std::vector<Eigen::Index>& equations, std::vector<ActiveBound>& active) {
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if (lower[i] == upper[i]) {
      equations.push_back(i);
      continue;
    }
    if (value[i] >= upper[i] - tolerance) active.push_back({i, 1.0, std::abs(upper[i] - value[i])});
    if (value[i] <= lower[i] + tolerance)
      active.push_back({i, -1.0, std::abs(value[i] - lower[i])});
  }
}

double relative_violation_slope(const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper, const Eigen::VectorXd& violation,
                                const Eigen::MatrixXd& jacobian, double tolerance) {
  if (violation.size() == 0 || violation.isZero(0.0)) return 0.0;
  Eigen::VectorXd slope = jacobian.transpose() * violation;
  double jacobian_squared = 0.0;
  for (Eigen::Index i = 0; i < violation.size(); ++i) {
    if (violation[i] != 0.0) jacobian_squared += jacobian.row(i).squaredNorm();
  }
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    // A descent step would leave the box.
    if ((x[j] <= lower[j] + tolerance && slope[j] > 0.0) ||
        (x[j] >= upper[j] - tolerance && slope[j] < 0.0)) {
      slope[j] = 0.0;
    }
  }
  return jacobian_squared > 0.0 ? slope.norm() / (violation.norm() * std::sqrt(jacobian_squared))
                                : 0.0;
}

// Of the gradients A of active bounds the parts P that the equations leave open, with zero for
// those that are rounding alone: a large enough multiple of rounding balances any gradient.
// Constraints are of order one.
Eigen::MatrixXd without_rounding(Eigen::MatrixXd P, const Eigen::MatrixXd& A) {
  constexpr double kRounding = 1e-12;
  for (Eigen::Index c = 0; c < P.cols(); ++c) {
    if (P.col(c).norm() <= kRounding * std::max(1.0, A.col(c).norm())) P.col(c).setZero();
  }
  return P;
}

// `normals` (N x k): gradients of everything active.
std::optional<double> reduced_hessian_min_eigenvalue(const Problem& problem,
                                                     const Eigen::VectorXd& x,
                                                     const Eigen::VectorXd& multipliers,
                                                     const Eigen::MatrixXd& normals) {
  const Eigen::Index n = x.size();
  if (!problem.has_hessian()) return std::nullopt;
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n);
  if (normals.cols() > 0) Z = PivotedQr(normals).complement();
  if (Z.cols() == 0) return std::nullopt;
  Eigen::MatrixXd H;
  problem.lagrangian_hessian(x, 1.0, multipliers, H);
  if (!H.allFinite()) return std::nullopt;
  return symmetric_eigenvalues(Z.transpose() * H * Z)[0];
}

}  // namespace

Certificate certify(const Problem& problem, const Eigen::VectorXd& x, const Evaluation& at_x,
                    const CertificateOptions& options) {
  const Eigen::Index n = problem.num_variables(), m = problem.num_constraints();
  Certificate result;
  result.multipliers.setZero(m);
  result.bound_multipliers.setZero(n);
  if (!x.allFinite() || !std::isfinite(at_x.objective) || !at_x.constraints.allFinite()) {
    result.violation_slope = kInfinity;
    return result;
  }
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  const Eigen::VectorXd g_lower = problem.constraint_lower(), g_upper = problem.constraint_upper();
  const Eigen::VectorXd violation = signed_violation(at_x.constraints, g_lower, g_upper);
  result.max_violation = std::max(m > 0 ? violation.lpNorm<Eigen::Infinity>() : 0.0,
                                  signed_violation(x, lower, upper).lpNorm<Eigen::Infinity>());
  if (at_x.gradient.size() != n || !are_finite(at_x.gradient) || at_x.jacobian.rows() != m ||
      !are_finite(at_x.jacobian)) {
    result.violation_slope = kInfinity;
    return result;
  }
  result.violation_slope = relative_violation_slope(x, lower, upper, violation, at_x.jacobian,
                                                    options.activity_tolerance);

  std::vector<Eigen::Index> equations, fixed;
  std::vector<ActiveBound> active, active_bounds;
  find_active(at_x.constraints, g_lower, g_upper, options.activity_tolerance, equations, active);
  find_active(x, lower, upper, options.activity_tolerance, fixed, active_bounds);

  // Columns: gradients of the equations (free multipliers) and, signed, of the active bounds.
  const Eigen::Index num_equations = static_cast<Eigen::Index>(equations.size());
  const Eigen::Index num_free = num_equations + static_cast<Eigen::Index>(fixed.size());
  const Eigen::Index num_active = static_cast<Eigen::Index>(active.size());
  const Eigen::Index num_signed = num_active + static_cast<Eigen::Index>(active_bounds.size());
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(n, num_free);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, num_signed);
  for (Eigen::Index c = 0; c < num_equations; ++c) {
    E.col(c) = at_x.jacobian.row(equations[c]).transpose();
  }
  for (Eigen::Index c = num_equations; c < num_free; ++c) E(fixed[c - num_equations], c) = 1.0;
  for (Eigen::Index c = 0; c < num_active; ++c) {
    A.col(c) = active[c].sign * at_x.jacobian.row(active[c].index).transpose();
  }
  for (Eigen::Index c = num_active; c < num_signed; ++c) {
    A(active_bounds[c - num_active].index, c) = active_bounds[c - num_active].sign;
  }

  // The equations are projected out, the signed multipliers solved in what is left, and those of
  // the equations follow.
  Eigen::VectorXd residual = at_x.gradient;
  Eigen::VectorXd signed_multipliers = Eigen::VectorXd::Zero(num_signed);
  Eigen::VectorXd free_multipliers = Eigen::VectorXd::Zero(num_free);
  if (num_free > 0) {
    const PivotedQr qr(E);
    if (num_signed > 0 && qr.rank() < n) {
      signed_multipliers =
          solve_nonnegative_least_squares(without_rounding(qr.complement_components(A), A),
                                          -qr.complement_components(at_x.gradient));
    }
    residual += A * signed_multipliers;
    free_multipliers = qr.solve(-residual);
    residual += E * free_multipliers;
  } else if (num_signed > 0) {
    signed_multipliers = solve_nonnegative_least_squares(without_rounding(A, A), -at_x.gradient);
    residual += A * signed_multipliers;
  }

  const double scale = std::max(problem.objective_scale(), at_x.gradient.lpNorm<Eigen::Infinity>());
  result.kkt_residual = residual.lpNorm<Eigen::Infinity>() / scale;
  result.complementarity = 0.0;
  for (Eigen::Index c = 0; c < num_free; ++c) {
    (c < num_equations ? result.multipliers[equations[c]]
                       : result.bound_multipliers[fixed[c - num_equations]]) = free_multipliers[c];
  }
  for (Eigen::Index c = 0; c < num_signed; ++c) {
    const ActiveBound& bound = c < num_active ? active[c] : active_bounds[c - num_active];
    (c < num_active ? result.multipliers : result.bound_multipliers)[bound.index] +=
        bound.sign * signed_multipliers[c];
    result.complementarity =
        std::max(result.complementarity, signed_multipliers[c] * bound.distance);
  }
  if (options.second_order) {
    Eigen::MatrixXd normals(n, num_free + num_signed);
    normals << E, A;
    result.reduced_hessian_min_eigenvalue =
        reduced_hessian_min_eigenvalue(problem, x, result.multipliers, normals);
  }
  return result;
}

Certificate certify(const Problem& problem, const Eigen::VectorXd& x,
                    const CertificateOptions& options) {
  Evaluation at_x;
  problem.evaluate(x, at_x);
  return certify(problem, x, at_x, options);
}

}  // namespace stillbase::nlp
