// The quadratic programs of a replanner: judged by their own optimality conditions.
#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include <stillbase/core/random.hpp>

#include "nlp/dense_qp.hpp"

namespace stillbase::nlp {
namespace {

Eigen::VectorXd random_vector(Random& random, Eigen::Index size) {
  Eigen::VectorXd out(size);
  for (Eigen::Index i = 0; i < size; ++i) out[i] = random.uniform(-1, 1);
  return out;
}

}  // namespace

TEST_CASE("the solution of a quadratic program satisfies its optimality conditions") {
  Random random(11);
  DenseQp qp(9, 40);
  int with_active = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + trial % 8, equations = trial % 3 < n - 1 ? trial % 3 : 0;
    const int inequalities = 4 * (trial % 9);
    qp.begin(n);
    Eigen::MatrixXd root(n, n);
    for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = random.uniform(-1, 1);
    const Eigen::MatrixXd H = root * root.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd g = random_vector(random, n), inside = random_vector(random, n);
    qp.hessian() = H;
    qp.gradient() = g;
    std::vector<double> slacks;
    for (int i = 0; i < equations + inequalities; ++i) {
      const Eigen::VectorXd normal = random_vector(random, n);
      const double slack = i < equations ? 0 : random.uniform(0, 0.3);
      slacks.push_back(slack);
      qp.add_row(normal.dot(inside) - slack, i < equations) = normal;
    }
    INFO("trial " << trial);
    REQUIRE(qp.solve() == DenseQp::Outcome::Solved);
    const Eigen::VectorXd d = qp.solution();
    const Eigen::VectorXd u = qp.multipliers();
    Eigen::VectorXd residual = H * d + g;
    for (int i = 0; i < qp.rows(); ++i) {
      residual -= u[i] * qp.normal(i);
      const double slack = qp.normal(i).dot(d - inside);
      if (i < equations) {
        CHECK(std::abs(slack) < 1e-10);
        continue;
      }
      // b_i is the slack below `inside`.
      const double left = slack + slacks[static_cast<std::size_t>(i)];
      CHECK(left > -1e-10);
      CHECK(u[i] >= 0);
      CHECK(u[i] * std::abs(left) < 1e-10 * (1 + u[i]));
      if (u[i] > 0) ++with_active;
    }
    CHECK(residual.lpNorm<Eigen::Infinity>() < 1e-9 * (1 + u.lpNorm<Eigen::Infinity>()));
  }
  CHECK(with_active > 100);
}

TEST_CASE("bounds of a quadratic program are rows, and it may have any number of variables") {
  Random random(12);
  DenseQp qp(14, 60);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 14, inequalities = trial % 7;
    Eigen::MatrixXd root(n, n);
    for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = random.uniform(-1, 1);
    const Eigen::MatrixXd H = root * root.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd g = random_vector(random, n);
    std::vector<Eigen::VectorXd> normals;
    for (int i = 0; i < inequalities; ++i) normals.push_back(random_vector(random, n));
    const auto solve = [&](bool as_rows) {
      qp.begin(n);
      qp.hessian() = H;
      qp.gradient() = g;
      for (const Eigen::VectorXd& normal : normals) qp.add_row(-0.2) = normal;
      for (int i = 0; i < n; ++i) {
        for (const double sign : {1.0, -1.0}) {
          if (as_rows) {
            qp.add_row(-0.3) = sign * Eigen::VectorXd::Unit(n, i);
          } else {
            qp.add_bound(i, sign, -0.3);
            CHECK(qp.normal(qp.rows() - 1) == sign * Eigen::VectorXd::Unit(n, i));
          }
        }
      }
      REQUIRE(qp.solve() == DenseQp::Outcome::Solved);
      Eigen::VectorXd out(n + qp.rows());
      out << qp.solution(), qp.multipliers();
      return out;
    };
    INFO("trial " << trial);
    CHECK((solve(true) - solve(false)).lpNorm<Eigen::Infinity>() < 1e-10);
  }
}

TEST_CASE("rows of a quadratic program hold, the active ones exactly") {
  DenseQp qp(2, 3);
  qp.begin(2);
  qp.hessian().setIdentity();
  qp.gradient() << -3, -2;
  qp.add_row(-1) << -1, 0;  // d_1 <= 1
  qp.add_row(-1) << 0, -1;  // d_2 <= 1
  qp.add_row(-5) << 1, 1;   // not active
  REQUIRE(qp.solve() == DenseQp::Outcome::Solved);
  CHECK((qp.solution() - Eigen::Vector2d(1, 1)).norm() < 1e-15);
  CHECK((qp.multipliers() - Eigen::Vector3d(2, 1, 0)).norm() < 1e-15);
}

TEST_CASE(
    "a quadratic program says that its rows contradict each other, or that it is not convex") {
  DenseQp qp(2, 4);
  qp.begin(2);
  qp.hessian().setIdentity();
  qp.gradient().setZero();
  qp.add_row(1) << 1, 0;
  qp.add_row(1) << -1, 0;
  CHECK(qp.solve() == DenseQp::Outcome::Inconsistent);
  qp.begin(2);
  qp.add_row(1, true) << 1, 1;
  qp.add_row(2, true) << 1, 1;
  CHECK(qp.solve() == DenseQp::Outcome::Inconsistent);
  qp.begin(2);
  qp.add_row(1, true) << 1, 1;
  qp.add_row(2, true) << 2, 2;  // the same again
  CHECK(qp.solve() == DenseQp::Outcome::Solved);
  qp.hessian() << 1, 0, 0, -1;
  CHECK(qp.solve() == DenseQp::Outcome::NotConvex);
  qp.hessian() << 1, 0, 0, std::nan("");
  CHECK(qp.solve() == DenseQp::Outcome::NotConvex);
}

}  // namespace stillbase::nlp
