// Minima to their last digits.
#include "nlp/refinement.hpp"

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/certificate.hpp>

#include "nlp/known_problems.hpp"

namespace stillbase::nlp {
namespace {

/// 1/2 (x - c)' diag(h) (x - c) + k (x0 - c0)^3 within wide bounds.
KnownProblem valley(const Eigen::VectorXd& h, const Eigen::VectorXd& c, double k = 0) {
  KnownProblem p;
  p.start = c;
  p.l = Eigen::VectorXd::Constant(c.size(), -10);
  p.u = Eigen::VectorXd::Constant(c.size(), 10);
  p.model = [h, c, k](const Eigen::VectorXd& x, Evaluation& e) {
    const Eigen::VectorXd d = x - c;
    e.objective = d.dot(h.cwiseProduct(d)) / 2 + k * d[0] * d[0] * d[0];
    e.gradient = h.cwiseProduct(d);
    e.gradient[0] += 3 * k * d[0] * d[0];
  };
  p.hessian = [h, c, k](const Eigen::VectorXd& x, double sigma, const Eigen::VectorXd&,
                        Eigen::MatrixXd& H) {
    H = h.asDiagonal();
    H(0, 0) += 6 * k * (x[0] - c[0]);
    H *= sigma;
  };
  return p;
}

double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).lpNorm<Eigen::Infinity>();
}

}  // namespace

TEST_CASE("known minima are refined to rounding from where solvers leave off") {
  int refined = 0;
  for (const KnownProblem& p : known_problems()) {
    for (const Eigen::VectorXd& minimiser : p.minimisers) {
      CAPTURE(p.name);
      const Eigen::VectorXd start = minimiser.array() + 1e-7;
      const Eigen::VectorXd x = refined_minimum(p, start.cwiseMax(p.l).cwiseMin(p.u));
      const Eigen::VectorXd again = refined_minimum(p, minimiser);
      if (certify(p, x).kkt_residual > 1e-12) continue;  // for its curvature the start is far off
      ++refined;
      CHECK(distance(x, again) <= 1e-9);
    }
  }
  CHECK(refined >= 4);
}

TEST_CASE("a flat minimum is placed by its curvature, with a Hessian and without") {
  const Eigen::VectorXd c = vec({0.123456789, -0.987654321, 0.5});
  KnownProblem p = valley(vec({1, 1e-3, 1e-5}), c, 0.3);
  const Eigen::VectorXd start = c + vec({3e-8, -4e-7, 6e-6});
  REQUIRE(certify(p, start).kkt_residual < 1e-7);
  CHECK(distance(refined_minimum(p, start), c) < 1e-14);
  const Eigen::VectorXd steep = c + vec({3e-6, 4e-6, 6e-6});
  CHECK(distance(refined_minimum(p, steep), c) < 1e-14);
  p.hessian = nullptr;
  CHECK(distance(refined_minimum(p, start), c) < 1e-13);
}

TEST_CASE("an active bound and an active row are met exactly, those without a force are left") {
  // Minimise (x0 - 2)^2 / 2 + (x1 - 1)^2 / 2 + (x2 - 3)^2 / 2 with x0 <= 1 and x1 + x2 <= 2.
  KnownProblem p = valley(vec({1, 1, 1}), vec({2, 1, 3}));
  p.u[0] = 1;
  p.g_l = vec({-kInfinity});
  p.g_u = vec({2});
  const auto free_model = p.model;
  p.model = [free_model](const Eigen::VectorXd& x, Evaluation& e) {
    free_model(x, e);
    e.constraints[0] = x[1] + x[2];
    e.jacobian << 0, 1, 1;
  };
  const Eigen::VectorXd x = refined_minimum(p, vec({1 - 3e-7, 2e-8, 2 - 5e-7}));
  CHECK(distance(x, vec({1, 0, 2})) < 1e-14);
  CHECK(x[0] <= p.u[0]);
  // The minimum lies on the bound of x0 by chance.
  p.u[0] = 2;
  CHECK(distance(refined_minimum(p, vec({2 - 3e-7, 2e-8, 2 - 5e-7})), vec({2, 0, 2})) < 1e-14);
}

TEST_CASE("without a Hessian bounds that a minimum meets by chance are no walls for its steps") {
  // Minimise d' H d / 2 + a' d, d = x - c, on a' d = 0; x0, x1 and, from below, x2 at their bounds.
  Random random(1);
  const auto normal = [&random](Eigen::Index rows, Eigen::Index cols) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&random] { return random.normal(); });
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::VectorXd c = normal(5, 1), a = normal(5, 1);
    const Eigen::MatrixXd root = normal(5, 5);
    const Eigen::MatrixXd H = root * root.transpose() + Eigen::MatrixXd::Identity(5, 5);
    KnownProblem p = valley(Eigen::VectorXd::Ones(5), c);
    p.hessian = nullptr;
    p.g_l = p.g_u = Eigen::VectorXd::Constant(1, a.dot(c));
    p.model = [H, a, c](const Eigen::VectorXd& x, Evaluation& e) {
      const Eigen::VectorXd d = x - c;
      e.objective = d.dot(H * d) / 2 + a.dot(d);
      e.gradient = H * d + a;
      e.constraints[0] = a.dot(x);
      e.jacobian = a.transpose();
    };
    p.u.head(2) = c.head(2);
    p.l[2] = c[2];
    const Eigen::VectorXd start = (c + 1e-7 * normal(5, 1)).cwiseMax(p.l).cwiseMin(p.u);
    CAPTURE(trial);
    CHECK(distance(refined_minimum(p, start), c) < 1e-12);
  }
}

