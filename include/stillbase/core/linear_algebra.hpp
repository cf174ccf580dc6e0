// Decompositions of small dense matrices. Eigen's templates are instantiated once, in
// linear_algebra.cpp, because each instantiation costs seconds of compile time.
//
// Assumptions: all entries are finite. Rank decisions belong to the caller, who states the
// tolerance.
#pragma once

#include <optional>
#include <variant>

#include <Eigen/QR>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// A = U diag(sigma) V', sigma from largest to smallest.
struct Svd {
  Eigen::MatrixXd U;      ///< left singular vectors
  Eigen::VectorXd sigma;  ///< as many as the smaller dimension
  Eigen::MatrixXd V;      ///< right singular vectors
};

/// A = U diag(sigma) V' of a 3 x 3 matrix, sigma from largest to smallest.
struct Svd3 {
  Matrix3d U;
  Vector3d sigma;
  Matrix3d V;
};

/// A = vectors diag(values) vectors', values from smallest to largest.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< orthonormal columns
};

/// A = vectors diag(values) vectors' of a 3 x 3 matrix, values from smallest to largest.
struct SymmetricEigen3 {
  Vector3d values;
  Matrix3d vectors;  ///< orthonormal columns
};

/// allFinite() without a branch per number.
template <class Derived>
bool are_finite(const Eigen::DenseBase<Derived>& M) {
  return (M.derived().array() * 0).sum() == 0;
}

/// Singular values from largest to smallest; none of an empty matrix.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& A);

/// As many columns in U and V as singular values. A must not be empty.
Svd thin_svd(const Eigen::MatrixXd& A);

/// V square, so that its last columns span the null space; U stays empty. A must not be empty.
Svd right_svd(const Eigen::MatrixXd& A);

Svd3 svd3(const Matrix3d& A);

/// Number of leading singular values above relative_tolerance times the largest.
int numerical_rank(const Eigen::Ref<const Eigen::VectorXd>& sigma, double relative_tolerance);

/// Only the lower triangle of A is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);
SymmetricEigen3 symmetric_eigen3(const Matrix3d& A);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A);

/// Eigenvalues of a symmetric 3 x 3 matrix such as an inertia tensor, from smallest to largest.
Vector3d principal_moments(const Matrix3d& inertia);

/// x of least norm among those of least |A x - b|. Pivots below `threshold` of the largest count as
/// zero (complete orthogonal decomposition).
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                    double threshold);

/// Pseudo-inverse with the rank decision of least_norm_solution().
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A, double threshold);

/// Householder QR with column pivoting, A P = Q R, of an m x k matrix.
class PivotedQr {
 public:
  /// @param threshold part of the largest pivot below which one counts as zero; without it the
  /// rounding of the decomposition
  explicit PivotedQr(const Eigen::MatrixXd& A, std::optional<double> threshold = {});

  Eigen::Index rank() const;
  /// Orthonormal basis (m x m - rank) of what is normal to all columns of A.
  Eigen::MatrixXd complement() const;
  /// Components of the columns of M (m x any) along complement().
  Eigen::MatrixXd complement_components(const Eigen::MatrixXd& M) const;
  /// A least-squares solution of A x = b (m).
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The same for each column of B (m x any).
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& B) const;

 private:
  static constexpr int kInPlace = 24;  ///< rows and columns that need no heap
  using InPlace =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kInPlace, kInPlace>;
  using Qr = std::variant<Eigen::ColPivHouseholderQR<InPlace>,
                          Eigen::ColPivHouseholderQR<Eigen::MatrixXd>>;

  static Qr decompose(const Eigen::MatrixXd& A);

  Qr qr_;
};

}  // namespace stillbase
