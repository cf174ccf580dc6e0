// What equations say about a function that is bounded on their solutions.
#pragma once

#include <algorithm>
#include <vector>

#include "proof/dense.hpp"
#include "proof/form_bounds.hpp"

namespace stillbase::proof {

/// The equations, and what each two of them say without one of the variables.
template <int N>
std::vector<Quadratic<N>> with_eliminations(std::vector<Quadratic<N>> equations) {
  const std::size_t count = equations.size();
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t q = p + 1; q < count; ++q) {
      for (int k = 0; k < N; ++k) {
        const double s = equations[q].a(k), t = equations[p].a(k);
        const double size = std::fmax(std::fabs(s), std::fabs(t));
        if (!(size > 0) || s == 0 || t == 0) continue;
        equations.push_back(equations[p] * Quadratic<N>(s / size) -
                            equations[q] * Quadratic<N>(t / size));
      }
    }
  }
  return equations;
}

/// f + sum lambda_j g_j + mu sum g_j^2 with the least slopes over the part (least squares), and
/// convex where the equations leave it so: what the g_j forbid costs nothing.
template <int N>
class Multipliers {
 public:
  Multipliers(const std::vector<Quadratic<N>>& equations, const Part<N>& part) : part_(part) {
    for (const Quadratic<N>& g : equations) {
      if (!g.is_bounded() || g.size_of(1) == 0 || rows_.size() == static_cast<std::size_t>(N)) {
        continue;
      }
      rows_.push_back(g);
    }
    if (rows_.empty()) return;
    const auto m = static_cast<Eigen::Index>(rows_.size());
    J_.resize(m, N);
    for (Eigen::Index j = 0; j < m; ++j) J_.row(j) = slopes(rows_[static_cast<std::size_t>(j)]);
    normal_ = J_ * J_.transpose();
    // dependent rows are harmless
    normal_.diagonal().array() += 1e-13 * normal_.trace() + 1e-300;
    // J's rows as if they were orthonormal: the squares then bend all forbidden directions alike.
    const Eigen::MatrixXd whitening = inverse_cholesky_factor(normal_);
    if (whitening.size() == 0) return;
    for (Eigen::Index i = 0; i < m; ++i) {
      Quadratic<N> row;
      for (Eigen::Index j = 0; j <= i; ++j) {
        row += rows_[static_cast<std::size_t>(j)] * Quadratic<N>(whitening(i, j));
      }
      penalty_ += row.squared();
    }
  }

  Quadratic<N> relieved(const Quadratic<N>& f) const {
    if (rows_.empty() || !f.is_bounded()) return f;
    const Eigen::VectorXd lambda = solve_symmetric(normal_, -(J_ * slopes(f).transpose()));
    if (!lambda.allFinite()) return f;
    Quadratic<N> out = f;
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      out += rows_[j] * Quadratic<N>(lambda[static_cast<Eigen::Index>(j)]);
    }
    const Quadratic<N> bent = out + penalty_ * Quadratic<N>(2 * out.size_of(2));
    const double before = least(f, part_), linear = least(out, part_), convex = least(bent, part_);
    if (convex > linear && convex > before) return bent;
    return linear > before ? out : f;
  }

 private:
  Eigen::Matrix<double, 1, N> slopes(const Quadratic<N>& form) const {
    Eigen::Matrix<double, 1, N> out;
    for (int i = 0; i < N; ++i) {
      double slope = form.a(i);
      for (int j = 0; j < N; ++j) {
        const double bend = form.q(std::min(i, j), std::max(i, j));
        slope += (i == j ? 2 : 1) * bend * middle(part_[j]);
      }
      out[i] = slope * width_of(part_[i]) / 2;
    }
    return out;
  }

  Part<N> part_;
  std::vector<Quadratic<N>> rows_;
  Quadratic<N> penalty_;
  Eigen::Matrix<double, Eigen::Dynamic, N> J_;
  Eigen::MatrixXd normal_;  ///< J J'
};

}  // namespace stillbase::proof
