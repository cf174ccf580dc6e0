// The judge alone, with solvers that visit a list of points and claim success.
#include <catch2/catch.hpp>

#include "nlp/known_problems.hpp"
#include "nlp/monitor.hpp"

namespace stillbase::nlp {
namespace {

class Scripted final : public Optimizer {
 public:
  Scripted(std::vector<Eigen::VectorXd> points, bool uses_gradient = true)
      : Optimizer({.name = "scripted", .about = "visits points", .uses_gradient = uses_gradient}),
        points_(std::move(points)) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd&,
                      const OptimizeOptions&) const override {
    for (const Eigen::VectorXd& x : points_) (void)monitor.evaluate(x.data());
    return {1, "SUCCESS", ""};
  }
  std::vector<Eigen::VectorXd> points_;
};

TEST_CASE("a claim of success at a violated point is not believed") {
  const KnownProblem p = infeasible_inequality();
  const OptimizeResult r = Scripted({vec({1.0, 1.0})}).minimize(p, p.start);
  CHECK(r.native_status == "SUCCESS");
  CHECK(r.status == Status::Infeasible);
  OptimizeOptions plain;
  plain.explain_infeasibility = false;
  const OptimizeResult s = Scripted({vec({1.0, 1.0})}).minimize(p, p.start, plain);
  CHECK(s.status == Status::Failed);
  CHECK(s.x == vec({1.0, 1.0}));
}

TEST_CASE("a claim of success at a feasible point that is not optimal is feasible only") {
  const KnownProblem p = hs035();
  const OptimizeResult r = Scripted({vec({1.0, 0.5, 0.5})}).minimize(p, p.start);
  CHECK(r.status == Status::Feasible);
  CHECK(r.x == vec({1.0, 0.5, 0.5}));
}

TEST_CASE("the best point is kept, not the last one") {
  const KnownProblem p = hs035();
  const Eigen::VectorXd minimiser = p.minimisers[0];
  for (const bool uses_gradient : {true, false}) {
    const OptimizeResult r =
        Scripted({minimiser, vec({0.0, 0.0, 0.0}), vec({3.0, 3.0, 3.0})}, uses_gradient)
            .minimize(p, p.start);
    CHECK(r.x == minimiser);
    CHECK(r.status == Status::Optimal);
  }
  // A violated point with a lower objective does not count once a feasible one is known.
  const KnownProblem q = ring();
  CHECK(Scripted({vec({-3.0, -3.0})}).minimize(q, q.start).x == q.start);
  // Before one is known the least violated point does.
  const OptimizeResult r = Scripted({vec({1.0, 1.0, 1.0, 1.0}), vec({1.0, 4.7, 3.8, 1.4})})
                               .minimize(hs071(), hs071().start, {.explain_infeasibility = false});
  CHECK(r.x == vec({1.0, 4.7, 3.8, 1.4}));
}

TEST_CASE(
    "an objective bought by a violation within the tolerance does not hide a certified point") {
  const KnownProblem p = ring();
  // 0.9e-9 outside the circle and 1e-5 beside the minimiser: lower, feasible, not stationary.
  const double radius = std::sqrt(4.0 + 0.9e-9), angle = -0.75 * std::acos(-1.0) + 1e-5;
  const Eigen::VectorXd cheat = vec({radius * std::cos(angle), radius * std::sin(angle)});
  const Eigen::VectorXd minimiser = vec({-std::sqrt(2.0), -std::sqrt(2.0)});
  REQUIRE(cheat.sum() < minimiser.sum());
  const OptimizeResult alone = Scripted({cheat}).minimize(p, p.start);
  CHECK(alone.x == cheat);
  CHECK(alone.status == Status::Feasible);
  for (const auto& points : {std::vector<Eigen::VectorXd>{cheat, minimiser}, {minimiser, cheat}}) {
    const OptimizeResult r = Scripted(points).minimize(p, p.start);
    CHECK(r.x == minimiser);
    CHECK(r.status == Status::Optimal);
  }
}

TEST_CASE(
    "from a violated point of a solver the judge continues to a feasible one, with a message") {
  const KnownProblem p = hs071();
  const OptimizeResult r = Scripted({}).minimize(p, p.start);
  CHECK(r.status == Status::Feasible);
  CHECK(r.feasible);
  CHECK(r.message.find("minimising the violation") != std::string::npos);
  CHECK(r.evaluations > 1);
  const OptimizeResult again = make_optimizer("nlopt-slsqp")->minimize(p, r.x);
  CHECK(again.status == Status::Optimal);
}

TEST_CASE("a solver is stopped at a point that is certain to be a minimum, and nowhere before") {
  const KnownProblem p = hs035();
  const Eigen::VectorXd minimiser = p.minimisers[0], far = vec({0.0, 0.0, 0.0});
  const Eigen::VectorXd near = minimiser - vec({1e-8, 1e-8, 1e-8});  // residual within tolerances
  const Scripted solver({near, minimiser, far, near});
  const OptimizeResult r = solver.minimize(p, p.start);
  CHECK(r.stop == StopReason::Certified);
  CHECK(r.evaluations == 3);
  CHECK(r.x == minimiser);
  CHECK(r.status == Status::Optimal);
  CHECK(r.certificate.kkt_residual == certify(p, minimiser).kkt_residual);
  // Whoever wants the library as it is, or has no gradients, gets all of its points.
  const OptimizeResult plain = solver.minimize(p, p.start, {.library_defaults = true});
  CHECK(plain.stop == StopReason::SolverEnded);
  CHECK(plain.evaluations == 4);
  CHECK(Scripted({near, minimiser, far}, false).minimize(p, p.start).stop ==
        StopReason::SolverEnded);
  // A stationary point that is worse than what is known already is no end.
  const KnownProblem q = ring();
  const double r2 = std::sqrt(2.0);
  const Eigen::VectorXd best = vec({-r2, -r2}), worst = vec({r2, r2});
  const OptimizeResult s =
      Scripted({best, vec({r2 - 1e-9, r2}), worst, vec({0.0, 0.0})}).minimize(q, q.start);
  CHECK(s.evaluations == 5);
  CHECK(s.x == best);
}

TEST_CASE("a caller ends a solve at the first point that it has waited for") {
  const KnownProblem p = hs035();
  const Eigen::VectorXd far = vec({0.0, 0.0, 0.0}), low = vec({1.3, 0.7, 0.4});
  const auto value = [&](const Eigen::VectorXd& x) {
    Evaluation at_x;
    p.evaluate(x, at_x);
    return at_x.objective;
  };
  REQUIRE(value(low) < value(p.start));
  REQUIRE(value(low) < value(far));
  OptimizeOptions options;
  options.ends_at = [&](const Eigen::VectorXd& x, const Evaluation& at_x) {
    CHECK(at_x.objective == value(x));
    return at_x.objective <= value(low);
  };
  const OptimizeResult r = Scripted({far, low, far}).minimize(p, p.start, options);
  CHECK(r.stop == StopReason::Asked);
  CHECK(r.evaluations == 3);
  CHECK(r.x == low);
  const OptimizeResult at_start = Scripted({far}).minimize(p, low, options);
  CHECK(at_start.stop == StopReason::Asked);
  CHECK(at_start.evaluations == 1);
  CHECK(at_start.x == low);
}

/// Asks for the start, then solves the other problem from there, and asks for it again.
class Nested final : public Optimizer {
 public:
  explicit Nested(const Problem& other)
      : Optimizer({.name = "nested", .about = "a solve within a solve"}), other_(other) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions&) const override {
    const double before = monitor.evaluate(start.data())->objective;
    const OptimizeResult inner = Scripted({}).minimize(other_, start);
    const double after = monitor.evaluate(start.data())->objective;
    return {0, after == before && inner.objective != before ? "kept" : "mixed up", ""};
  }
  const Problem& other_;
};

