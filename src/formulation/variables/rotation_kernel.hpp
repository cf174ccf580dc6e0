// Rotation vectors for any number type, smooth at zero.
#pragma once

#include <stillbase/core/rotation.hpp>

namespace stillbase {

/// sin(sqrt(x)) / sqrt(x), smooth in x at zero.
template <class S>
S sinc_of_square(const S& x) {
  using std::sin;
  using std::sqrt;
  if (x > S(0.09)) {
    const S t = sqrt(x);
    return sin(t) / t;
  }
  return S(1) -
         x * (S(1. / 6) -
              x * (S(1. / 120) - x * (S(1. / 5040) - x * (S(1. / 362880) - x * S(1. / 39916800)))));
}

/// (t - sin t) / t^3 with t = sqrt(x).
template <class S>
S third_order_sine_remainder(const S& x) {
  using std::sin;
  using std::sqrt;
  if (x > S(0.09)) {
    const S t = sqrt(x);
    return (t - sin(t)) / (t * x);
  }
  return S(1. / 6) -
         x * (S(1. / 120) -
              x * (S(1. / 5040) -
                   x * (S(1. / 362880) - x * (S(1. / 39916800) - x * S(1. / 6227020800.)))));
}

/// Rotation matrix of a rotation vector; differentiable at zero, unlike the norm in it.
template <class S>
Matrix3<S> rotation_matrix(const Vector3<S>& a) {
  const S x = a.squaredNorm();
  const S half = sinc_of_square<S>(x / S(4));
  const Matrix3<S> A = skew<S>(a);
  Matrix3<S> R = A * sinc_of_square(x) + A * A * (half * half / S(2));
  for (int i = 0; i < 3; ++i) R(i, i) += S(1);
  return R;
}

/// J_r: exp(a + da) = exp(a) exp(J_r(a) da).
template <class S>
Matrix3<S> right_jacobian(const Vector3<S>& a) {
  const S x = a.squaredNorm();
  const S half = sinc_of_square<S>(x / S(4));
  const Matrix3<S> A = skew<S>(a);
  Matrix3<S> J = A * A * third_order_sine_remainder(x) - A * (half * half / S(2));
  for (int i = 0; i < 3; ++i) J(i, i) += S(1);
  return J;
}

}  // namespace stillbase
