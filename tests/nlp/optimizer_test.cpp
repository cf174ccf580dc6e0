// The contract of every optimizer in the registry, on problems that behave.
#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "nlp/known_problems.hpp"

namespace stillbase::nlp {
namespace {

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
}

// Those that promise a KKT point of any smooth problem.
bool is_precise(const std::string& name) {
  return is_one_of(name, {"sqp", "nlopt-slsqp", "nlopt-auglag-lbfgs", "ipopt", "ipopt-lbfgs"});
}

// Global ones go on to their budget: keep it small.
OptimizeOptions quick(const Optimizer& optimizer) {
  OptimizeOptions options;
  if (optimizer.info().global) options.max_evaluations = 5000;
  return options;
}

// What a result says must follow from one look at its point.
void check_honest(const KnownProblem& p, const OptimizeResult& r, const OptimizeOptions& options) {
  Evaluation e;
  p.evaluate(r.x, e);
  CHECK(r.objective == e.objective);
  CHECK(r.constraints == e.constraints);
  const double violation = signed_violation(e.constraints, p.g_l, p.g_u).lpNorm<Eigen::Infinity>();
  CHECK(r.certificate.max_violation == violation);
  CHECK((r.x.array() >= p.l.array()).all());
  CHECK((r.x.array() <= p.u.array()).all());
  CHECK(r.feasible == (violation <= options.feasibility_tolerance));
  if (r.status == Status::Optimal || r.status == Status::Feasible) CHECK(r.feasible);
  if (r.status == Status::Infeasible || r.status == Status::Failed) CHECK_FALSE(r.feasible);
  if (r.status == Status::Optimal) {
    CHECK(certify(p, r.x).kkt_residual <= options.optimality_tolerance);
  }
}

TEST_CASE("every optimizer is honest about every known problem, and the local ones solve it") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (const KnownProblem& p : known_problems()) {
      CAPTURE(name, p.name);
      const OptimizeOptions options = quick(*optimizer);
      const OptimizeResult r = optimizer->minimize(p, p.start, options);
      CAPTURE(to_string(r.status), to_string(r.stop), r.native_status, r.evaluations);
      CHECK(r.optimizer == name);
      CHECK_FALSE(r.native_status.empty());
      check_honest(p, r, options);
      if (is_precise(name)) {
        CHECK(r.status == Status::Optimal);
        CHECK(p.distance_to_minimiser(r.x) < 1e-6);
        CHECK(r.objective == Approx(p.minimum).epsilon(0).margin(1e-8));
      } else if (!optimizer->info().global) {
        CHECK(r.feasible);
        CHECK(r.objective == Approx(p.minimum).epsilon(0).margin(1e-6));
        CHECK(p.distance_to_minimiser(r.x) < 1e-3);
      } else if (p.num_constraints() == 0 && !is_one_of(name, {"nlopt-esch", "random-search"})) {
        CHECK(r.objective < p.minimum + 0.01);  // those two have no local refinement at all
      }
    }
  }
}

TEST_CASE("global optimizers find the lowest of many minima where a local one stays") {
  // f = x^2 / 40 - cos x per variable: minima near every multiple of 2 pi.
  KnownProblem p;
  p.name = "waves";
  p.start = vec({12.0, -12.5});
  p.l = vec({-20.0, -20.0});
  p.u = vec({21.0, 22.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x.squaredNorm() / 40.0 - x.array().cos().sum();
    e.gradient = x / 20.0 + Eigen::VectorXd(x.array().sin());
  };
  CHECK(make_optimizer("nlopt-slsqp")->minimize(p, p.start).objective > -1.0);
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    if (!optimizer->info().global) continue;
    CAPTURE(name);
    CHECK(optimizer->minimize(p, p.start, quick(*optimizer)).objective < -1.9);
  }
}

