#include "nlp/restoration.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

#include <stillbase/core/in_place.hpp>

namespace stillbase::nlp {

namespace {

constexpr int kUsual = 24;  // variables and rows that need no heap
using Usual =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kUsual, kUsual>;

/// x of least |A x - b|; the columns of A are independent.
template <class Matrix>
Eigen::VectorXd solve_rectangular(const Matrix& A, const Eigen::VectorXd& b) {
  return Eigen::HouseholderQR<Matrix>(A).solve(b);
}

}  // namespace

// J = L Q' by making its rows orthogonal one after the other, the one with the largest remainder
// first. Plain loops: the matrices are small, and a search asks for thousands of steps.
Eigen::VectorXd shortest_step(const Eigen::MatrixXd& J, Eigen::VectorXd r) {
  constexpr double kDependent = 1e-9;  // remainder of a row over the longest row
  const Eigen::Index m = J.rows(), n = J.cols(), most = std::min(m, n);
  InPlaceMatrix<double, kUsual> rows(J.transpose());  // in columns: of Q, then what is left
  InPlaceMatrix<double, kUsual> L(Eigen::MatrixXd::Zero(m, most));
  const auto dot = [n](const double* a, const double* b) {
    double sum = 0;
    for (Eigen::Index k = 0; k < n; ++k) sum += a[k] * b[k];
    return sum;
  };
  const auto column = [&rows, n](Eigen::Index i) { return rows.data() + i * n; };
  InPlaceArray<double, kUsual> squares;  // of what is left
  squares.resize(static_cast<std::size_t>(m));
  double* const left = squares.data();
  for (Eigen::Index i = 0; i < m; ++i) left[i] = dot(column(i), column(i));
  double longest = 0;
  Eigen::Index rank = 0;
  for (; rank < most; ++rank) {
    const Eigen::Index next = std::max_element(left + rank, left + m) - left;
    if (next != rank) {
      std::swap_ranges(column(rank), column(rank) + n, column(next));
      for (Eigen::Index k = 0; k < rank; ++k) std::swap(L(rank, k), L(next, k));
      std::swap(left[rank], left[next]);
      std::swap(r[rank], r[next]);
    }
    double* const row = column(rank);
    const double length = std::sqrt(left[rank]);
    longest = std::max(longest, length);
    if (!(length > kDependent * longest)) break;
    for (Eigen::Index k = 0; k < n; ++k) row[k] /= length;
    L(rank, rank) = length;
    for (Eigen::Index i = rank + 1; i < m; ++i) {
      double* const other = column(i);
      const double along = dot(row, other);
      L(i, rank) = along;
      for (Eigen::Index k = 0; k < n; ++k) other[k] -= along * row[k];
      left[i] = dot(other, other);
    }
  }
  Eigen::VectorXd y = std::move(r);
  if (rank == m) {
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index k = 0; k < i; ++k) y[i] -= L(i, k) * y[k];
      y[i] /= L(i, i);
    }
  } else {
    const auto reached = L.leftCols(rank);
    y = m <= kUsual ? solve_rectangular(Usual(reached), y)
                    : solve_rectangular(Eigen::MatrixXd(reached), y);
  }
  // Q y, but for what rounding leaves of Q'Q (Bjorck, Numerical Methods for Least Squares Problems,
  // 1996, section 2.4.4).
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = rank - 1; i >= 0; --i) {
    const double part = y[i] - dot(column(i), d.data());
    for (Eigen::Index k = 0; k < n; ++k) d[k] += part * column(i)[k];
  }
  return d;
}

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
