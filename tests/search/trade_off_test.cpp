#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/trade_off.hpp>

#include "formulation/projection.hpp"
#include "support/capture_problems.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {

TEST_CASE("a front holds no point that another one beats, and both extremes") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  TradeOffOptions options;
  options.starts = 24;
  options.levels = 12;
  const TradeOff front = trade_off(problem, ObjectiveQuantity::BaseAngularMomentum,
                                   ObjectiveQuantity::JointRateNorm, options);
  REQUIRE(front.points.size() >= 8);
  CHECK_FALSE(front.stopped);
  for (std::size_t i = 0; i < front.points.size(); ++i) {
    const TradeOffPoint& point = front.points[i];
    CHECK(point.max_violation <= 1e-9);
    if (i == 0) continue;
    CHECK(point.first > front.points[i - 1].first);
    CHECK(point.second < front.points[i - 1].second);
  }

  // Against every posture of the arm that holds the hand's point, sampled densely: no posture lies
  // below the front by more than the distance of its points explains.
  CaptureProblem of_first = problem, of_second = problem;
  of_first.measure = of_second.measure = {};
  of_first.objective = {{ObjectiveQuantity::BaseAngularMomentum}};
  of_second.objective = {{ObjectiveQuantity::JointRateNorm}};
  const Formulation first(of_first), second(of_second);
  double least_first = kInfinity, least_second = kInfinity;
  for (int i = 0; i < 4000; ++i) {
    const ProjectionResult on = project_onto_constraints(
        first, first.start_point(low_discrepancy_point(i, first.num_variables(), 5)), false, 30);
    if (!(on.violation < 1e-10)) continue;
    const Configuration at = first.configuration(on.x);
    const double a = nominal_value(of_first, first, at), b = nominal_value(of_second, second, at);
    least_first = std::min(least_first, a);
    least_second = std::min(least_second, b);
    // The front's value at a: of the last point whose first quantity is at most a.
    double reachable = kInfinity;
    for (const TradeOffPoint& point : front.points) {
      if (point.first <= a) reachable = point.second;
    }
    if (a >= front.points[1].first) {
      // Levels are steps: the point of the next lower level is at most one step worse.
      double next = front.points.back().second;
      for (const TradeOffPoint& point : front.points) {
        if (point.first > a) {
          next = point.second;
          break;
        }
      }
      INFO("first " << a << ", joints " << at.phi.transpose());
      CHECK(b >= next * (1 - 1e-6));
      CHECK(next <= reachable);
    }
  }
  CHECK(front.points.front().first <= least_first * (1 + 1e-9));
  CHECK(front.points.back().second <= least_second * (1 + 1e-9));
}

TEST_CASE("of many postures with the least of one quantity, an end has the least of the other") {
  // Two joints, free: the base takes no momentum along whole curves of postures.
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::None;
  TradeOffOptions options;
  options.starts = 16;
  options.levels = 6;
  const TradeOff front = trade_off(problem, ObjectiveQuantity::BaseAngularMomentum,
                                   ObjectiveQuantity::JointRateNorm, options);
  const TradeOff turned = trade_off(problem, ObjectiveQuantity::JointRateNorm,
                                    ObjectiveQuantity::BaseAngularMomentum, options);
  REQUIRE(front.points.size() > 1);
  REQUIRE(turned.points.size() > 1);

  problem.measure = {};
  CaptureProblem of_second = problem;
  problem.objective = {{ObjectiveQuantity::BaseAngularMomentum}};
  of_second.objective = {{ObjectiveQuantity::JointRateNorm}};
  const Formulation first(problem), second(of_second);
  const double most = front.points.back().first;
  CHECK(front.points.front().first <= 1e-5 * most);
  CHECK(turned.points.back().second <= 1e-5 * most);
  // The least joint rates among the postures near the curves, of many anywhere.
  double least = kInfinity;
  for (int i = 0; i < 60000; ++i) {
    const Eigen::VectorXd x = first.start_point(low_discrepancy_point(i, first.num_variables(), 5));
    const Configuration at = first.configuration(x);
    if (!(nominal_value(problem, first, at) < 5e-3 * most)) continue;
    bool feasible = true;
    for (const ConstraintValue& value : first.report(x)) {
      feasible = feasible && value.violation <= 1e-9;
    }
    if (feasible) least = std::min(least, nominal_value(of_second, second, at));
  }
  REQUIRE(least < kInfinity);
  CHECK(front.points.front().second < 1.02 * least);
  CHECK(turned.points.back().first < 1.02 * least);
}