TEST_CASE("an infeasible problem is reported as infeasible with the nearest attempt") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    const OptimizeOptions options = quick(*optimizer);
    for (const KnownProblem& p : {infeasible_equations(), infeasible_inequality()}) {
      CAPTURE(name, p.name);
      const OptimizeResult r = optimizer->minimize(p, p.start, options);
      CAPTURE(to_string(r.stop), r.native_status, r.certificate.violation_slope);
      CHECK(r.status == Status::Infeasible);
      CHECK(r.certificate.violation_slope <= 1e-3);
      check_honest(p, r, options);
    }
    const OptimizeResult r =
        optimizer->minimize(infeasible_inequality(), infeasible_inequality().start, options);
    CHECK((r.x - vec({3.0, 3.0})).norm() < 0.02);
  }
}

TEST_CASE("the model is evaluated once per point and never outside the box") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (KnownProblem p : {hs071(), hs006(), bounded_rosenbrock()}) {
      CAPTURE(name, p.name);
      std::vector<std::vector<double>> points;
      const KnownProblem::Model inner = p.model;
      p.model = [&](const Eigen::VectorXd& x, Evaluation& e) {
        points.emplace_back(x.begin(), x.end());
        inner(x, e);
      };
      const OptimizeOptions options = quick(*optimizer);
      const OptimizeResult r = optimizer->minimize(p, p.start, options);
      const std::set<std::vector<double>> distinct(points.begin(), points.end());
      CHECK(r.evaluations == static_cast<int>(points.size()));
      CHECK(r.evaluations <= options.max_evaluations);
      for (std::size_t i = 1; i < points.size(); ++i) {
        if (optimizer->info().uses_gradient) REQUIRE(points[i] != points[i - 1]);
      }
      // A second evaluation only for the derivatives at the answer of a solver without.
      if (is_precise(name)) CHECK(distinct.size() == points.size());
      for (const std::vector<double>& x : distinct) {
        for (std::size_t j = 0; j < x.size(); ++j) {
          REQUIRE(x[j] >= p.l[static_cast<Eigen::Index>(j)]);
          REQUIRE(x[j] <= p.u[static_cast<Eigen::Index>(j)]);
        }
      }
    }
  }
}

TEST_CASE("a solver without derivatives evaluates them once, at its answer") {
  struct Counting final : Problem {
    KnownProblem inner = hs035();
    mutable int full = 0, values = 0;
    int num_variables() const override { return inner.num_variables(); }
    int num_constraints() const override { return inner.num_constraints(); }
    Eigen::VectorXd lower() const override { return inner.lower(); }
    Eigen::VectorXd upper() const override { return inner.upper(); }
    Eigen::VectorXd constraint_lower() const override { return inner.g_l; }
    Eigen::VectorXd constraint_upper() const override { return inner.g_u; }
    void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
      ++full;
      inner.evaluate(x, out);
    }
    void evaluate_value(const Eigen::VectorXd& x, Evaluation& out) const override {
      ++values;
      inner.evaluate(x, out);
    }
  } p;
  const OptimizeResult r = make_optimizer("nlopt-cobyla")->minimize(p, p.inner.start);
  CHECK(r.feasible);
  CHECK(p.full == 2);  // the start, and the answer
  CHECK(r.gradient_evaluations == p.full);
  CHECK(r.evaluations == p.full + p.values);
}

TEST_CASE("the evaluation budget is respected") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (const int budget : {1, 2, 5, 23}) {
      for (const KnownProblem& p : {rosenbrock(), hs071(), infeasible_equations()}) {
        CAPTURE(name, budget, p.name);
        OptimizeOptions options;
        options.max_evaluations = budget;
        const OptimizeResult r = optimizer->minimize(p, p.start, options);
        CHECK(r.evaluations <= budget);
        CHECK(r.evaluations >= 1);
        if (r.stop == StopReason::EvaluationLimit) CHECK(r.status != Status::Feasible);
        check_honest(p, r, options);
      }
    }
    OptimizeOptions options;
    options.max_evaluations = 2;
    CHECK(optimizer->minimize(rosenbrock(), rosenbrock().start, options).status == Status::Limit);
  }
}

bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(),
                                       static_cast<std::size_t>(a.size()) * sizeof(double)) == 0);
}

TEST_CASE("the same request gives the same bytes") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    const KnownProblem p = hs071();
    CAPTURE(name);
    OptimizeOptions options = quick(*optimizer);
    options.seed = 5;
    const OptimizeResult first = optimizer->minimize(p, p.start, options);
    OptimizeOptions other = options;
    other.seed = 6;
    const OptimizeResult different = optimizer->minimize(p, p.start, other);
    const OptimizeResult second = make_optimizer(name)->minimize(p, p.start, options);
    CHECK(same_bytes(first.x, second.x));
    CHECK(same_bytes(first.certificate.multipliers, second.certificate.multipliers));
    CHECK(first.objective == second.objective);
    CHECK(first.evaluations == second.evaluations);
    CHECK(first.message == second.message);
    if (!optimizer->info().stochastic) CHECK(same_bytes(first.x, different.x));
    // Population methods draw from the seed; the linkage method may reach the same minimum.
    if (is_one_of(name, {"nlopt-crs2", "nlopt-isres", "nlopt-esch", "random-search"})) {
      CHECK_FALSE(same_bytes(first.x, different.x));
    }
  }
}

TEST_CASE("optimizers may run in several threads at once") {
  for (const std::string name : {"sqp", "nlopt-slsqp", "nlopt-isres", "ipopt"}) {
    const auto optimizer = make_optimizer(name);
    OptimizeOptions options;
    options.max_evaluations = 1000;
    const OptimizeResult alone = optimizer->minimize(hs071(), hs071().start, options);
    std::vector<OptimizeResult> results(4);
    {
      std::vector<std::jthread> threads;
      for (OptimizeResult& result : results) {
        threads.emplace_back([&] {
          for (int i = 0; i < 5; ++i) {
            result = optimizer->minimize(hs071(), hs071().start, options);
          }
        });
      }
    }
    for (const OptimizeResult& result : results) {
      CAPTURE(name);
      CHECK(same_bytes(result.x, alone.x));
      CHECK(result.evaluations == alone.evaluations);
    }
  }
}

TEST_CASE("ipopt uses the exact Hessian where there is one and says when there is none") {
  const OptimizeResult exact = make_optimizer("ipopt")->minimize(hs071(), hs071().start);
  CHECK(exact.hessian_evaluations > 0);
  CHECK(exact.message.empty());
  const OptimizeResult none = make_optimizer("ipopt")->minimize(hs048(), hs048().start);
  CHECK(none.hessian_evaluations == 0);
  CHECK(none.message.find("no exact Hessian") != std::string::npos);
  const OptimizeResult lbfgs = make_optimizer("ipopt-lbfgs")->minimize(hs071(), hs071().start);
  CHECK(lbfgs.hessian_evaluations == 0);
  CHECK(lbfgs.message.empty());
}

namespace {

/// The point of a polytope about the origin that is nearest to another one: n_k' x <= 1 for k
/// walls. It gives walls cut where it may, and remembers what it was asked.
class NearestInPolytope final : public Problem {
 public:
  NearestInPolytope(const Eigen::MatrixXd& normals, const Eigen::VectorXd& wanted)
      : normals_(normals), wanted_(wanted) {}

  int num_variables() const override { return static_cast<int>(wanted_.size()); }
  int num_constraints() const override { return static_cast<int>(normals_.rows()); }
  Eigen::VectorXd constraint_lower() const override {
    return Eigen::VectorXd::Constant(normals_.rows(), -kInfinity);
  }
  Eigen::VectorXd constraint_upper() const override {
    return Eigen::VectorXd::Ones(normals_.rows());
  }
  void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
    out.objective = (x - wanted_).squaredNorm() / 2;
    out.gradient = x - wanted_;
    out.constraints = normals_ * x;
    out.jacobian = normals_;
    nearest = std::min(nearest, out.far);
    for (Eigen::Index i = 0; i < out.constraints.size(); ++i) {
      if (!(1 - out.constraints[i] > out.far)) continue;
      out.constraints[i] = 1 - out.far;
      out.jacobian.row(i).setZero();
      ++cut;
    }
  }

