#include "nlp/restoration.hpp"

#include <Eigen/Cholesky>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::nlp {

namespace {

/// The shortest d with J d = r, in the least squares where no d has that.
Eigen::VectorXd shortest_step(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
  constexpr double kIndependent = 1e-3;  // of pivots: the normal equations lose the square of it
  if (J.rows() <= J.cols()) {
    const Eigen::LLT<Eigen::MatrixXd> normal(J * J.transpose());
    const auto pivots = normal.matrixLLT().diagonal();
    if (normal.info() == Eigen::Success && pivots.minCoeff() > kIndependent * pivots.maxCoeff()) {
      return J.transpose() * normal.solve(r);
    }
  }
  return least_norm_solution(J, r, 1e-9);
}

}  // namespace

Eigen::VectorXd step_within_box(Eigen::MatrixXd J, const Eigen::VectorXd& r,
                                const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper) {
  Eigen::VectorXd step;
  for (Eigen::Index pass = 0; pass <= x.size(); ++pass) {
    step = -shortest_step(J, r);
    bool held_one = false;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const bool leaves =
          (x[j] <= lower[j] && step[j] < 0.0) || (x[j] >= upper[j] && step[j] > 0.0);
      if (leaves && !J.col(j).isZero(0.0)) {
        J.col(j).setZero();
        held_one = true;
      }
    }
    if (!held_one) break;
  }
  return step;
}

double restore(Monitor& monitor, const Eigen::VectorXd& g_lower, const Eigen::VectorXd& g_upper,
               double tolerance, int max_steps, Eigen::VectorXd& x, Evaluation& at_x) {
  if (at_x.constraints.size() == 0) return 0.0;
  Eigen::VectorXd violation = signed_violation(at_x.constraints, g_lower, g_upper);
  for (int step = 0; step < max_steps && violation.lpNorm<Eigen::Infinity>() > tolerance; ++step) {
    Eigen::MatrixXd J = at_x.jacobian;
    for (Eigen::Index i = 0; i < violation.size(); ++i) {
      if (violation[i] == 0.0) J.row(i).setZero();
    }
    const Eigen::VectorXd move =
        step_within_box(std::move(J), violation, x, monitor.lower(), monitor.upper());
    if (!(move.norm() > 0.0) || !move.allFinite()) break;
    bool fell = false;
    double alpha = 1.0;
    for (int halving = 0; halving < 10 && !fell && !monitor.stopped(); ++halving, alpha /= 2.0) {
      const Eigen::VectorXd trial =
          (x + alpha * move).cwiseMax(monitor.lower()).cwiseMin(monitor.upper());
      const Evaluation* e = monitor.evaluate(trial.data());
      if (e == nullptr) continue;
      const Eigen::VectorXd left = signed_violation(e->constraints, g_lower, g_upper);
      fell = left.squaredNorm() < violation.squaredNorm();
      if (!fell) continue;
      x = trial;
      at_x = *e;
      violation = left;
    }
    if (!fell) break;
  }
  return violation.lpNorm<Eigen::Infinity>();
}

}  // namespace stillbase::nlp