TEST_CASE("a trade-off of a quantity with itself makes no sense") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  CHECK_THROWS_AS(
      trade_off(problem, ObjectiveQuantity::JointRateNorm, ObjectiveQuantity::JointRateNorm, {}),
      std::invalid_argument);
}

TEST_CASE("a stopped trade-off says so") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  TradeOffOptions options;
  options.stop.deadline = std::chrono::steady_clock::now();
  CHECK(trade_off(problem, ObjectiveQuantity::BaseAngularMomentum, ObjectiveQuantity::JointRateNorm,
                  options)
            .stopped);
}

TEST_CASE("a front with a simulated quantity ends with what is known when it is stopped") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 0.02;
  problem.post_impact.controllers = {"joint_damping"};
  CaptureProblem other = problem;
  other.objective = {{ObjectiveQuantity::JointRateNorm}};
  const Formulation turn(problem), rate(other);
  constexpr auto kTurn = ObjectiveQuantity::AttitudeTurned;
  constexpr auto kRate = ObjectiveQuantity::JointRateNorm;
  for (const bool is_first : {true, false}) {
    std::atomic<bool> flag = true;
    TradeOffOptions options;
    options.starts = 4;
    options.levels = 4;
    options.stop.interrupted = &flag;
    const auto front_now = [&] {
      return is_first ? trade_off(problem, kTurn, kRate, options)
                      : trade_off(problem, kRate, kTurn, options);
    };
    const TradeOff at_once = front_now();
    CHECK(at_once.stopped);
    REQUIRE(at_once.points.size() == 1);
    flag = false;
    options.on_progress = [&flag](int done, int) { flag = done == 2; };
    const TradeOff later = front_now();
    CHECK(later.stopped);
    REQUIRE(later.points.size() >= 2);
    for (const TradeOff* front : {&at_once, &later}) {
      for (const TradeOffPoint& point : front->points) {
        CHECK(std::isinf(point.kkt_residual));  // a gradient takes simulations
        CHECK(point.max_violation <= 1e-9);
        const double turned = nominal_value(problem, turn, point.configuration);
        const double rates = nominal_value(other, rate, point.configuration);
        CHECK(point.first == Approx(is_first ? turned : rates).epsilon(1e-9).margin(1e-12));
        CHECK(point.second == Approx(is_first ? rates : turned).epsilon(1e-9).margin(1e-12));
      }
    }
  }
}

TEST_CASE("a front does not depend on the number of threads") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  const auto front_by = [&](int jobs) {
    TradeOffOptions options;
    options.starts = 12;
    options.levels = 6;
    options.jobs = jobs;
    return trade_off(problem, ObjectiveQuantity::BaseAngularMomentum,
                     ObjectiveQuantity::JointRateNorm, options);
  };
  const TradeOff alone = front_by(1);
  REQUIRE(alone.points.size() > 3);
  for (const int jobs : {2, 5}) {
    const TradeOff other = front_by(jobs);
    CHECK(other.solver_calls == alone.solver_calls);
    REQUIRE(other.points.size() == alone.points.size());
    for (std::size_t i = 0; i < alone.points.size(); ++i) {
      CHECK(other.points[i].configuration.phi == alone.points[i].configuration.phi);
      CHECK(other.points[i].first == alone.points[i].first);
      CHECK(other.points[i].second == alone.points[i].second);
      CHECK(other.points[i].kkt_residual == alone.points[i].kkt_residual);
    }
  }
}

}  // namespace stillbase