  mutable double nearest = kInfinity;
  mutable int cut = 0;

 private:
  Eigen::MatrixXd normals_;
  Eigen::VectorXd wanted_;
};

}  // namespace

TEST_CASE("inequalities that hold by far may be left out for sqp, and are for no other") {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::MatrixXd normals(30, 4);
    for (double& entry : normals.reshaped()) entry = random.uniform(-1, 1);
    normals.rowwise().normalize();
    Eigen::VectorXd wanted(4);
    for (double& entry : wanted) entry = random.uniform(-4, 4);
    const NearestInPolytope problem(normals, wanted);
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(4);
    for (const char* name : {"nlopt-slsqp", "ipopt", "sqp"}) {
      CAPTURE(trial, name);
      OptimizeOptions options;
      const OptimizeResult whole = make_optimizer(name)->minimize(problem, start, options);
      REQUIRE(whole.status == Status::Optimal);
      CHECK(problem.nearest == kInfinity);
      options.far = 0.3;
      const OptimizeResult near = make_optimizer(name)->minimize(problem, start, options);
      CHECK(near.status == Status::Optimal);
      CHECK((near.x - whole.x).norm() < 1e-6);
      CHECK(near.certificate.max_violation <= options.feasibility_tolerance);
      CHECK(problem.nearest == (name == std::string("sqp") ? 0.3 : kInfinity));
      for (const double far : {-0.1, std::nan("")}) {
        options.far = far;
        CHECK_THROWS_AS(make_optimizer(name)->minimize(problem, start, options),
                        std::invalid_argument);
      }
    }
    CHECK(problem.cut > 10);
  }
}

TEST_CASE("the Hessians of the known problems agree with differences of their gradients") {
  for (const KnownProblem& p : known_problems()) {
    if (!p.has_hessian()) continue;
    CAPTURE(p.name);
    const Eigen::VectorXd lambda = Eigen::VectorXd::LinSpaced(p.num_constraints(), 0.7, -1.3);
    const auto slope = [&](const Eigen::VectorXd& x) {
      Evaluation e;
      p.evaluate(x, e);
      return Eigen::VectorXd(1.5 * e.gradient + e.jacobian.transpose() * lambda);
    };
    Eigen::MatrixXd H;
    p.lagrangian_hessian(p.start, 1.5, lambda, H);
    for (int j = 0; j < p.num_variables(); ++j) {
      const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(p.num_variables(), j);
      const Eigen::VectorXd column = (slope(p.start + step) - slope(p.start - step)) / 2e-5;
      CHECK((H.col(j) - column).norm() < 1e-6 * (1.0 + column.norm()));
    }
  }
}

TEST_CASE("the registry has its names and no others") {
  const std::vector<std::string> names = optimizer_names();
  CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
  for (const char* name :
       {"sqp", "nlopt-slsqp", "nlopt-auglag-lbfgs", "nlopt-auglag-mma", "nlopt-ccsaq",
        "nlopt-cobyla", "nlopt-bobyqa", "nlopt-crs2", "nlopt-isres", "nlopt-esch", "nlopt-direct-l",
        "nlopt-mlsl", "ipopt", "ipopt-lbfgs", "gradient-projection", "random-search"}) {
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  }
  for (const std::string& name : names) CHECK(make_optimizer(name)->info().name == name);
  CHECK(make_optimizer("simplex") == nullptr);
  CHECK(make_optimizer("") == nullptr);
}

}  // namespace
}  // namespace stillbase::nlp
