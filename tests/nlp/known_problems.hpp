// Problems with known minimisers. HS: Hock and Schittkowski, Test Examples for Nonlinear
// Programming Codes, 1981, by number; the minimisers are theirs.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <stillbase/nlp/problem.hpp>
#include <string>
#include <vector>

namespace stillbase::nlp {

/// A problem written as one function, with what is known about it.
struct KnownProblem final : Problem {
  using Model = std::function<void(const Eigen::VectorXd&, Evaluation&)>;
  using Hessian =
      std::function<void(const Eigen::VectorXd&, double, const Eigen::VectorXd&, Eigen::MatrixXd&)>;

  std::string name;
  Eigen::VectorXd l, u, g_l, g_u, start;
  Model model;
  Hessian hessian;  // may be empty
  std::vector<Eigen::VectorXd> minimisers;
  double minimum = 0.0;

  int num_variables() const override { return static_cast<int>(start.size()); }
  int num_constraints() const override { return static_cast<int>(g_l.size()); }
  Eigen::VectorXd lower() const override { return l; }
  Eigen::VectorXd upper() const override { return u; }
  Eigen::VectorXd constraint_lower() const override { return g_l; }
  Eigen::VectorXd constraint_upper() const override { return g_u; }
  void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
    out.gradient.setZero(num_variables());
    out.constraints.setZero(num_constraints());
    out.jacobian.setZero(num_constraints(), num_variables());
    model(x, out);
  }
  bool has_hessian() const override { return static_cast<bool>(hessian); }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override {
    out.setZero(num_variables(), num_variables());
    hessian(x, sigma, multipliers, out);
  }

  double distance_to_minimiser(const Eigen::VectorXd& x) const {
    double distance = kInfinity;
    for (const Eigen::VectorXd& minimiser : minimisers) {
      distance = std::min(distance, (x - minimiser).lpNorm<Eigen::Infinity>());
    }
    return distance;
  }
};

