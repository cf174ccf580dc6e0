// Bounds from a quadratic form over a part of its box: its least value, and where it is zero or at
// most a given value.
#pragma once

#include <algorithm>

#include <Eigen/Eigenvalues>

#include <stillbase/core/constants.hpp>

#include "proof/enclose.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {

/// The part of a box that is still of interest, in eps.
template <int N>
using Part = Box<N>;

/// All values over a part of all terms but a_i eps_i.
template <int N>
Interval without(const Quadratic<N>& form, const Part<N>& part, int i) {
  Interval sum = Interval(form.c()) + Interval(-form.r, form.r);
  for (int k = 0; k < N; ++k) {
    if (k != i) sum += Interval(form.a(k)) * part[k];
    sum += Interval(form.q(k, k)) * boost::numeric::square(part[k]);
    for (int j = k + 1; j < N; ++j) {
      sum += Interval(form.q(k, j)) * (part[k] * part[j]);
    }
  }
  return sum;
}

/// Cuts off where the form cannot be zero; false: nothing is left.
template <int N>
bool cut_by_equation(const Quadratic<N>& form, Part<N>& part) {
  if (!form.is_bounded()) return true;
  if (!contains_zero(without(form, part, N))) return false;
  for (int i = 0; i < N; ++i) {
    if (form.a(i) == 0) continue;
    const Interval solved = -without(form, part, i) / Interval(form.a(i));
    if (is_disjoint(solved, part[i])) return false;
    part[i] = boost::numeric::intersect(part[i], solved);
  }
  return true;
}

/// Cuts off where the form is positive; false: nothing is left.
template <int N>
bool cut_above_zero(const Quadratic<N>& form, Part<N>& part) {
  if (!form.is_bounded()) return true;
  if (without(form, part, N).lower() > 0) return false;
  for (int i = 0; i < N; ++i) {
    if (form.a(i) == 0) continue;
    // a eps <= minus the least of the other terms.
    const double left = -without(form, part, i).lower();
    const Interval end = Interval(left) / Interval(form.a(i));
    const Interval allowed =
        form.a(i) > 0 ? Interval(-kInfinity, end.upper()) : Interval(end.lower(), kInfinity);
    if (is_disjoint(allowed, part[i])) return false;
    part[i] = boost::numeric::intersect(part[i], allowed);
  }
  return true;
}

/// How a convex part is found and its least value. Any choice is right.
struct ParabolaOptions {
  double curvature_margin = 1e-9;  ///< of the largest entry: what certainty costs
  int sweeps = 8;                  ///< of coordinate descent to the minimum
};

/// c + a' eta + eta' Q eta over eta in [-1, 1]^N, Q with halves of the mixed coefficients beside
/// the diagonal.
template <int N>
struct Parabola {
  Interval c;
  std::array<Interval, N> a;
  std::array<std::array<Interval, N>, N> Q;

  /// The form over a part, eps = middle + half width * eta.
  Parabola(const Quadratic<N>& form, const Part<N>& part) {
    std::array<double, N> m, h;
    for (int i = 0; i < N; ++i) {
      m[i] = middle(part[i]);
      h[i] = std::fmax(part[i].upper() - m[i], m[i] - part[i].lower());
    }
    c = Interval(form.c()) - Interval(form.r);
    for (int i = 0; i < N; ++i) {
      const Interval square(form.q(i, i));
      c += (Interval(form.a(i)) + square * m[i]) * m[i];
      a[i] = Interval(form.a(i)) + square * m[i] * 2.0;
      Q[i][i] = square * h[i] * h[i];
      for (int j = 0; j < N; ++j) {
        if (j == i) continue;
        const Interval mixed(form.q(std::min(i, j), std::max(i, j)));
        if (j > i) c += mixed * m[i] * m[j];
        a[i] += mixed * m[j];
        Q[i][j] = mixed * h[i] * h[j] / 2.0;
      }
      a[i] *= Interval(h[i]);
    }
  }

  /// Least curvature, about.
  double least_curvature() const {
    Eigen::Matrix<double, N, N> M;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) M(i, j) = middle(Q[i][j]);
    }
    if constexpr (N == 1) return M(0, 0);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver;
    solver.computeDirect(M, Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[0];
  }

  /// Whether Q - s E is positive semidefinite for certain: its leading minors are positive.
  bool is_convex_without(double s) const {
    std::array<std::array<Interval, N>, N> M = Q;
    for (int i = 0; i < N; ++i) M[i][i] -= s;
    if (!(M[0][0].lower() > 0)) return false;
    if constexpr (N >= 2) {
      if (!((M[0][0] * M[1][1] - M[0][1] * M[1][0]).lower() > 0)) return false;
    }
    if constexpr (N >= 3) {
      const Interval minor = M[0][0] * (M[1][1] * M[2][2] - M[1][2] * M[2][1]) -
                             M[0][1] * (M[1][0] * M[2][2] - M[1][2] * M[2][0]) +
                             M[0][2] * (M[1][0] * M[2][1] - M[1][1] * M[2][0]);
      if (!(minor.lower() > 0)) return false;
    }
    return true;
  }

  /// A lower bound: what is not convex of it, s |eta|^2 with s <= 0, at its least, and the convex
  /// part by its tangent plane near its minimum (alpha-BB: Androulakis, Maranas and Floudas, J.
  /// Glob. Optim. 7, 1995).
  double least(const ParabolaOptions& options = {}) const {
    double size = 0;
    for (int i = 0; i < N; ++i) size = std::fmax(size, boost::numeric::norm(Q[i][i]));
    const double s = std::fmin(least_curvature(), 0) - options.curvature_margin * size - 1e-290;
    if (!is_convex_without(s)) return -kInfinity;
    std::array<double, N> eta{};
    for (int sweep = 0; sweep < options.sweeps; ++sweep) {
      for (int i = 0; i < N; ++i) {
        double slope = middle(a[i]);
        for (int j = 0; j < N; ++j) {
          if (j != i) slope += 2 * middle(Q[i][j]) * eta[j];
        }
        const double bend = middle(Q[i][i]) - s;
        eta[i] = bend > 0 ? std::clamp(-slope / (2 * bend), -1.0, 1.0) : 0;
      }
    }
    Interval value = c + Interval(s) * static_cast<double>(N);
    for (int i = 0; i < N; ++i) {
      Interval along = (Q[i][i] - s) * eta[i];  // half of the slope of the square part
      for (int j = 0; j < N; ++j) {
        if (j != i) along += Q[i][j] * eta[j];
      }
      value += (a[i] + along) * eta[i];
      const Interval slope = a[i] + along * 2.0;
      value += slope * (Interval(-1, 1) - eta[i]);
    }
    return value.lower();
  }
};

/// A lower bound of the form over the part.
template <int N>
double least(const Quadratic<N>& form, const Part<N>& part) {
  if (!form.is_bounded()) return -kInfinity;
  const double simple = without(form, part, N).lower();
  const double sharp = Parabola<N>(form, part).least();
  return sharp > simple ? sharp : simple;
}

}  // namespace stillbase::proof
