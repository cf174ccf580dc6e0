// The joint velocity that carries no angular momentum and is nearest to a wanted one.
#pragma once

#include <vector>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

template <class S>
struct NullVelocity {
  JointVector<S> phidot;  ///< of the free joints: wanted - A' (A A')^-1 A wanted
  S conditioning;         ///< of A A': at most its least eigenvalue over the largest
};

/// A: columns of Htilde_omegaphi, see TildeInertia. A robot that cannot turn about every axis by
/// itself has a conditioning of zero, but for rounding, and no result.
/// @param phi joint positions (n)
/// @param free indices of the joints that may move (m <= n)
/// @param wanted their velocities (m)
template <class S>
NullVelocity<S> nearest_null_velocity(const RobotModel& robot, const JointVector<S>& phi,
                                      const std::vector<Eigen::Index>& free,
                                      const JointVector<S>& wanted) {
  const auto inertia =
      kernel::inertia<S, kernel::InertiaParts::Coupling>(robot, compute_kinematics<S>(robot, phi));
  const Eigen::Index m = wanted.size();
  Matrix3X<S> A(3, m);
  Matrix3<S> square = Matrix3<S>::Zero();  // A A', lower triangle
  Vector3<S> momentum = Vector3<S>::Zero();
  for (Eigen::Index k = 0; k < m; ++k) {
    const Vector3<S> column = angular_coupling(inertia, free[static_cast<std::size_t>(k)]);
    A.col(k) = column;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) square(i, j) += column[i] * column[j];
    }
    momentum += column * wanted[k];
  }
  const S trace = square(0, 0) + square(1, 1) + square(2, 2);
  factorize_cholesky(square);
  solve_cholesky(square, momentum);
  NullVelocity<S> out;
  // The product of the eigenvalues is at most the least one times the square of half the trace, and
  // none is above the trace. The factor's diagonal holds 1 / D.
  out.conditioning = S(4) / (square(0, 0) * square(1, 1) * square(2, 2) * trace * trace * trace);
  out.phidot.resize(m);
  for (Eigen::Index k = 0; k < m; ++k) {
    out.phidot[k] = wanted[k] - A.col(k).dot(momentum);
  }
  return out;
}

}  // namespace stillbase
