#include "formulation/measures/ball_maximum.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

constexpr double kRounding = 1e-14;  ///< of eigenvalues and of components of q
constexpr int kHalvings = 200;

/// The sphere's condition in the eigenvectors' axes, delta = mu - lambda_max:
/// sum c_i^2 / (delta + gap_i)^2 = 1.
struct Secular {
  Vector6d c;    ///< components of q, the largest eigenvalue's last
  Vector6d gap;  ///< lambda_max - lambda_i >= 0
  int others;    ///< number of those below lambda_max

  double square(double delta) const { return point(delta).squaredNorm(); }
  Vector6d point(double delta) const {
    Vector6d z;
    for (int i = 0; i < 6; ++i) {
      const double divisor = delta + (i < others ? gap[i] : 0);
      z[i] = c[i] == 0 ? 0 : c[i] / divisor;
    }
    return z;
  }
  double slope(double delta) const {  ///< -1/2 of the derivative of square()
    double sum = 0;
    for (int i = 0; i < 6; ++i) {
      const double divisor = delta + (i < others ? gap[i] : 0);
      if (c[i] != 0) sum += c[i] * c[i] / (divisor * divisor * divisor);
    }
    return sum;
  }
};

/// The place between `a`, where f is positive, and `b`, where it is not.
template <class F>
double sign_change(F f, double a, double b) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (a + b) / 2;
    if (middle == a || middle == b) break;
    (f(middle) > 0 ? a : b) = middle;
  }
  return (a + b) / 2;
}

}  // namespace

std::vector<Vector6d> maxima_over_ball(const Matrix6d& P, const Vector6d& q) {
  const SymmetricEigen eigen = symmetric_eigen(P);
  const double largest = std::max(eigen.values[5], 0.0);
  const double size = largest + q.norm();
  const auto back = [&eigen](const Vector6d& z) {
    return Vector6d(eigen.vectors * z).normalized();
  };
  if (!(size > 0)) return {Vector6d::Unit(0)};

  Secular secular{eigen.vectors.transpose() * q,
                  (largest - eigen.values.array()).matrix().cwiseMax(0), 6};
  while (secular.others > 0 && secular.gap[secular.others - 1] <= kRounding * largest) {
    --secular.others;
  }
  const int others = secular.others;
  double along = secular.c.tail(6 - others).norm();  // of q, in the eigenspace of lambda_max
  if (along <= kRounding * size) {
    secular.c.tail(6 - others).setZero();
    along = 0;
  }
  const auto outside = [&secular](double delta) { return secular.square(delta) - 1; };

  if (along == 0) {
    Vector6d z = secular.point(0);
    const double squared = z.squaredNorm();
    if (squared <= 1) {  // the hard case
      z[5] = std::sqrt(1 - squared);
      Vector6d other = z;
      other[5] = -z[5];
      return {back(z), back(other)};
    }
    return {back(secular.point(sign_change(outside, 0, secular.c.norm())))};
  }
  // Just above `along` the term of lambda_max alone is one.
  std::vector<Vector6d> out = {
      back(secular.point(sign_change(outside, along * (1 - 1e-15), secular.c.norm())))};
  // The other local maximum, between the poles at -gap and 0, right of the least value of square().
  if (others == 5) {
    const double pole = -secular.gap[4];
    const auto falls = [&secular](double delta) { return secular.slope(delta); };
    const double lowest = sign_change(falls, pole, 0);
    if (lowest < -along && secular.square(lowest) < 1) {
      out.push_back(back(secular.point(sign_change(outside, -along, lowest))));
    }
  }
  return out;
}

}  // namespace stillbase