TEST_CASE("a solve knows nothing of the points of another one on its thread") {
  const KnownProblem p = hs035();
  KnownProblem q = p;
  q.model = [&p](const Eigen::VectorXd& x, Evaluation& out) {
    p.model(x, out);
    out.objective += 1;
  };
  const Scripted visit({p.minimisers[0]});
  const OptimizeResult first = visit.minimize(p, p.start), second = visit.minimize(q, p.start);
  CHECK(second.objective == first.objective + 1);
  CHECK(second.evaluations == first.evaluations);
  CHECK(Nested(q).minimize(p, p.start).native_status == "kept");
}

TEST_CASE("copies of an evaluation leave the workspace where it is") {
  Evaluation first, second;
  first.workspace.as<int>() = 3;
  second.workspace.as<int>() = 4;
  second = first;
  const Evaluation copy = first;
  CHECK(second.workspace.as<int>() == 4);
  CHECK(first.workspace.as<int>() == 3);
  CHECK(Evaluation(copy).workspace.as<int>() == 0);  // one of its own
  CHECK(first.workspace.as<double>() == 0);          // a fresh one of another type
}

TEST_CASE("a solver that evaluates one point for ever is stopped") {
  const KnownProblem p = rosenbrock();
  const OptimizeResult r =
      Scripted(std::vector<Eigen::VectorXd>(5000, vec({0.0, 0.0}))).minimize(p, p.start);
  CHECK(r.stop == StopReason::Stalled);
  CHECK(r.evaluations == 2);
  CHECK(r.status == Status::Feasible);
}

}  // namespace
}  // namespace stillbase::nlp
