// The contract of every optimizer in the registry, on problems and requests that misbehave.
#include <stillbase/nlp/optimizer.hpp>

#include <catch2/catch.hpp>
#include <stdexcept>

#include "nlp/known_problems.hpp"

namespace stillbase::nlp {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

struct ModelBroke : std::runtime_error {
  using std::runtime_error::runtime_error;
};

OptimizeOptions quick() {
  OptimizeOptions options;
  options.max_evaluations = 2000;
  return options;
}

// Calls `act` at evaluation number `count` (from 1) and later.
KnownProblem with_event(KnownProblem p, int count, std::function<void(Evaluation&)> act) {
  p.model = [inner = p.model, act, left = std::make_shared<int>(count)](const Eigen::VectorXd& x,
                                                                        Evaluation& e) {
    inner(x, e);
    if (--*left <= 0) act(e);
  };
  return p;
}

TEST_CASE("an exception of the model is rethrown with type and text") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (const int count : {1, 2, 5}) {
      for (const KnownProblem& base : {hs071(), rosenbrock()}) {
        CAPTURE(name, count, base.name);
        const KnownProblem p =
            with_event(base, count, [](Evaluation&) { throw ModelBroke("the arm fell off"); });
        std::string text;
        try {
          const OptimizeResult r = optimizer->minimize(p, p.start, quick());
          text = "returned " + std::string(to_string(r.status));
        } catch (const ModelBroke& error) {
          text = error.what();
        }
        CHECK(text == "the arm fell off");
      }
    }
  }
}

TEST_CASE("an exception of the Hessian is rethrown with type and text") {
  KnownProblem p = hs071();
  p.hessian = [](const Eigen::VectorXd&, double, const Eigen::VectorXd&, Eigen::MatrixXd&) {
    throw ModelBroke("no curvature");
  };
  CHECK_THROWS_WITH((void)make_optimizer("ipopt")->minimize(p, p.start), "no curvature");
  // The lock was given back.
  CHECK(make_optimizer("ipopt")->minimize(hs071(), hs071().start).status == Status::Optimal);
}

TEST_CASE("a Hessian with NaN fails without a crash") {
  KnownProblem p = hs071();
  p.hessian = [](const Eigen::VectorXd&, double, const Eigen::VectorXd&, Eigen::MatrixXd& H) {
    H.setConstant(kNan);
  };
  const OptimizeResult r = make_optimizer("ipopt")->minimize(p, p.start);
  CHECK(r.status != Status::Optimal);
  CHECK(r.x.allFinite());
}

TEST_CASE("a model that is nowhere finite fails and nothing looks like an answer") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (const KnownProblem& base : {hs071(), rosenbrock()}) {
      for (const int what : {0, 1, 2, 3}) {
        if (what > 1 && base.num_constraints() == 0) continue;
        CAPTURE(name, base.name, what);
        const KnownProblem p = with_event(base, 1, [what](Evaluation& e) {
          if (what == 0) e.objective = kNan;
          if (what == 1) e.objective = kInfinity;
          if (what == 2) e.constraints[0] = kNan;
          if (what == 3) e.constraints[1] = -kInfinity;
        });
        const OptimizeResult r = optimizer->minimize(p, p.start, quick());
        CHECK(r.status == Status::Failed);
        CHECK(r.stop == StopReason::NonFinite);
        CHECK_FALSE(r.feasible);
        CHECK(r.x == p.start);
        CHECK(r.rejected_evaluations == r.evaluations);
        CHECK(r.certificate.kkt_residual == kInfinity);
      }
    }
  }
}

TEST_CASE("a region where the model is not defined is avoided") {
  // min |x|^2 - log(x1 + x2 - 1); by symmetry x1 = x2 = (1 + sqrt 5) / 4.
  KnownProblem p;
  p.start = vec({2.0, 2.5});
  p.l = vec({-3.0, -3.0});
  p.u = vec({3.0, 3.0});
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    const double inside = x.sum() - 1.0;
    e.objective = x.squaredNorm() - std::log(inside);  // NaN below zero
    e.gradient = (2.0 * x.array() - 1.0 / inside).matrix();
  };
  const double t = 0.25 * (1.0 + std::sqrt(5.0));
  for (const bool constrained : {false, true}) {
    KnownProblem q = p;
    if (constrained) {  // a plane through the minimiser
      q.g_l = q.g_u = vec({0.0});
      q.model = [inner = p.model](const Eigen::VectorXd& x, Evaluation& e) {
        inner(x, e);
        e.constraints[0] = x[0] - x[1];
        e.jacobian << 1.0, -1.0;
      };
    }
    for (const std::string& name : optimizer_names()) {
      const auto optimizer = make_optimizer(name);
      CAPTURE(name, constrained);
      const OptimizeResult r = optimizer->minimize(q, q.start, quick());
      CAPTURE(to_string(r.status), to_string(r.stop), r.native_status, r.rejected_evaluations);
      CHECK(std::isfinite(r.objective));
      CHECK(r.x.sum() > 1.0);
      if (name == "sqp" || name == "nlopt-slsqp" || name == "ipopt" || name == "ipopt-lbfgs") {
        CHECK(r.status == Status::Optimal);
        CHECK((r.x - vec({t, t})).norm() < 1e-5);
      }
    }
  }
}

TEST_CASE("a model that breaks down later keeps the best point so far") {
  for (const std::string& name : optimizer_names()) {
    CAPTURE(name);
    const KnownProblem p = with_event(rosenbrock(), 8, [](Evaluation& e) { e.objective = kNan; });
    const OptimizeResult r = make_optimizer(name)->minimize(p, p.start, quick());
    CHECK(std::isfinite(r.objective));
    CHECK(r.feasible);
    CHECK(r.status != Status::Optimal);
  }
}

