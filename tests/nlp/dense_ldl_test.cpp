// Factors of indefinite matrices: against Eigen's eigenvalues and the residual of a solution.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>

#include <stillbase/core/random.hpp>

#include "nlp/dense_ldl.hpp"

namespace stillbase::nlp {
namespace {

/// A matrix with its factors.
struct Factored {
  explicit Factored(const Eigen::MatrixXd& matrix)
      : n(matrix.rows()),
        entries(matrix.reshaped()),
        scale(n),
        order(n),
        factors{{entries.data(), n, n}, {scale.data(), n}, {order.data(), n}},
        inertia(factorise(factors)) {}
  Factored(const Factored&) = delete;

  Eigen::VectorXd solution(Eigen::VectorXd b) const {
    Eigen::VectorXd work(n);
    solve(factors, b, work);
    return b;
  }

  Eigen::Index n;
  Eigen::VectorXd entries, scale;
  Eigen::VectorXi order;
  DenseLdl factors;
  LdlInertia inertia;
};

Eigen::MatrixXd random_symmetric(Random& random, int n) {
  Eigen::MatrixXd out(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) out(i, j) = out(j, i) = random.uniform(-1, 1);
  }
  return out;
}

/// [H J'; J 0] with positive definite H, rank of J full: as many negative eigenvalues as rows of J.
Eigen::MatrixXd saddle(Random& random, int n, int m) {
  Eigen::MatrixXd root(n, n), out = Eigen::MatrixXd::Zero(n + m, n + m);
  for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = random.uniform(-1, 1);
  out.topLeftCorner(n, n) = root * root.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) out(n + i, j) = out(j, n + i) = random.uniform(-1, 1);
  }
  return out;
}

void check_solution(const Eigen::MatrixXd& A, Random& random) {
  const Factored factored(A);
  REQUIRE_FALSE(factored.inertia.is_singular);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues();
  CHECK(factored.inertia.negative == (eigenvalues.array() < 0).count());
  Eigen::VectorXd b(A.rows());
  for (double& entry : b) entry = random.uniform(-1, 1);
  const Eigen::VectorXd x = factored.solution(b);
  const double scale = A.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff();
  CHECK((A * x - b).cwiseAbs().maxCoeff() <= 1e-13 * (scale + 1));
}

}  // namespace

TEST_CASE("an indefinite matrix is factorised with its inertia") {
  Random random(3);
  for (int n = 1; n <= 40; ++n) check_solution(random_symmetric(random, n), random);
  for (int n = 2; n <= 20; ++n) {  // no diagonal: blocks of two alone
    Eigen::MatrixXd A = random_symmetric(random, 2 * n);
    A.diagonal().setZero();
    check_solution(A, random);
  }
  for (int m = 0; m <= 12; ++m) check_solution(saddle(random, 14, m), random);
}

TEST_CASE("rows of very different size are factorised") {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::MatrixXd A = saddle(random, 10, 4);
    // The diagonal of an interior point method near its bounds.
    for (int i = 0; i < 5; ++i) A(i, i) += std::pow(10, random.uniform(0, 12));
    const Factored factored(A);
    REQUIRE_FALSE(factored.inertia.is_singular);
    CHECK(factored.inertia.negative == 4);
    Eigen::VectorXd b = Eigen::VectorXd::Ones(14);
    const Eigen::VectorXd x = factored.solution(b);
    // Backward stable row by row.
    const Eigen::VectorXd scale = A.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
    CHECK((A * x - b).cwiseAbs().cwiseQuotient(scale).maxCoeff() < 1e-12);
  }
}

TEST_CASE("a singular matrix and one that is not finite have no factors") {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::MatrixXd A = saddle(random, 10, 5);
    // The last row of J depends on the others.
    A.bottomRows(1) = A.middleRows(10, 4).colwise().sum();
    A.rightCols(1) = A.bottomRows(1).transpose();
    A(14, 14) = 0;
    CHECK(Factored(A).inertia.is_singular);
  }
  CHECK(Factored(Eigen::MatrixXd::Zero(3, 3)).inertia.is_singular);
  Eigen::MatrixXd with_zero_row = random_symmetric(random, 6);
  with_zero_row.row(2).setZero();
  with_zero_row.col(2).setZero();
  CHECK(Factored(with_zero_row).inertia.is_singular);
  for (const double bad :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Eigen::MatrixXd A = random_symmetric(random, 4);
    A(1, 2) = A(2, 1) = bad;
    CHECK(Factored(A).inertia.is_singular);
  }
}

}  // namespace stillbase::nlp
