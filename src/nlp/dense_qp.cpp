#include "nlp/dense_qp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/core/constants.hpp>

namespace stillbase::nlp {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Rotates the columns i and j of M by (cosine, sine), the second one's sign such that the product
/// of both rotations is a reflection: M(:, i) = c M_i + s M_j.
template <class First, class Second>
void rotate(First&& first, Second&& second, double cosine, double sine) {
  const double part = sine / (1 + cosine);
  for (Eigen::Index k = 0; k < first.size(); ++k) {
    const double a = first[k], b = second[k];
    first[k] = a * cosine + b * sine;
    second[k] = part * (a + first[k]) - b;
  }
}

/// Cosine and sine of the rotation that moves all of (a, b) to its first entry, the cosine not
/// negative. @return that entry; 0: nothing to rotate
double rotation_of(double a, double b, double& cosine, double& sine) {
  const double length = std::sqrt(a * a + b * b);  // numbers of order one
  if (length == 0) return 0;
  cosine = a / length;
  sine = b / length;
  if (cosine >= 0) return length;
  cosine = -cosine;
  sine = -sine;
  return -length;
}

}  // namespace

DenseQp::DenseQp(int most_variables, int most_rows)
    : H_(Eigen::MatrixXd::Identity(most_variables, most_variables)),
      normals_(Eigen::MatrixXd::Zero(most_variables, most_rows)),
      rows_of_normals_(most_rows, most_variables),
      g_(Eigen::VectorXd::Zero(most_variables)),
      b_(most_rows),
      slacks_(most_rows),
      d_(most_variables),
      multipliers_(most_rows),
      J_(most_variables, most_variables),
      R_(most_variables, most_variables),
      projected_(most_variables),
      step_(most_variables),
      dual_step_(most_variables),
      u_(most_variables + 1),
      active_(static_cast<std::size_t>(most_variables) + 1),
      is_active_(static_cast<std::size_t>(most_rows)) {}

void DenseQp::begin(int variables) {
  n_ = variables;
  rows_ = equations_ = 0;
}

Eigen::Ref<Eigen::VectorXd> DenseQp::add_row(double b, bool is_equation) {
  const int row = rows_++;
  b_[row] = b;
  if (is_equation) equations_ = rows_;
  return normals_.col(row).head(n_);
}

bool DenseQp::factorise() {
  // H = L L', kept in R for the moment; J = L'^-1. By columns.
  for (int j = 0; j < n_; ++j) {
    const int below = n_ - j;
    auto column = R_.col(j).segment(j, below);
    column = H_.col(j).segment(j, below);
    for (int k = 0; k < j; ++k) column -= R_(j, k) * R_.col(k).segment(j, below);
    const double pivot = column[0];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    column /= std::sqrt(pivot);
  }
  J_.topLeftCorner(n_, n_).setZero();
  for (int j = 0; j < n_; ++j) {  // column j solves L' J_j = e_j
    J_(j, j) = 1 / R_(j, j);
    for (int i = j - 1; i >= 0; --i) {
      const double sum = R_.col(i).segment(i + 1, j - i).dot(J_.col(j).segment(i + 1, j - i));
      J_(i, j) = -sum / R_(i, i);
    }
  }
  R_.topLeftCorner(n_, n_).setZero();
  return true;
}

void DenseQp::find_step(int row) {
  for (int j = 0; j < n_; ++j) projected_[j] = J_.col(j).head(n_).dot(normal(row));
  step_.head(n_).setZero();
  for (int j = size_; j < n_; ++j) step_.head(n_) += projected_[j] * J_.col(j).head(n_);
  for (int i = size_ - 1; i >= 0; --i) {
    double sum = projected_[i];
    for (int j = i + 1; j < size_; ++j) sum -= R_(i, j) * dual_step_[j];
    dual_step_[i] = sum / R_(i, i);
  }
}

bool DenseQp::add_to_active(int row) {
  for (int j = n_ - 1; j > size_; --j) {
    double cosine = 1, sine = 0;
    const double length = rotation_of(projected_[j - 1], projected_[j], cosine, sine);
    if (length == 0) continue;
    projected_[j] = 0;
    projected_[j - 1] = length;
    rotate(J_.col(j - 1).head(n_), J_.col(j).head(n_), cosine, sine);
  }
  if (std::abs(projected_[size_]) <= kEpsilon * largest_pivot_) return false;
  largest_pivot_ = std::max(largest_pivot_, std::abs(projected_[size_]));
  R_.col(size_).head(size_ + 1) = projected_.head(size_ + 1);
  active_[static_cast<std::size_t>(size_)] = row;
  is_active_[static_cast<std::size_t>(row)] = 1;
  ++size_;
  return true;
}

