// Factors L D L' of a small symmetric matrix that need not be definite, and its inertia.
//
// D has blocks of one and two; pivots are chosen by rook pivoting, which bounds the entries of L.
// Source: Ashcraft, Grimes and Lewis, "Accurate symmetric indefinite linear equation solvers", SIAM
// J. Matrix Anal. Appl. 20, 1998. The matrix is scaled to largest entries of one in every row
// first, so that one pivot of rounding size means a singular matrix.
#pragma once

#include <Eigen/Core>

namespace stillbase::nlp {

/// What an owner of the memory has of the factors; all are written by factorise().
struct DenseLdl {
  Eigen::Map<Eigen::MatrixXd> A;      ///< (n x n) both triangles on entry; L and D below
  Eigen::Map<Eigen::VectorXd> scale;  ///< (n)
  /// (n) row of the matrix behind each pivot; of a block of two, its one's complement.
  Eigen::Map<Eigen::VectorXi> order;
};

struct LdlInertia {
  bool is_singular = false;  ///< to rounding, or a number is not finite; there are no factors then
  int negative = 0;          ///< eigenvalues below zero
};

/// scale A scale = P' L D L' P.
LdlInertia factorise(DenseLdl& matrix);

/// A x = b, from factors.
/// @param b (n) replaced by x
/// @param work (n)
void solve(const DenseLdl& factors, Eigen::Ref<Eigen::VectorXd> b,
           Eigen::Ref<Eigen::VectorXd> work);

}  // namespace stillbase::nlp
