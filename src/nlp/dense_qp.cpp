#include "nlp/dense_qp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::nlp {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr int kLanes = 4;

int down_to_lanes(int size) { return size / kLanes * kLanes; }
int up_to_lanes(int size) { return down_to_lanes(size + kLanes - 1); }

// Columns of a multiple of kLanes numbers.
using Lanes = Eigen::Array<double, kLanes, 1>;
auto lanes(const double* x) { return Eigen::Map<const Lanes>(x); }
auto lanes(double* x) { return Eigen::Map<Lanes>(x); }

double dot(const double* a, const double* b, int size) {
  Lanes sum = Lanes::Zero();
  for (int k = 0; k < size; k += kLanes) sum += lanes(a + k) * lanes(b + k);
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// b += factor a
void add(double factor, const double* a, double* b, int size) {
  for (int k = 0; k < size; k += kLanes) lanes(b + k) += factor * lanes(a + k);
}

/// sum_j factors_j M.col(j) over the columns [from, to)
void combine(const Eigen::MatrixXd& M, const double* factors, int from, int to, double* out,
             int size) {
  for (int k = 0; k < size; k += kLanes) {
    Lanes sum = Lanes::Zero();
    for (int j = from; j < to; ++j) sum += factors[j] * lanes(M.col(j).data() + k);
    lanes(out + k) = sum;
  }
}

/// Rotates a pair of vectors by (cosine, sine), the second one's sign such that it is a reflection.
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
      normals_(Eigen::MatrixXd::Zero(up_to_lanes(most_variables), most_rows)),
      bounded_(static_cast<std::size_t>(most_rows)),
      g_(Eigen::VectorXd::Zero(up_to_lanes(most_variables))),
      b_(most_rows),
      d_(g_),
      multipliers_(most_rows),
      J_(Eigen::MatrixXd::Zero(up_to_lanes(most_variables), most_variables)),
      R_(J_),
      projected_(g_),
      step_(g_),
      dual_step_(g_),
      u_(most_variables + 1),
      work_(g_),
      active_(static_cast<std::size_t>(most_variables) + 1),
      is_active_(static_cast<std::size_t>(most_rows)) {}

void DenseQp::begin(int variables) {
  n_ = variables;
  padded_ = up_to_lanes(variables);
  rows_ = equations_ = 0;
}

int DenseQp::row(double b, bool is_equation) {
  const int row = rows_++;
  b_[row] = b;
  bounded_[static_cast<std::size_t>(row)] = -1;
  std::fill_n(normals_.col(row).data() + n_, padded_ - n_, 0.0);
  if (is_equation) equations_ = rows_;
  return row;
}

Eigen::Ref<Eigen::VectorXd> DenseQp::add_row(double b, bool is_equation) {
  return normals_.col(row(b, is_equation)).head(n_);
}

void DenseQp::add_bound(int variable, double sign, double b) {
  const int bound = row(b, false);
  bounded_[static_cast<std::size_t>(bound)] = variable;
  std::fill_n(normals_.col(bound).data(), n_, 0.0);
  normals_(variable, bound) = sign;
}

double DenseQp::slack(int row) const {
  const int variable = bounded_[static_cast<std::size_t>(row)];
  const double reached = variable >= 0 ? normals_(variable, row) * d_[variable]
                                       : dot(normals_.col(row).data(), d_.data(), padded_);
  return reached - b_[row];
}

double DenseQp::squared_normal(int row) const {
  const double* n = normals_.col(row).data();
  return bounded_[static_cast<std::size_t>(row)] >= 0 ? 1 : dot(n, n, padded_);
}

bool DenseQp::factorise() {
  // H = L L' by columns, L in R for the moment. What is above the diagonal there is of no use.
  Eigen::VectorXd& inverse = projected_;  // of the pivots
  for (int j = 0; j < n_; ++j) {
    const int from = down_to_lanes(j), count = padded_ - from;
    double* column = R_.col(j).data();
    R_.col(j).head(n_) = H_.col(j).head(n_);
    R_.col(j).segment(n_, padded_ - n_).setZero();
    for (int k = 0; k < j; ++k) add(-R_(j, k), R_.col(k).data() + from, column + from, count);
    const double pivot = column[j];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    inverse[j] = 1 / std::sqrt(pivot);
    for (int k = from; k < padded_; k += kLanes) lanes(column + k) *= inverse[j];
  }
  // J = L'^-1: its row j is column j of L^-1, by substitution.
  double* sums = work_.data();
  for (int j = 0; j < n_; ++j) {
    std::fill_n(sums + down_to_lanes(j), padded_ - down_to_lanes(j), 0.0);
    for (int k = j; k < n_; ++k) {
      const double entry = (k == j ? 1 : -sums[k]) * inverse[k];
      J_(j, k) = entry;
      const int from = down_to_lanes(k + 1);
      add(entry, R_.col(k).data() + from, sums + from, padded_ - from);
    }
  }
  for (int j = 0; j < n_; ++j) {
    std::fill_n(J_.col(j).data() + j + 1, padded_ - j - 1, 0.0);
  }
  return true;
}

void DenseQp::project(int row, int from) {
  const int variable = bounded_[static_cast<std::size_t>(row)];
  const double* n = normals_.col(row).data();
  for (int j = from; j < n_; ++j) {
    projected_[j] =
        variable >= 0 ? n[variable] * J_(variable, j) : dot(J_.col(j).data(), n, padded_);
  }
  combine(J_, projected_.data(), size_, n_, step_.data(), padded_);
  curvature_ = projected_.segment(size_, n_ - size_).squaredNorm();
}

void DenseQp::find_step(int row) {
  project(row, kept_);
  // R dual_step = the first part of J' n, by columns.
  dual_step_.segment(kept_, size_ - kept_) = projected_.segment(kept_, size_ - kept_);
  for (int j = size_ - 1; j >= kept_; --j) {
    dual_step_[j] /= R_(j, j);
    for (int i = kept_; i < j; ++i) dual_step_[i] -= R_(i, j) * dual_step_[j];
  }
}

bool DenseQp::add_to_active(int row) {
  // A reflection that leaves one entry of the second part of J' n.
  const int rest = n_ - size_;
  double pivot = projected_[size_];
  if (rest > 1) {
    const double length = std::sqrt(curvature_);
    pivot = pivot > 0 ? -length : length;
    if (length > 0) {
      double* v = projected_.data();
      const double first = v[size_];
      v[size_] = first - pivot;
      const double factor = 1 / (length * (length + std::abs(first)));  // 2 / v' v
      combine(J_, v, size_, n_, work_.data(), padded_);
      for (int j = size_; j < n_; ++j) {
        add(-factor * v[j], work_.data(), J_.col(j).data(), padded_);
      }
    }
  }
  if (std::abs(pivot) <= kEpsilon * largest_pivot_) return false;
  largest_pivot_ = std::max(largest_pivot_, std::abs(pivot));
  R_.col(size_).segment(kept_, size_ - kept_) = projected_.segment(kept_, size_ - kept_);
  R_(size_, size_) = pivot;
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
  for (int j = place; j < size_; ++j) {
    double cosine = 1, sine = 0;
    const double length = rotation_of(R_(j, j), R_(j + 1, j), cosine, sine);
    if (length == 0) continue;
    R_(j, j) = length;
    rotate(R_.row(j).segment(j + 1, size_ - j - 1), R_.row(j + 1).segment(j + 1, size_ - j - 1),
           cosine, sine);
    rotate(J_.col(j).head(n_), J_.col(j + 1).head(n_), cosine, sine);
  }
}

bool DenseQp::take_equations() {
  constexpr double kSame = 1e-9;  // a row that depends on those before
  kept_ = 0;
  for (int row = 0; row < equations_; ++row) {
    project(row, 0);
    if (curvature_ <= kEpsilon * squared_normal(row)) {
      if (std::abs(slack(row)) > kSame) return false;
      continue;
    }
    add(-slack(row) / curvature_, step_.data(), d_.data(), padded_);
    if (!add_to_active(row)) return false;
  }
  kept_ = size_;
  return true;
}

void DenseQp::set_multipliers() {
  multipliers_.head(rows_).setZero();
  // Of the equations: R u = J' (H d + g - sum u_i n_i) of the others, in their rows.
  work_.head(padded_) = g_.head(padded_);
  work_.head(n_).noalias() += hessian().lazyProduct(d_.head(n_));
  for (int i = kept_; i < size_; ++i) {
    const int row = active_[static_cast<std::size_t>(i)];
    multipliers_[row] = u_[i];
    add(-u_[i], normals_.col(row).data(), work_.data(), padded_);
  }
  for (int j = kept_ - 1; j >= 0; --j) {
    double sum = dot(J_.col(j).data(), work_.data(), padded_);
    for (int i = j + 1; i < kept_; ++i) sum -= R_(j, i) * u_[i];
    u_[j] = sum / R_(j, j);
    multipliers_[active_[static_cast<std::size_t>(j)]] = u_[j];
  }
}

int DenseQp::most_violated() const {
  constexpr double kSatisfied = 1e-13;  // of numbers of order one
  double worst = 0;
  int out = -1;
  for (int row = equations_; row < rows_; ++row) {
    if (is_active_[static_cast<std::size_t>(row)] != 0) continue;
    const double excess = -slack(row) - kSatisfied * (1 + std::abs(b_[row]));
    if (excess > worst) {
      worst = excess;
      out = row;
    }
  }
  return out;
}

DenseQp::Outcome DenseQp::solve() {
  if (!factorise() || !g_.head(n_).allFinite() || !b_.head(rows_).allFinite()) {
    return Outcome::NotConvex;
  }
  for (int row = 0; row < rows_; ++row) {
    const bool is_bound = bounded_[static_cast<std::size_t>(row)] >= 0;
    if (!is_bound && !are_finite(normals_.col(row).head(padded_))) return Outcome::NotConvex;
  }
  size_ = 0;
  largest_pivot_ = 1;
  std::fill_n(is_active_.begin(), rows_, char(0));
  std::fill_n(g_.data() + n_, padded_ - n_, 0.0);
  for (int j = 0; j < n_; ++j) projected_[j] = -dot(J_.col(j).data(), g_.data(), padded_);
  combine(J_, projected_.data(), 0, n_, d_.data(), padded_);
  if (!take_equations()) return Outcome::Inconsistent;

  // Each pass raises the dual objective, so no active set repeats; the bound is for rounding.
  const int most = 10 * (n_ + rows_) + 50;
  int entering = -1;
  for (int pass = 0; pass < most; ++pass) {
    if (entering < 0) {
      entering = most_violated();
      if (entering < 0) {
        set_multipliers();
        return Outcome::Solved;
      }
      u_[size_] = 0;
    }
    find_step(entering);
    double dual_limit = kInfinity;
    int leaving = -1;
    for (int i = kept_; i < size_; ++i) {
      if (dual_step_[i] > 0 && u_[i] / dual_step_[i] < dual_limit) {
        dual_limit = u_[i] / dual_step_[i];
        leaving = i;
      }
    }
    const bool can_move = size_ < n_ && curvature_ > kEpsilon * squared_normal(entering);
    const double primal_limit = can_move ? std::max(0.0, -slack(entering)) / curvature_ : kInfinity;
    const double length = std::min(dual_limit, primal_limit);
    if (!(length < kInfinity)) return Outcome::Inconsistent;
    if (can_move) add(length, step_.data(), d_.data(), padded_);
    for (int i = kept_; i < size_; ++i) u_[i] -= length * dual_step_[i];
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