inline Eigen::VectorXd vec(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

inline void rosenbrock_model(const Eigen::VectorXd& x, Evaluation& e) {
  const double a = x[1] - x[0] * x[0], b = 1.0 - x[0];
  e.objective = 100.0 * a * a + b * b;
  e.gradient << -400.0 * a * x[0] - 2.0 * b, 200.0 * a;
}

inline void rosenbrock_hessian(const Eigen::VectorXd& x, double sigma, const Eigen::VectorXd&,
                               Eigen::MatrixXd& H) {
  H << 1200.0 * x[0] * x[0] - 400.0 * x[1] + 2.0, -400.0 * x[0], -400.0 * x[0], 200.0;
  H *= sigma;
}

/// Bounds not active at (1, 1).
inline KnownProblem rosenbrock() {
  KnownProblem p;
  p.name = "Rosenbrock in a box";
  p.start = vec({-1.2, 1.0});
  p.l = vec({-3.0, -3.0});
  p.u = vec({2.0, 4.0});
  p.model = rosenbrock_model;
  p.hessian = rosenbrock_hessian;
  p.minimisers = {vec({1.0, 1.0})};
  return p;
}

/// x1 <= 0.5 cuts the minimum off: (0.5, 0.25), f = 0.25, multiplier of the bound 1.
inline KnownProblem bounded_rosenbrock() {
  KnownProblem p = rosenbrock();
  p.name = "Rosenbrock with an active bound";
  p.u[0] = 0.5;
  p.minimisers = {vec({0.5, 0.25})};
  p.minimum = 0.25;
  return p;
}

/// min (1 - x1)^2, 10 (x2 - x1^2) = 0.
inline KnownProblem hs006() {
  KnownProblem p;
  p.name = "HS006";
  p.start = vec({-1.2, 1.0});
  p.l = vec({-5.0, -5.0});
  p.u = vec({5.0, 5.0});
  p.g_l = p.g_u = vec({0.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = (1.0 - x[0]) * (1.0 - x[0]);
    e.gradient[0] = -2.0 * (1.0 - x[0]);
    e.constraints[0] = 10.0 * (x[1] - x[0] * x[0]);
    e.jacobian << -20.0 * x[0], 10.0;
  };
  p.hessian = [](const Eigen::VectorXd&, double sigma, const Eigen::VectorXd& lambda,
                 Eigen::MatrixXd& H) { H(0, 0) = 2.0 * sigma - 20.0 * lambda[0]; };
  p.minimisers = {vec({1.0, 1.0})};
  return p;
}

/// Convex quadratic, x >= 0, x1 + x2 + 2 x3 <= 3. Multiplier of the constraint 2/9.
inline KnownProblem hs035() {
  KnownProblem p;
  p.name = "HS035";
  p.start = vec({0.5, 0.5, 0.5});
  p.l = vec({0.0, 0.0, 0.0});
  p.u = vec({10.0, 10.0, 10.0});
  p.g_l = vec({-kInfinity});
  p.g_u = vec({3.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = 9.0 - 8.0 * x[0] - 6.0 * x[1] - 4.0 * x[2] + 2.0 * x[0] * x[0] +
                  2.0 * x[1] * x[1] + x[2] * x[2] + 2.0 * x[0] * x[1] + 2.0 * x[0] * x[2];
    e.gradient << -8.0 + 4.0 * x[0] + 2.0 * x[1] + 2.0 * x[2], -6.0 + 4.0 * x[1] + 2.0 * x[0],
        -4.0 + 2.0 * x[2] + 2.0 * x[0];
    e.constraints[0] = x[0] + x[1] + 2.0 * x[2];
    e.jacobian << 1.0, 1.0, 2.0;
  };
  p.hessian = [](const Eigen::VectorXd&, double sigma, const Eigen::VectorXd&, Eigen::MatrixXd& H) {
    H << 4.0, 2.0, 2.0, 2.0, 4.0, 0.0, 2.0, 0.0, 2.0;
    H *= sigma;
  };
  p.minimisers = {vec({4.0 / 3.0, 7.0 / 9.0, 4.0 / 9.0})};
  p.minimum = 1.0 / 9.0;
  return p;
}

/// min x1 x4 (x1 + x2 + x3) + x3, product >= 25, sum of squares = 40, 1 <= x <= 5.
inline KnownProblem hs071() {
  KnownProblem p;
  p.name = "HS071";
  p.start = vec({1.0, 5.0, 5.0, 1.0});
  p.l = Eigen::VectorXd::Constant(4, 1.0);
  p.u = Eigen::VectorXd::Constant(4, 5.0);
  p.g_l = vec({25.0, 40.0});
  p.g_u = vec({kInfinity, 40.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    const double s = x[0] + x[1] + x[2];
    e.objective = x[0] * x[3] * s + x[2];
    e.gradient << x[3] * (s + x[0]), x[0] * x[3], x[0] * x[3] + 1.0, x[0] * s;
    e.constraints << x[0] * x[1] * x[2] * x[3], x.squaredNorm();
    e.jacobian << x[1] * x[2] * x[3], x[0] * x[2] * x[3], x[0] * x[1] * x[3], x[0] * x[1] * x[2],
        2.0 * x[0], 2.0 * x[1], 2.0 * x[2], 2.0 * x[3];
  };
  p.hessian = [](const Eigen::VectorXd& x, double sigma, const Eigen::VectorXd& lambda,
                 Eigen::MatrixXd& H) {
    H(0, 0) = 2.0 * sigma * x[3];
    H(1, 0) = sigma * x[3] + lambda[0] * x[2] * x[3];
    H(2, 0) = sigma * x[3] + lambda[0] * x[1] * x[3];
    H(3, 0) = sigma * (2.0 * x[0] + x[1] + x[2]) + lambda[0] * x[1] * x[2];
    H(2, 1) = lambda[0] * x[0] * x[3];
    H(3, 1) = sigma * x[0] + lambda[0] * x[0] * x[2];
    H(3, 2) = sigma * x[0] + lambda[0] * x[0] * x[1];
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
    H.diagonal().array() += 2.0 * lambda[1];
  };
  p.minimisers = {vec({1.0, 4.742999637, 3.821149984, 1.379408291})};
  p.minimum = 17.0140172891;
  return p;
}

/// Convex quadratic of five variables under two linear equations; no Hessian given on purpose.
inline KnownProblem hs048() {
  KnownProblem p;
  p.name = "HS048";
  p.start = vec({3.0, 5.0, -3.0, 2.0, -2.0});
  p.l = Eigen::VectorXd::Constant(5, -10.0);
  p.u = Eigen::VectorXd::Constant(5, 10.0);
  p.g_l = p.g_u = vec({5.0, -3.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    const double a = x[0] - 1.0, b = x[1] - x[2], c = x[3] - x[4];
    e.objective = a * a + b * b + c * c;
    e.gradient << 2.0 * a, 2.0 * b, -2.0 * b, 2.0 * c, -2.0 * c;
    e.constraints << x.sum(), x[2] - 2.0 * (x[3] + x[4]);
    e.jacobian << 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, -2.0, -2.0;
  };
  p.minimisers = {Eigen::VectorXd::Ones(5)};
  return p;
}

/// min x1 + x2, 1 <= |x|^2 <= 4: a range with both bounds finite. Minimiser -(sqrt 2, sqrt 2),
/// multiplier 1 / (2 sqrt 2).
inline KnownProblem ring() {
  KnownProblem p;
  p.name = "linear objective on a ring";
  p.start = vec({1.0, -1.2});
  p.l = vec({-3.0, -3.0});
  p.u = vec({3.0, 3.0});
  p.g_l = vec({1.0});
  p.g_u = vec({4.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x.sum();
    e.gradient << 1.0, 1.0;
    e.constraints[0] = x.squaredNorm();
    e.jacobian << 2.0 * x[0], 2.0 * x[1];
  };
  p.hessian = [](const Eigen::VectorXd&, double, const Eigen::VectorXd& lambda,
                 Eigen::MatrixXd& H) { H.diagonal().setConstant(2.0 * lambda[0]); };
  p.minimisers = {vec({-std::sqrt(2.0), -std::sqrt(2.0)})};
  p.minimum = -2.0 * std::sqrt(2.0);
  return p;
}

inline std::vector<KnownProblem> known_problems() {
  return {rosenbrock(), bounded_rosenbrock(), hs006(), hs035(), hs048(), hs071(), ring()};
}

/// x on the unit circle and x1 = 2: the nearest attempt in the least-squares sense is on the x1
/// axis between the two.
inline KnownProblem infeasible_equations() {
  KnownProblem p;
  p.name = "a line that misses a circle";
  p.start = vec({0.6, 0.9});
  p.l = vec({-3.0, -3.0});
  p.u = vec({3.0, 3.0});
  p.g_l = p.g_u = vec({1.0, 2.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = (x[1] - 1.0) * (x[1] - 1.0);
    e.gradient << 0.0, 2.0 * (x[1] - 1.0);
    e.constraints << x.squaredNorm(), x[0];
    e.jacobian << 2.0 * x[0], 2.0 * x[1], 1.0, 0.0;
  };
  return p;
}

/// The same with an inequality, and the box in the way: x1 + x2 >= 10 in [-3, 3]^2.
inline KnownProblem infeasible_inequality() {
  KnownProblem p;
  p.name = "a half plane that misses the box";
  p.start = vec({0.5, -0.5});
  p.l = vec({-3.0, -3.0});
  p.u = vec({3.0, 3.0});
  p.g_l = vec({10.0});
  p.g_u = vec({kInfinity});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x.squaredNorm();
    e.gradient = 2.0 * x;
    e.constraints[0] = x.sum();
    e.jacobian << 1.0, 1.0;
  };
  return p;
}

}  // namespace stillbase::nlp
