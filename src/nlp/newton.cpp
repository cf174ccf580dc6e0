#include "nlp/newton.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::nlp {

namespace {

Eigen::VectorXd lagrangian_gradient(const Evaluation& at, const Eigen::VectorXd& multipliers) {
  return at.gradient + at.jacobian.transpose() * multipliers;
}

Eigen::MatrixXd differenced_hessian(const Problem& problem, const Eigen::VectorXd& x,
                                    const Eigen::VectorXd& multipliers, Eigen::Index curved,
                                    double h) {
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(x.size(), x.size());
  Evaluation above, below;
  for (Eigen::Index j = 0; j < curved; ++j) {
    Eigen::VectorXd a = x, b = x;
    a[j] = std::min(x[j] + h, upper[j]);
    b[j] = std::max(x[j] - h, lower[j]);
    if (!(a[j] > b[j])) continue;
    problem.evaluate(a, above);
    problem.evaluate(b, below);
    H.col(j) = (lagrangian_gradient(above, multipliers) - lagrangian_gradient(below, multipliers)) /
               (a[j] - b[j]);
  }
  return (H + H.transpose()) / 2;
}

// Gradients of what is active with a multiplier, row by row, and its distance from the bound.
struct ActiveSet {
  Eigen::MatrixXd A;
  Eigen::VectorXd c;
};

ActiveSet active_set(const Problem& problem, const Eigen::VectorXd& x, const Evaluation& at,
                     const Certificate& kkt) {
  const Eigen::VectorXd g_lower = problem.constraint_lower(), g_upper = problem.constraint_upper();
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> distances;
  const auto add = [&](double value, double below, double above, double multiplier,
                       const auto& row) {
    if (below != above && multiplier == 0) return;
    rows.push_back(row);
    distances.push_back(value - (multiplier > 0 ? above : below));
  };
  for (Eigen::Index i = 0; i < g_lower.size(); ++i) {
    add(at.constraints[i], g_lower[i], g_upper[i], kkt.multipliers[i], at.jacobian.row(i));
  }
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    add(x[j], lower[j], upper[j], kkt.bound_multipliers[j], Eigen::VectorXd::Unit(x.size(), j));
  }
  ActiveSet out{Eigen::MatrixXd(static_cast<Eigen::Index>(rows.size()), x.size()),
                Eigen::VectorXd(static_cast<Eigen::Index>(rows.size()))};
  for (Eigen::Index i = 0; i < out.c.size(); ++i) {
    out.A.row(i) = rows[static_cast<std::size_t>(i)].transpose();
    out.c[i] = distances[static_cast<std::size_t>(i)];
  }
  return out;
}

std::optional<Eigen::VectorXd> newton_step(const Problem& problem, const Eigen::VectorXd& x,
                                           const Evaluation& at, const Certificate& kkt,
                                           Eigen::Index curved, const NewtonOptions& options) {
  Eigen::MatrixXd H;
  if (problem.has_hessian()) {
    problem.lagrangian_hessian(x, 1, kkt.multipliers, H);
  } else {
    H = differenced_hessian(problem, x, kkt.multipliers, curved, options.difference);
  }
  if (!H.allFinite()) return std::nullopt;
  const ActiveSet active = active_set(problem, x, at, kkt);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(x.size(), x.size());
  if (active.c.size() > 0) {
    step = -least_norm_solution(active.A, active.c, options.flat);
    Z = PivotedQr(active.A.transpose()).complement();
  }
  if (Z.cols() > 0) {
    const SymmetricEigen curvature = symmetric_eigen(Z.transpose() * H * Z);
    const double flat = options.flat * curvature.values.cwiseAbs().maxCoeff();
    if (curvature.values[0] < -flat) return std::nullopt;
    const Eigen::VectorXd slope =
        Z.transpose() * (lagrangian_gradient(at, kkt.multipliers) + H * step);
    for (Eigen::Index k = 0; k < Z.cols(); ++k) {
      if (!(curvature.values[k] > flat)) continue;
      const Eigen::VectorXd v = curvature.vectors.col(k);
      step -= Z * v * (v.dot(slope) / curvature.values[k]);
    }
  }
  if (!(step.norm() <= options.longest)) return std::nullopt;
  return (x + step).cwiseMax(problem.lower()).cwiseMin(problem.upper());
}

}  // namespace

Eigen::VectorXd end_by_newton(const Problem& problem, const Eigen::VectorXd& x0,
                              Eigen::Index curved, const NewtonOptions& options) {
  Eigen::VectorXd x = x0;
  Evaluation at;
  problem.evaluate(x, at);
  Certificate kkt = certify(problem, x, at);
  for (int i = 0; i < options.steps && kkt.kkt_residual > options.finished; ++i) {
    const std::optional<Eigen::VectorXd> next = newton_step(problem, x, at, kkt, curved, options);
    if (!next) break;
    Evaluation there;
    problem.evaluate(*next, there);
    const Certificate further = certify(problem, *next, there);
    if (!(further.kkt_residual < kkt.kkt_residual)) break;
    if (!(further.max_violation <= std::max(options.max_violation, kkt.max_violation))) break;
    x = *next;
    at = std::move(there);
    kkt = further;
  }
  return x;
}

}  // namespace stillbase::nlp