TEST_CASE("the flag of the caller ends a run at the next evaluation") {
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    for (const int count : {1, 2, 6}) {
      for (const KnownProblem& base : {hs071(), rosenbrock()}) {
        CAPTURE(name, count, base.name);
        std::atomic<bool> flag{false};
        const KnownProblem p = with_event(base, count, [&flag](Evaluation&) { flag = true; });
        OptimizeOptions options = quick();
        options.stop.interrupted = &flag;
        const OptimizeResult r = optimizer->minimize(p, p.start, options);
        CHECK(r.status == Status::Interrupted);
        CHECK(r.stop == StopReason::Interrupted);
        // One more for the derivatives at the best point of a solver without.
        CHECK(r.evaluations <= count + (optimizer->info().uses_gradient ? 0 : 1));
        CHECK(std::isfinite(r.objective));
      }
    }
  }
}

TEST_CASE("a deadline that has passed leaves one judged point") {
  for (const std::string& name : optimizer_names()) {
    CAPTURE(name);
    OptimizeOptions options;
    options.stop.deadline = StopCondition::Clock::now() - std::chrono::seconds(1);
    const KnownProblem p = rosenbrock();
    const OptimizeResult r = make_optimizer(name)->minimize(p, p.start, options);
    CHECK(r.status == Status::Limit);
    CHECK(r.stop == StopReason::Deadline);
    CHECK(r.evaluations == 1);
    CHECK(r.x == p.start);
    CHECK(r.feasible);
  }
}

TEST_CASE("a start outside the box is moved into it, aloud") {
  for (const std::string& name : optimizer_names()) {
    CAPTURE(name);
    const OptimizeResult r =
        make_optimizer(name)->minimize(rosenbrock(), vec({-30.0, 70.0}), quick());
    CHECK(r.feasible);
    CHECK(r.message.find("moved into the bounds") != std::string::npos);
  }
}

TEST_CASE("a fixed variable stays where it is") {
  KnownProblem p = hs035();
  p.l[2] = p.u[2] = 0.25;
  for (const std::string& name : optimizer_names()) {
    CAPTURE(name);
    const OptimizeResult r = make_optimizer(name)->minimize(p, p.start, quick());
    CHECK(r.x[2] == 0.25);
    if (name == "sqp" || name == "nlopt-slsqp" || name == "ipopt")
      CHECK(r.status == Status::Optimal);
  }
}

TEST_CASE("a local optimizer needs no bounds, a global one refuses to run without") {
  KnownProblem p = hs006();
  p.l.setConstant(-kInfinity);
  p.u.setConstant(kInfinity);
  for (const std::string& name : optimizer_names()) {
    const auto optimizer = make_optimizer(name);
    CAPTURE(name);
    const OptimizeResult r = optimizer->minimize(p, p.start);
    if (optimizer->info().global) {
      CHECK(r.status == Status::Failed);
      CHECK(r.stop == StopReason::Refused);
      CHECK(r.message.find("needs finite bounds; variable 0") != std::string::npos);
      CHECK(r.evaluations == 0);
    } else {
      CHECK(r.feasible);
      CHECK(p.distance_to_minimiser(r.x) < 1e-3);
    }
  }
}

TEST_CASE("more equations than variables end without a crash") {
  KnownProblem p = infeasible_equations();
  p.g_l = p.g_u = vec({1.0, 0.6, 0.8});  // consistent, but for one solution
  p.model = [](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x[0];
    e.gradient << 1.0, 0.0;
    e.constraints << x.squaredNorm(), x[0], x[1];
    e.jacobian << 2.0 * x[0], 2.0 * x[1], 1.0, 0.0, 0.0, 1.0;
  };
  for (const std::string& name : optimizer_names()) {
    CAPTURE(name);
    const OptimizeResult r = make_optimizer(name)->minimize(p, vec({0.1, 0.2}), quick());
    CAPTURE(to_string(r.status), r.native_status);
    CHECK(r.status != Status::Infeasible);
    CHECK(r.evaluations >= 1);
  }
}

TEST_CASE("a malformed request is refused with its reason") {
  const auto optimizer = make_optimizer("nlopt-slsqp");
  const auto refusal = [&](const KnownProblem& p, const Eigen::VectorXd& x0) {
    const OptimizeResult r = optimizer->minimize(p, x0);
    CHECK(r.stop == StopReason::Refused);
    CHECK(r.evaluations == 0);
    return std::string(to_string(r.status)) + ": " + r.message;
  };
  KnownProblem p = hs035();
  CHECK(refusal(p, vec({0.5, kNan, 0.5})) == "failed: the start is not finite");
  CHECK(refusal(p, vec({0.5})) == "failed: start and bounds must have one number per variable");
  p.g_u.resize(0);
  CHECK(refusal(p, hs035().start).find("failed: constraint bounds") == 0);
  p = hs035();
  p.l[1] = kNan;
  CHECK(refusal(p, p.start) == "failed: a bound is not a number");
  p = hs035();
  p.l[1] = 11.0;
  CHECK(refusal(p, p.start) == "infeasible: variable 1 has crossed bounds");
  p = hs035();
  p.g_l[0] = 4.0;
  CHECK(refusal(p, p.start) == "infeasible: constraint 0 has crossed bounds");
}

}  // namespace
}  // namespace stillbase::nlp
