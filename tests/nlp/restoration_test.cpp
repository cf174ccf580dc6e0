// Newton's step onto constraints within a box.
#include <catch2/catch.hpp>

#include <algorithm>

#include <Eigen/QR>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>

#include "nlp/restoration.hpp"

namespace stillbase::nlp {
namespace {

Eigen::MatrixXd random_matrix(Random& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd out(rows, columns);
  for (double& entry : out.reshaped()) entry = random.uniform(-1, 1);
  return out;
}

/// By another factorisation: the shortest x with A x = b in the least squares.
Eigen::VectorXd shortest(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  return qr.compute(A).solve(b);
}

}  // namespace

TEST_CASE("a step onto constraints is the shortest of least squares, whatever the rank") {
  Random random(3);
  const Eigen::VectorXd free = Eigen::VectorXd::Constant(8, kInfinity);
  for (int rows = 1; rows <= 12; ++rows) {
    for (int rank = 0; rank <= std::min(rows, 8); ++rank) {
      const Eigen::MatrixXd J = random_matrix(random, rows, rank) * random_matrix(random, rank, 8);
      const Eigen::VectorXd r = random_matrix(random, rows, 1);
      const Eigen::VectorXd step = step_within_box(J, r, Eigen::VectorXd::Zero(8), -free, free);
      const Eigen::VectorXd wanted = -shortest(J, r);
      CAPTURE(rows, rank);
      CHECK((step - wanted).norm() <= 1e-9 * (1 + wanted.squaredNorm()));
    }
  }
}

TEST_CASE("lengths of rows differ by eight orders and a step still meets all of them") {
  Random random(4);
  const Eigen::VectorXd free = Eigen::VectorXd::Constant(6, kInfinity);
  Eigen::MatrixXd J = random_matrix(random, 3, 6);
  J.row(0) *= 1e-5;
  J.row(2) *= 1e3;
  const Eigen::Vector3d r(1e-5, 1, 1e3);
  const Eigen::VectorXd step = step_within_box(J, r, Eigen::VectorXd::Zero(6), -free, free);
  CHECK(((J * step + r).array() / r.array()).matrix().norm() <= 1e-9);
}

TEST_CASE("a step meets a row that nearly depends on the others as well") {
  Random random(5);
  const Eigen::VectorXd free = Eigen::VectorXd::Constant(9, kInfinity);
  for (const double distance : {1e-2, 1e-4, 1e-6}) {
    Eigen::MatrixXd J = random_matrix(random, 5, 9);
    J.row(4) = J.row(0) + J.row(2) + distance * random_matrix(random, 1, 9);
    const Eigen::VectorXd r = J * random_matrix(random, 9, 1);
    const Eigen::VectorXd step = step_within_box(J, r, Eigen::VectorXd::Zero(9), -free, free);
    CHECK((J * step + r).norm() <= 1e-14 * r.norm());
  }
}

TEST_CASE("variables at a bound that a step would leave stay there") {
  const Eigen::RowVector3d J(1, 2, 2);
  const Eigen::VectorXd r = Eigen::VectorXd::Constant(1, 3);
  const Eigen::Vector3d x(0, 0, 5), lower(0, -9, -9), upper(9, 9, 9);
  const Eigen::VectorXd step = step_within_box(J, r, x, lower, upper);
  CHECK(step[0] == 0);
  CHECK(step[1] == Approx(-0.75));
  CHECK(step[2] == Approx(-0.75));
}

}  // namespace stillbase::nlp
