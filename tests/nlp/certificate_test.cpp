#include <stillbase/nlp/certificate.hpp>

#include <catch2/catch.hpp>

#include "nlp/known_problems.hpp"

namespace stillbase::nlp {
namespace {

TEST_CASE("the KKT residual is zero at every known minimiser") {
  for (const KnownProblem& p : known_problems()) {
    for (const Eigen::VectorXd& minimiser : p.minimisers) {
      CAPTURE(p.name);
      const Certificate c = certify(p, minimiser);
      // HS071 is printed to nine decimals, with gradients of order ten.
      CHECK(c.kkt_residual < 1e-7);
      CHECK(c.max_violation < 1e-7);
      CHECK(c.complementarity < 1e-7);
      Evaluation e;
      p.evaluate(minimiser, e);
      CHECK(e.objective == Approx(p.minimum).epsilon(0).margin(3e-8));
    }
  }
}

TEST_CASE("the KKT residual is large at every start") {
  for (const KnownProblem& p : known_problems()) {
    CAPTURE(p.name);
    const Certificate c = certify(p, p.start);
    CHECK(std::max(c.kkt_residual, c.max_violation) > 0.1);
  }
}

TEST_CASE("the multipliers are those known in closed form") {
  CHECK(certify(bounded_rosenbrock(), vec({0.5, 0.25})).bound_multipliers[0] ==
        Approx(1.0).epsilon(1e-12));
  CHECK(certify(hs035(), hs035().minimisers[0]).multipliers[0] == Approx(2.0 / 9.0).epsilon(1e-12));
  CHECK(certify(ring(), ring().minimisers[0]).multipliers[0] ==
        Approx(0.25 * std::sqrt(2.0)).epsilon(1e-12));
}

TEST_CASE("a stationary point with a multiplier of the wrong sign is not certified") {
  // The greatest value on the ring: grad f = -lambda grad g needs lambda < 0 at the upper bound.
  const KnownProblem p = ring();
  CHECK(certify(p, vec({std::sqrt(2.0), std::sqrt(2.0)})).kkt_residual > 0.9);
  // At the inner circle the greatest value of -f is a minimum with a negative multiplier.
  const Certificate inner = certify(p, vec({std::sqrt(0.5), std::sqrt(0.5)}));
  CHECK(inner.kkt_residual < 1e-12);
  CHECK(inner.multipliers[0] == Approx(-std::sqrt(0.5)));
  CHECK(certify(p, vec({-std::sqrt(0.5), -std::sqrt(0.5)})).kkt_residual > 0.9);
  // The same for a bound of a variable: at the lower end of x1 the objective falls inwards.
  KnownProblem b = bounded_rosenbrock();
  b.l = vec({-1.0, -3.0});
  CHECK(certify(b, vec({-1.0, 1.0})).kkt_residual > 0.1);
}

TEST_CASE("an equation takes a multiplier of either sign") {
  KnownProblem p = ring();
  p.g_l = p.g_u;
  CHECK(certify(p, vec({std::sqrt(2.0), std::sqrt(2.0)})).multipliers[0] < 0.0);
  CHECK(certify(p, vec({std::sqrt(2.0), std::sqrt(2.0)})).kkt_residual < 1e-12);
  CHECK(certify(p, vec({-std::sqrt(2.0), -std::sqrt(2.0)})).kkt_residual < 1e-12);
}

TEST_CASE("the reduced Hessian tells a minimum from a maximum and a saddle") {
  const CertificateOptions second{.second_order = true};
  const auto curvature = [&](const KnownProblem& p, const Eigen::VectorXd& x) {
    return certify(p, x, second).reduced_hessian_min_eigenvalue;
  };
  // min x1 + x2 on |x|^2 = 2: Lagrangian Hessian 2 lambda E, lambda = 1/2 at (-1, -1), tangent
  // space of one direction.
  KnownProblem circle = ring();
  circle.g_l = circle.g_u = vec({2.0});
  circle.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x.sum();
    e.gradient << 1.0, 1.0;
    e.constraints << x.squaredNorm();
    e.jacobian << 2.0 * x.transpose();
  };
  circle.hessian = [](const Eigen::VectorXd&, double, const Eigen::VectorXd& multipliers,
                      Eigen::MatrixXd& H) {
    H = 2.0 * multipliers[0] * Eigen::MatrixXd::Identity(2, 2);
  };
  CHECK(curvature(circle, vec({-1.0, -1.0})).value() == Approx(1.0));
  CHECK(curvature(circle, vec({1.0, 1.0})).value() == Approx(-1.0));
  // f = x^2 - y^2: the saddle at zero has residual zero; with y held by a bound nothing is wrong.
  KnownProblem saddle = rosenbrock();
  saddle.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x[0] * x[0] - x[1] * x[1];
    e.gradient << 2.0 * x[0], -2.0 * x[1];
  };
  saddle.hessian = [](const Eigen::VectorXd&, double sigma, const Eigen::VectorXd&,
                      Eigen::MatrixXd& H) { H << 2.0 * sigma, 0.0, 0.0, -2.0 * sigma; };
  CHECK(certify(saddle, vec({0.0, 0.0})).kkt_residual == 0.0);
  CHECK(curvature(saddle, vec({0.0, 0.0})).value() == Approx(-2.0));
  CHECK(curvature(saddle, vec({0.0, 4.0})).value() == Approx(2.0));
  // No direction left, no Hessian, or not asked for: no number.
  CHECK_FALSE(curvature(saddle, vec({-3.0, 4.0})).has_value());
  CHECK_FALSE(curvature(hs048(), hs048().minimisers[0]).has_value());
  CHECK_FALSE(certify(circle, vec({-1.0, -1.0})).reduced_hessian_min_eigenvalue.has_value());
}