void DenseQp::drop_from_active(int place) {
  is_active_[static_cast<std::size_t>(active_[static_cast<std::size_t>(place)])] = 0;
  for (int i = place; i + 1 < size_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    active_[k] = active_[k + 1];
    R_.col(i).head(size_) = R_.col(i + 1).head(size_);
  }
  for (int i = place; i < size_; ++i) u_[i] = u_[i + 1];  // that of the entering row is behind them
  --size_;
  R_.col(size_).head(n_).setZero();
  for (int j = place; j < size_; ++j) {
    double cosine = 1, sine = 0;
    const double length = rotation_of(R_(j, j), R_(j + 1, j), cosine, sine);
    if (length == 0) continue;
    R_(j + 1, j) = 0;
    R_(j, j) = length;
    rotate(R_.row(j).segment(j + 1, size_ - j - 1), R_.row(j + 1).segment(j + 1, size_ - j - 1),
           cosine, sine);
    rotate(J_.col(j).head(n_), J_.col(j + 1).head(n_), cosine, sine);
  }
}

DenseQp::Outcome DenseQp::solve() {
  constexpr double kSatisfied = 1e-13;  // of numbers of order one
  if (!factorise() || !g_.head(n_).allFinite() || !b_.head(rows_).allFinite() ||
      !normals_.topLeftCorner(n_, rows_).allFinite()) {
    return Outcome::NotConvex;
  }
  size_ = 0;
  largest_pivot_ = 1;
  std::fill_n(is_active_.begin(), rows_, char(0));
  d_.head(n_).setZero();
  for (int j = 0; j < n_; ++j) {
    d_.head(n_) -= J_.col(j).head(n_).dot(g_.head(n_)) * J_.col(j).head(n_);
  }
  for (int row = 0; row < rows_; ++row) rows_of_normals_.row(row).head(n_) = normal(row);
  const auto slack = [this](int row) { return normal(row).dot(solution()) - b_[row]; };
  const auto tolerance = [this, &kSatisfied](int row) {
    return kSatisfied * (1 + std::abs(b_[row]));
  };

  for (int row = 0; row < equations_; ++row) {
    find_step(row);
    const double curvature = step_.head(n_).dot(normal(row));
    if (curvature <= kEpsilon * normal(row).squaredNorm()) {  // depends on those before
      if (std::abs(slack(row)) > 1e-9) return Outcome::Inconsistent;
      continue;
    }
    const double length = -slack(row) / curvature;
    d_.head(n_) += length * step_.head(n_);
    for (int i = 0; i < size_; ++i) u_[i] -= length * dual_step_[i];
    u_[size_] = length;
    if (!add_to_active(row)) return Outcome::Inconsistent;
  }
  const int kept = size_;

  // Each pass raises the dual objective, so no active set repeats; the bound is for rounding.
  const int most = 10 * (n_ + rows_) + 50;
  int entering = -1;
  for (int pass = 0; pass < most; ++pass) {
    if (entering < 0) {
      double worst = 0;
      slacks_.head(rows_) = -b_.head(rows_);
      for (int j = 0; j < n_; ++j) {
        slacks_.head(rows_) += d_[j] * rows_of_normals_.col(j).head(rows_);
      }
      for (int row = equations_; row < rows_; ++row) {
        if (is_active_[static_cast<std::size_t>(row)] != 0) continue;
        const double excess = -slacks_[row] - tolerance(row);
        if (excess > worst) {
          worst = excess;
          entering = row;
        }
      }
      if (entering < 0) {
        multipliers_.head(rows_).setZero();
        for (int i = 0; i < size_; ++i) multipliers_[active_[static_cast<std::size_t>(i)]] = u_[i];
        return Outcome::Solved;
      }
      u_[size_] = 0;
    }
    find_step(entering);
    double dual_limit = kInfinity;
    int leaving = -1;
    for (int i = kept; i < size_; ++i) {
      if (dual_step_[i] > 0 && u_[i] / dual_step_[i] < dual_limit) {
        dual_limit = u_[i] / dual_step_[i];
        leaving = i;
      }
    }
    const double curvature = step_.head(n_).dot(normal(entering));
    const bool can_move = size_ < n_ && curvature > kEpsilon * normal(entering).squaredNorm();
    const double primal_limit = can_move ? std::max(0.0, -slack(entering)) / curvature : kInfinity;
    const double length = std::min(dual_limit, primal_limit);
    if (!(length < kInfinity)) return Outcome::Inconsistent;
    if (can_move) d_.head(n_) += length * step_.head(n_);
    for (int i = 0; i < size_; ++i) u_[i] -= length * dual_step_[i];
    u_[size_] += length;
    if (length == primal_limit) {
      if (!add_to_active(entering)) return Outcome::Inconsistent;
      entering = -1;
    } else {
      drop_from_active(leaving);
    }
  }
  return Outcome::Inconsistent;
}

}  // namespace stillbase::nlp
