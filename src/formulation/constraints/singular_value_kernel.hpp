// A singular value and its vectors, for any number type.
//
// Values come from a decomposition; what S carries along follows from one Newton step in S on the
// equations of the eigenvector, exact for first derivatives. Where the singular value is multiple
// it has no derivative: what is returned belongs to one of its vectors, and the directions in which
// the vectors are undetermined count as still.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include <stillbase/core/linear_algebra.hpp>

#include "formulation/constraints/constraint.hpp"
#include "formulation/constraints/sample_postures.hpp"

namespace stillbase {

/// Largest rank of a matrix over some postures: its rank almost everywhere.
/// @param matrix_at of a PostureImpact<double>
template <class MatrixAt>
int generic_rank(const CaptureModel& model, const MatrixAt& matrix_at) {
  constexpr double kZero = 1e-9;  // of the largest singular value
  int rank = 0;
  for_sample_postures(model, [&](const PostureImpact<double>& posture) {
    rank = std::max(rank, numerical_rank(singular_values(matrix_at(posture)), kZero));
  });
  return rank;
}

template <class S>
struct SingularTriple {
  S sigma = S(0);
  Eigen::Matrix<S, Eigen::Dynamic, 1> u, v;  ///< A v = sigma u, A' u = sigma v
};

/// The r-th largest singular value of A, r from 1 to its smaller dimension; positive.
template <class S>
SingularTriple<S> singular_triple(const Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>& A,
                                  int r) {
  using std::sqrt;
  Eigen::MatrixXd plain(A.rows(), A.cols());
  for (Eigen::Index i = 0; i < A.size(); ++i) plain(i) = value_of_number(A(i));
  const Svd svd = thin_svd(plain);
  const double sigma = svd.sigma[r - 1];
  const Eigen::VectorXd u = svd.U.col(r - 1);
  SingularTriple<S> out;
  if constexpr (std::is_same_v<S, double>) {
    out.sigma = sigma;
    out.u = u;
    out.v = svd.V.col(r - 1);
  } else {
    // (A A' - lambda) u = 0, (u'u - 1) / 2 = 0 in lambda and u.
    const Eigen::Index m = A.rows();
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(m + 1, m + 1);
    jacobian.topLeftCorner(m, m) = plain * plain.transpose();
    jacobian.diagonal().head(m).array() -= sigma * sigma;
    jacobian.topRightCorner(m, 1) = -u;
    jacobian.bottomLeftCorner(1, m) = u.transpose();
    const Eigen::MatrixXd inverse = pseudo_inverse(jacobian, 1e-10);
    Eigen::Matrix<S, Eigen::Dynamic, 1> residual(m + 1), step(m + 1);
    const Eigen::Matrix<S, Eigen::Dynamic, 1> u_S = u.template cast<S>();
    residual.head(m) = A * (A.transpose() * u_S) - u_S * S(sigma * sigma);
    residual[m] = S(0);
    step = inverse.template cast<S>() * residual;
    out.u = u_S - step.head(m);
    out.sigma = sqrt(S(sigma * sigma) - step[m]);
    out.v = A.transpose() * out.u / out.sigma;
  }
  return out;
}

/// Adds a lower bound of the least singular value of a matrix, of its generic
/// rank.
/// @param matrix_at []<class S>(const PostureImpact<S>&) -> matrix
/// @param gradient_of []<class S>(const ConstraintPoint<S>&, v, u) -> gradient of u' A v over phi
template <class MatrixAt, class GradientOf>
void add_least_singular_value(const CaptureModel& model, ConstraintSet& out, ConstraintLabel label,
                              MatrixAt matrix_at, GradientOf gradient_of) {
  const int rank = generic_rank(model, [&](const PostureImpact<double>& posture) {
    return Eigen::MatrixXd(matrix_at(posture));
  });
  if (rank == 0) return;
  label.needs_inertia = true;
  label.is_limit = true;
  const auto least = [rank, matrix_at, gradient_of]<class S>(const ConstraintPoint<S>& at,
                                                             ScalarGradient<S>* gradient) -> S {
    const SingularTriple<S> triple = singular_triple<S>(matrix_at(at.posture), rank);
    if (gradient != nullptr) {  // d sigma = u' dA v
      gradient->phi = gradient_of.template operator()<S>(at, triple.v, triple.u);
    }
    return triple.sigma;
  };
  add_constraint(out.rows, std::move(label), least);
}

}  // namespace stillbase