TEST_CASE("a redundant equation does not spoil the certificate") {
  KnownProblem p = hs048();
  p.g_l = p.g_u = vec({5.0, -3.0, 10.0});
  const KnownProblem::Model once = p.model;
  p.model = [once](const Eigen::VectorXd& x, Evaluation& e) {
    Evaluation two = e;
    two.constraints.resize(2);
    two.jacobian.resize(2, 5);
    once(x, two);
    e.objective = two.objective;
    e.gradient = two.gradient;
    e.constraints << two.constraints, 2.0 * two.constraints[0];
    e.jacobian << two.jacobian, 2.0 * two.jacobian.row(0);
  };
  CHECK(certify(p, p.minimisers[0]).kkt_residual < 1e-12);
}

TEST_CASE("an active limit that the equations decide takes no part in the certificate") {
  // Of 100 points that are no minima: what rounding leaves of the limit's gradient beside that of
  // the equation has a direction, and a large multiple of it would balance some of them.
  for (int i = 0; i < 100; ++i) {
    KnownProblem p;
    p.start = vec({0.1 * i, -0.03 * i, 1.0});
    p.l = Eigen::VectorXd::Constant(3, -kInfinity);
    p.u = -p.l;
    p.g_l = p.g_u = vec({0.0});
    const Eigen::VectorXd along = vec({1.0, 0.37, 1.0 / (3 + i)}), slope = vec({0.3, 1.0, -0.7});
    bool has_limit = false;
    p.model = [&](const Eigen::VectorXd& x, Evaluation& e) {
      const double off = along.dot(x - p.start);
      e.objective = slope.dot(x);
      e.gradient = slope;
      e.constraints[0] = off;
      e.jacobian.row(0) = along;
      if (!has_limit) return;
      e.constraints[1] = 2.7 * off;
      e.jacobian.row(1) = 2.7 * along;
    };
    const double alone = certify(p, p.start).kkt_residual;
    has_limit = true;
    p.g_l = vec({0.0, 0.0});
    p.g_u = vec({0.0, kInfinity});
    CHECK(certify(p, p.start).kkt_residual == Approx(alone));
  }
}

TEST_CASE("the objective scale decides which gradients are small") {
  struct Scaled final : Problem {
    double scale = 1.0;
    int num_variables() const override { return 1; }
    int num_constraints() const override { return 0; }
    Eigen::VectorXd constraint_lower() const override { return {}; }
    Eigen::VectorXd constraint_upper() const override { return {}; }
    double objective_scale() const override { return scale; }
    void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
      out.objective = 0.5 * x[0] * x[0];
      out.gradient = x;
      out.constraints.resize(0);
      out.jacobian.resize(0, 1);
    }
  } p;
  CHECK(certify(p, vec({1e-4})).kkt_residual == Approx(1e-4));
  p.scale = 1e-3;
  CHECK(certify(p, vec({1e-4})).kkt_residual == Approx(0.1));
}

TEST_CASE("the violation is flat at the nearest attempt alone") {
  const KnownProblem box = infeasible_inequality();
  CHECK(certify(box, vec({3.0, 3.0})).violation_slope == 0.0);
  CHECK(certify(box, vec({3.0, 2.0})).violation_slope > 0.5);
  CHECK(certify(box, vec({3.0, 3.0})).max_violation == Approx(4.0));
  // On the x1 axis the derivative of (x^2 - 1)^2 + (x - 2)^2 vanishes where 2 x^3 - x - 2 = 0.
  double x = 1.2;
  for (int i = 0; i < 20; ++i) x -= (2.0 * x * x * x - x - 2.0) / (6.0 * x * x - 1.0);
  CHECK(certify(infeasible_equations(), vec({x, 0.0})).violation_slope < 1e-14);
  CHECK(certify(infeasible_equations(), vec({x, 0.1})).violation_slope > 1e-3);
}

TEST_CASE("a point that is not finite has no certificate") {
  const KnownProblem p = hs035();
  Evaluation e;
  p.evaluate(p.start, e);
  e.gradient[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK(certify(p, p.start, e).kkt_residual == kInfinity);
  CHECK(certify(p, p.start, e).max_violation == 0.0);  // the values were finite
  e.constraints[0] = kInfinity;
  CHECK(certify(p, p.start, e).max_violation == kInfinity);
}

// The definition of the solution: y >= 0, slope <= 0, and y times slope zero.
TEST_CASE("non-negative least squares satisfies its optimality conditions on random systems") {
  std::srand(7);
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 1 + trial % 9, columns = 1 + (trial / 9) % 12;
    Eigen::MatrixXd A = Eigen::MatrixXd::Random(rows, columns);
    if (trial % 3 == 0 && columns > 1) A.col(columns - 1) = 2.0 * A.col(0);  // dependent
    if (trial % 5 == 0) A.col(0).setZero();
    const Eigen::VectorXd b = Eigen::VectorXd::Random(rows);
    const Eigen::VectorXd y = solve_nonnegative_least_squares(A, b);
    const Eigen::VectorXd slope = A.transpose() * (b - A * y);
    CAPTURE(trial, rows, columns);
    CHECK(y.minCoeff() >= 0.0);
    CHECK(slope.maxCoeff() < 1e-11);
    CHECK(slope.cwiseProduct(y).cwiseAbs().maxCoeff() < 1e-10);
  }
}

}  // namespace
}  // namespace stillbase::nlp
