// Minima at kinks of constraints.
#include <catch2/catch.hpp>

#include <functional>

#include "search/kink.hpp"
#include "search/local_solves.hpp"
#include "search/start_postures.hpp"
#include "support/shipped_problem.hpp"

#include <stillbase/search/search.hpp>

namespace stillbase {
namespace {

/// A linear objective over x with one constraint >= 0, in a box.
struct OneConstraint final : nlp::Problem {
  Eigen::Vector2d slope;
  std::function<double(const Eigen::Vector2d&)> value;
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> gradient;

  int num_variables() const override { return 2; }
  int num_constraints() const override { return 1; }
  Eigen::VectorXd lower() const override { return Eigen::Vector2d(-2, -2); }
  Eigen::VectorXd upper() const override { return Eigen::Vector2d(2, 2); }
  Eigen::VectorXd constraint_lower() const override { return Eigen::VectorXd::Zero(1); }
  Eigen::VectorXd constraint_upper() const override {
    return Eigen::VectorXd::Constant(1, kInfinity);
  }
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    out.objective = slope.dot(x);
    out.gradient = slope;
    out.constraints = Eigen::VectorXd::Constant(1, value(x));
    out.jacobian = gradient(x).transpose();
  }
};

/// x_2 >= |x_1|: the least of two values.
OneConstraint wedge(const Eigen::Vector2d& slope) {
  OneConstraint out;
  out.slope = slope;
  out.value = [](const Eigen::Vector2d& x) { return x[1] - std::abs(x[0]); };
  out.gradient = [](const Eigen::Vector2d& x) { return Eigen::Vector2d(x[0] < 0 ? 1 : -1, 1); };
  return out;
}

}  // namespace

TEST_CASE("a kink is a minimum where the gradients of both sides balance the objective's") {
  const Eigen::Vector2d tip(0, 0);
  for (const double along : {-0.9, 0.0, 0.9}) {
    const OneConstraint problem = wedge({along, 1});
    CHECK(nlp::certify(problem, tip).kkt_residual > 0.01);
    CHECK(is_stationary(problem, tip));
    // Solvers stop a short way before it.
    for (const double off : {-1e-8, 1e-8}) {
      CHECK(is_stationary(problem, tip + Eigen::Vector2d(off, 1e-8)));
    }
  }
  for (const double along : {-1.1, 1.1}) CHECK_FALSE(is_stationary(wedge({along, 1}), tip));
  CHECK_FALSE(is_stationary(wedge({0, -1}), tip));
}

TEST_CASE("where no kink is, a point is stationary by its KKT residual alone") {
  CHECK(is_stationary(wedge({1, 1}), Eigen::Vector2d(-1, 1)));
  CHECK_FALSE(is_stationary(wedge({0, 1}), Eigen::Vector2d(-1, 1)));
  CHECK_FALSE(is_stationary(wedge({0, 1}), Eigen::Vector2d(0, 0.5)));
  CHECK(is_stationary(wedge({0, -1}), Eigen::Vector2d(0, 2)));
}

TEST_CASE("the largest of two values has no minimum at its kink") {
  OneConstraint problem = wedge({0, 1});  // x_2 >= -|x_1|
  problem.value = [](const Eigen::Vector2d& x) { return x[1] + std::abs(x[0]); };
  problem.gradient = [](const Eigen::Vector2d& x) { return Eigen::Vector2d(x[0] < 0 ? -1 : 1, 1); };
  CHECK_FALSE(is_stationary(problem, Eigen::Vector2d(0, 0)));
}

TEST_CASE("a search does not go on from minima at kinks of the clearance") {
  const CaptureProblem problem = test::without_path("deos_latch");
  const Formulation formulation(problem);
  int kinks = 0, said = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    SearchOptions options;
    options.seed = seed;
    const LocalSolves solves(problem, formulation, options);
    const StartPostures postures(problem, formulation, options, false, 1);
    for (int start = 0; start < 16; ++start) {
      CAPTURE(start);
      const Eigen::VectorXd from = postures.of(start).x;
      LocalSolves::Calls calls;
      const Solution found = solves.solve(from, start, calls);
      if (found.violation > 1e-9) continue;
      if (found.at_kink) {
        ++said;
        CHECK_FALSE(solves.stopped_short(found));
        Solution elsewhere = found;
        elsewhere.at_kink = false;
        CHECK(solves.stopped_short(elsewhere) == !is_stationary(formulation, found.x));
      }
      // By its residual alone a search would go on from there.
      if (nlp::certify(formulation, found.x).kkt_residual <= 1e-6) continue;
      if (!is_stationary(formulation, found.x)) continue;
      ++kinks;
      CHECK_FALSE(solves.stopped_short(found));
      LocalSolves::Calls all;
      solves.minimum(from, start, all);
      CHECK(all.count("ipopt") == 0);
    }
  }
  CHECK(kinks > 0);
  CHECK(said > 0);
}

}  // namespace stillbase
