#include "nlp/dense_ldl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillbase::nlp {

namespace {

using SquareMap = Eigen::Map<Eigen::MatrixXd>;

// Where blocks of one and of two are equally good: (1 + sqrt(17)) / 8.
constexpr double kAlpha = 0.6403882032022076;

/// Largest entry of a column of what is left from row k on, but for the diagonal. Of the symmetric
/// matrix the lower triangle is read.
struct ColumnMaximum {
  double value = 0;
  Eigen::Index row = 0;
};

ColumnMaximum largest_beside_diagonal(const SquareMap& A, Eigen::Index k, Eigen::Index column) {
  ColumnMaximum out{0, column};
  for (Eigen::Index j = k; j < column; ++j) {
    if (const double value = std::abs(A(column, j)); value > out.value) out = {value, j};
  }
  const Eigen::Index below = A.rows() - column - 1;
  if (below == 0) return out;
  // The value first, without its place: that takes several entries at a time.
  const double largest = A.col(column).tail(below).cwiseAbs().maxCoeff();
  if (!(largest > out.value)) return out;
  Eigen::Index row = column + 1;
  while (row + 1 < A.rows() && std::abs(A(row, column)) < largest) ++row;
  return {largest, row};
}

/// Rows of the next block, the second equal to the first for a block of one.
std::pair<Eigen::Index, Eigen::Index> choose_pivot(const SquareMap& A, Eigen::Index k) {
  Eigen::Index i = k;
  for (Eigen::Index j = k + 1; j < A.rows(); ++j) {
    if (std::abs(A(j, j)) > std::abs(A(i, i))) i = j;
  }
  ColumnMaximum here = largest_beside_diagonal(A, k, i);
  while (std::abs(A(i, i)) < kAlpha * here.value) {
    const Eigen::Index r = here.row;
    const ColumnMaximum there = largest_beside_diagonal(A, k, r);
    if (std::abs(A(r, r)) >= kAlpha * there.value) return {r, r};
    if (there.value <= here.value) return {i, r};
    i = r;
    here = there;
  }
  return {i, i};
}

/// Exchanges two rows and columns in the lower triangle, with the rows of L before them.
void exchange(DenseLdl& matrix, Eigen::Index a, Eigen::Index b) {
  if (a == b) return;
  if (a > b) std::swap(a, b);
  SquareMap& A = matrix.A;
  for (Eigen::Index j = 0; j < a; ++j) std::swap(A(a, j), A(b, j));
  for (Eigen::Index j = a + 1; j < b; ++j) std::swap(A(j, a), A(b, j));
  const Eigen::Index below = A.rows() - b - 1;
  A.col(a).tail(below).swap(A.col(b).tail(below));
  std::swap(A(a, a), A(b, b));
  std::swap(matrix.scale[a], matrix.scale[b]);
  std::swap(matrix.order[a], matrix.order[b]);
}

void equilibrate(DenseLdl& matrix) {
  SquareMap& A = matrix.A;
  matrix.scale.setOnes();
  for (int round = 0; round < 3; ++round) {
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      const double largest = A.col(j).cwiseAbs().maxCoeff();
      if (!(largest > 0)) continue;
      // The power of two next to 1 / sqrt(largest), so that scaling rounds nothing.
      const int half = (std::ilogb(largest) + 1) >> 1;
      if (half == 0) continue;
      const double factor = std::ldexp(1.0, -half);
      A.col(j) *= factor;
      A.row(j) *= factor;
      matrix.scale[j] *= factor;
    }
  }
}

}  // namespace

LdlInertia factorise(DenseLdl& matrix) {
  SquareMap& A = matrix.A;
  const Eigen::Index n = A.rows();
  LdlInertia out;
  if (!A.allFinite()) return {.is_singular = true};
  matrix.order.setLinSpaced(n, 0, static_cast<int>(n) - 1);
  equilibrate(matrix);
  const double tiny = static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  for (Eigen::Index k = 0; k < n;) {
    const auto [first, second] = choose_pivot(A, k);
    const Eigen::Index size = first == second ? 1 : 2, rest = n - k - size;
    exchange(matrix, k, first);
    if (size == 2) exchange(matrix, k + 1, second == k ? first : second);
    auto L = A.block(k + size, k, rest, size);
    auto trailing = A.bottomRightCorner(rest, rest);
    if (size == 1) {
      const double d = A(k, k);
      if (!(std::abs(d) > tiny)) return {.is_singular = true};
      out.negative += d < 0;
      const double inverse = 1 / d;
      for (Eigen::Index j = 0; j < rest; ++j) {
        if (L(j, 0) == 0) continue;
        trailing.col(j).tail(rest - j) -= L.col(0).tail(rest - j) * (L(j, 0) * inverse);
      }
      L *= inverse;
    } else {
      matrix.order.segment(k, 2) = -matrix.order.segment(k, 2).array() - 1;
      // Its diagonal is small beside its other entry: one eigenvalue of either sign.
      ++out.negative;
      const double off = A(k + 1, k);
      if (!(std::abs(off) > tiny)) return {.is_singular = true};
      const double a = A(k, k) / off, c = A(k + 1, k + 1) / off, scale = 1 / ((a * c - 1) * off);
      for (Eigen::Index j = 0; j < rest; ++j) {
        const double u = L(j, 0), v = L(j, 1);
        if (u == 0 && v == 0) continue;
        trailing.col(j).tail(rest - j) -= L.col(0).tail(rest - j) * (scale * (c * u - v)) +
                                          L.col(1).tail(rest - j) * (scale * (a * v - u));
      }
      for (Eigen::Index j = 0; j < rest; ++j) {
        const double u = L(j, 0), v = L(j, 1);
        L(j, 0) = scale * (c * u - v);
        L(j, 1) = scale * (a * v - u);
      }
    }
    k += size;
  }
  return out;
}

void solve(const DenseLdl& factors, Eigen::Ref<Eigen::VectorXd> b,
           Eigen::Ref<Eigen::VectorXd> work) {
  const SquareMap& A = factors.A;
  const Eigen::Index n = A.rows();
  const auto row_of = [&](Eigen::Index k) {
    return factors.order[k] < 0 ? -1 - factors.order[k] : factors.order[k];
  };
  const auto size_at = [&](Eigen::Index k) { return factors.order[k] < 0 ? 2 : 1; };
  for (Eigen::Index k = 0; k < n; ++k) work[k] = b[row_of(k)] * factors.scale[k];
  for (Eigen::Index k = 0; k < n; k += size_at(k)) {
    const Eigen::Index next = k + size_at(k), rest = n - next;
    for (Eigen::Index j = k; j < next; ++j) work.tail(rest) -= A.col(j).tail(rest) * work[j];
    if (next == k + 1) {
      work[k] /= A(k, k);
      continue;
    }
    const double off = A(k + 1, k), a = A(k, k) / off, c = A(k + 1, k + 1) / off;
    const double scale = 1 / ((a * c - 1) * off), u = work[k], v = work[k + 1];
    work[k] = scale * (c * u - v);
    work[k + 1] = scale * (a * v - u);
  }
  for (Eigen::Index next = n; next > 0;) {
    const Eigen::Index k = next - size_at(next - 1), rest = n - next;
    for (Eigen::Index j = k; j < next; ++j) work[j] -= A.col(j).tail(rest).dot(work.tail(rest));
    next = k;
  }
  for (Eigen::Index k = 0; k < n; ++k) b[row_of(k)] = work[k] * factors.scale[k];
}

}  // namespace stillbase::nlp