TEST_CASE("along a direction in which nothing changes x is rounded, and stays where it was") {
  const Eigen::VectorXd c = vec({0.25, 0, 0.75});
  const KnownProblem p = valley(vec({1, 0, 2}), c);
  const Eigen::VectorXd a = refined_minimum(p, vec({0.25 + 1e-8, 0.1234567891, 0.75}));
  const Eigen::VectorXd b = refined_minimum(p, vec({0.25, 0.1234567888, 0.75 - 1e-8}));
  CHECK(distance(a, b) < 1e-15);
  CHECK(distance(a, vec({0.25, 0.12346, 0.75})) < 1e-15);
}

TEST_CASE("one free direction beside equations is flat, one along an orbit too") {
  KnownProblem p = valley(vec({1, 0}), vec({0.25, 0}));
  p.g_l = p.g_u = vec({0.25});
  for (const double noise : {1e-17, -1e-17}) {
    const auto model = valley(vec({1, noise}), vec({0.25, 0})).model;
    p.hessian = valley(vec({1, noise}), vec({0.25, 0})).hessian;
    p.model = [model](const Eigen::VectorXd& x, Evaluation& e) {
      model(x, e);
      e.constraints[0] = x[0];
      e.jacobian << 1, 0;
    };
    const Eigen::VectorXd x = refined_minimum(p, vec({0.25 + 1e-8, 0.1234567891}));
    CHECK(distance(x, vec({0.25, 0.12346})) < 1e-15);
  }
  // (|x| - 1)^2 / 2 is zero on a circle.
  KnownProblem orbit = valley(vec({1, 1}), vec({0, 0}));
  orbit.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    const double r = x.norm();
    e.objective = (r - 1) * (r - 1) / 2;
    e.gradient = x * (r - 1) / r;
  };
  orbit.hessian = nullptr;
  const Eigen::VectorXd side = vec({std::cos(0.7), std::sin(0.7)});
  const Eigen::VectorXd on = refined_minimum(orbit, side);
  for (const double off : {1e-7, 1e-9, -1e-9, -1e-7}) {
    CHECK(distance(refined_minimum(orbit, (1 + off) * side), on) < 1e-12);
  }
}

TEST_CASE("a bound that a residual pushes at is left again") {
  KnownProblem p = valley(vec({0.05, 1}), vec({1, 2}));
  p.u[0] = 1 + 5e-7;
  CHECK(distance(refined_minimum(p, vec({1 - 3e-8, 2 + 5e-8})), vec({1, 2})) < 1e-14);
  CHECK(distance(refined_minimum(p, vec({1 + 3e-8, 2 + 5e-8})), vec({1, 2})) < 1e-14);
  CHECK(distance(refined_minimum(p, vec({1 - 3e-8, 2})), vec({1, 2})) < 1e-14);
}

TEST_CASE("what is no minimum, or not near one, is left as it is") {
  const Eigen::VectorXd c = vec({0.25, 0.5});
  const Eigen::VectorXd near = c + vec({1e-8, 1e-8});
  CHECK(refined_minimum(valley(vec({1, -1}), c), near) == near);  // a saddle
  const Eigen::VectorXd far = c + vec({1e-3, 0});
  CHECK(refined_minimum(valley(vec({1, 1}), c), far) == far);
  // The gradient is small, the minimum far.
  const Eigen::VectorXd flat = c + vec({0, 1e-2});
  CHECK(refined_minimum(valley(vec({1, 1e-6}), c), flat) == flat);
  KnownProblem undefined = valley(vec({1, 1}), c);
  const auto model = undefined.model;
  undefined.model = [model, near](const Eigen::VectorXd& x, Evaluation& e) {
    model(x, e);
    if (x != near) e.objective = std::nan("");
  };
  CHECK(refined_minimum(undefined, near) == near);
}

TEST_CASE("a minimum at a kink of a row keeps the side from which it is stationary") {
  // Minimise x1 - x0 / 2 + |x|^2 / 2 with the rows min(x1 + x0, x1 - x0) >= 0 and x1 - x0 >= 0. At
  // the minimum (0, 0) they balance the gradient where the first is x1 + x0, and not where both are
  // the same.
  KnownProblem p;
  p.start = vec({0, 0});
  p.l = vec({-10, -10});
  p.u = vec({10, 10});
  p.g_l = vec({0, 0});
  p.g_u = vec({kInfinity, kInfinity});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x[1] - x[0] / 2 + (x[0] * x[0] + x[1] * x[1]) / 2;
    e.gradient << x[0] - 0.5, 1 + x[1];
    const bool is_left = x[1] + x[0] < x[1] - x[0];
    e.constraints << (is_left ? x[1] + x[0] : x[1] - x[0]), x[1] - x[0];
    e.jacobian << (is_left ? 1 : -1), 1, -1, 1;
  };
  // Of some the step ends at the minimum or beyond it by rounding, where the first row is the
  // other.
  for (int i = 1; i <= 10; ++i) {
    const Eigen::VectorXd start = vec({-2e-8 * i, 1e-8});
    REQUIRE(certify(p, start).kkt_residual < 1e-6);
    const Eigen::VectorXd x = refined_minimum(p, start);
    CHECK(distance(x, vec({0, 0})) < 1e-12);
    CHECK(certify(p, x).kkt_residual < 1e-12);
  }
}

}  // namespace stillbase::nlp
