// Elimination in a positive definite matrix over a whole box at once, for dual intervals and
// Taylor models.
//
// The entries of such a matrix cancel; so it is first taken to near the identity by the inverse G
// of the Cholesky factor of its middle, and then factorised once,
//   G K G' = C D C',  C unit lower triangular, G any regular matrix of doubles.
// With z(b) = C^-1 G b then a' K^-1 b = sum z_i(a) z_i(b) / D_i. Where a pivot may vanish over the
// box, results are unbounded.
#pragma once

#include <array>

#include "proof/dense.hpp"
#include "proof/interval.hpp"

namespace stillbase::proof {

template <class S, int kMaxSize>
class Elimination {
 public:
  using Column = std::array<S, kMaxSize>;

  Elimination() = default;
  /// @param entry (i, j) -> S, called with j <= i < size
  template <class Entry>
  Elimination(int size, const Entry& entry) : size_(size) {
    std::array<Column, kMaxSize> K;  // lower triangle
    Eigen::MatrixXd centre(size_, size_);
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j <= i; ++j) {
        K[i][j] = entry(i, j);
        centre(i, j) = centre(j, i) = middle(K[i][j]);
      }
    }
    precondition(centre);
    for (int i = 0; i < size_; ++i) {
      Column GK;  // row i of G K
      for (int j = 0; j < size_; ++j) {
        for (int k = 0; k <= i; ++k) GK[j] += (k > j ? K[k][j] : K[j][k]) * S(G_(i, k));
      }
      for (int j = 0; j <= i; ++j) {
        S value(0.0);
        for (int k = 0; k <= j; ++k) value += GK[k] * S(G_(j, k));
        if (j < i) {
          for (int k = 0; k < j; ++k) value -= C_[i][k] * CD_[j][k];
          CD_[i][j] = value;
          C_[i][j] = quotient(value, D_[j], inverse_D_[j]);
        } else {
          for (int k = 0; k < j; ++k) value -= square(CD_[i][k]) * inverse_D_[k];
          D_[i] = value;
          inverse_D_[i] = inverse_of(D_[i]);
        }
      }
    }
  }

  int size() const { return size_; }
  const Column& inverse_pivots() const { return inverse_D_; }

  /// z(b) = C^-1 G b.
  Column forward(const Column& b) const {
    Column z{};
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k <= i; ++k) z[i] += b[k] * S(G_(i, k));
      for (int k = 0; k < i; ++k) z[i] -= C_[i][k] * z[k];
    }
    return z;
  }

  /// a' K^-1 b from z(a) and z(b).
  S product(const Column& z_a, const Column& z_b) const {
    S sum(0.0);
    for (int i = 0; i < size_; ++i) sum += z_a[i] * quotient(z_b[i], D_[i], inverse_D_[i]);
    return sum;
  }

  /// K^-1 b from z(b).
  Column backward(const Column& z) const {
    Column y{}, x{};  // y = G'^-1 x
    for (int i = size_ - 1; i >= 0; --i) {
      y[i] = quotient(z[i], D_[i], inverse_D_[i]);
      for (int k = i + 1; k < size_; ++k) y[i] -= C_[k][i] * y[k];
    }
    for (int i = 0; i < size_; ++i) {
      for (int k = i; k < size_; ++k) x[i] += y[k] * S(G_(k, i));
    }
    return x;
  }

 private:
  /// G, lower triangular with G middle G' near the identity.
  void precondition(const Eigen::MatrixXd& centre) {
    G_ = inverse_cholesky_factor(centre);
    if (G_.size() == 0 || (G_.diagonal().array() == 0).any()) G_.setIdentity(size_, size_);
  }

  int size_ = 0;
  Eigen::MatrixXd G_;
  std::array<Column, kMaxSize> C_{}, CD_{};  ///< strictly below the diagonal: C, and C D
  Column D_{}, inverse_D_{};
};

}  // namespace stillbase::proof
