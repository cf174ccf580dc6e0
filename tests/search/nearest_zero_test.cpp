// Zeros nearest to the start posture, judged by steps along the surface of zeros.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/projection.hpp"
#include "search/nearest_zero.hpp"
#include "search/zero_watch.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Half the squared distance from the start posture, joints alone.
double way(const CaptureProblem& problem, const Formulation& formulation,
           const Eigen::VectorXd& x) {
  return (formulation.configuration(x).phi - problem.start).squaredNorm() / 2;
}

/// Zeros at which local solves meet their surface.
std::vector<Eigen::VectorXd> zeros_of(const Formulation& formulation, int starts) {
  const auto optimizer = nlp::make_optimizer("sqp");
  nlp::OptimizeOptions solve;
  solve.max_evaluations = 1000;
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i < starts; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 7));
    const Eigen::VectorXd from = project_onto_constraints(formulation, start, false, 15).x;
    const Eigen::VectorXd end = minimize_to_zero(*optimizer, formulation, from, solve).x;
    const ProjectionResult zero = project_onto_constraints(formulation, end, true, 20);
    if (zero.violation <= 1e-9) out.push_back(zero.x);
  }
  return out;
}

/// The smallest distance from a bound.
double room(const Formulation& formulation, const Eigen::VectorXd& x) {
  return std::min((formulation.upper() - x).minCoeff(), (x - formulation.lower()).minCoeff());
}

}  // namespace

TEST_CASE("no zero next to the nearest one is nearer to the start posture") {
  for (const char* name : {"matched_light", "deos_latch"}) {
    CAPTURE(name);
    const CaptureProblem problem = test::without_path(name);
    const Formulation formulation(problem);
    NearestZeroOptions options;
    options.push = 0;
    const std::vector<Eigen::VectorXd> zeros = zeros_of(formulation, 48);
    REQUIRE(zeros.size() >= 5);
    std::size_t moved = 0;
    for (const Eigen::VectorXd& zero : zeros) {
      const auto x = nearest_zero(problem, formulation, zero, {}, options);
      if (!x) continue;
      ++moved;
      CHECK(project_onto_constraints(formulation, *x, true, 0).violation <= 1e-9);
      const double least = way(problem, formulation, *x);
      CAPTURE(least);
      // The base's rotation and the time count for a thousandth.
      CHECK(least <= way(problem, formulation, zero) + 1e-2);
      const Eigen::MatrixXd open = open_directions(formulation, *x, true);
      CHECK(open.cols() >= 2);
      for (Eigen::Index k = 0; k < open.cols(); ++k) {
        for (const double step : {-1e-3, 1e-3}) {
          const ProjectionResult beside =
              project_onto_constraints(formulation, *x + step * open.col(k), true, 20);
          if (!(beside.violation <= 1e-12)) continue;
          CHECK(way(problem, formulation, beside.x) >= least - 1e-5);
        }
      }
    }
    CAPTURE(moved, zeros.size());
    CHECK(2 * moved >= zeros.size());  // others come to creep, or to where slopes are dependent
  }
}

TEST_CASE("moved zeros keep off the limits that stand between them and the start posture") {
  const CaptureProblem problem = test::without_path("matched_light");
  const Formulation formulation(problem);
  NearestZeroOptions without;
  without.push = 0;
  int at_limit = 0, moved = 0, off = 0, still_there = 0;
  for (const Eigen::VectorXd& zero : zeros_of(formulation, 120)) {
    const auto nearest = nearest_zero(problem, formulation, zero, {}, without);
    if (nearest && room(formulation, *nearest) <= 1e-9) ++at_limit;
    const auto x = nearest_zero(problem, formulation, zero, {});
    if (!x) continue;
    ++moved;
    if (room(formulation, *x) >= 0.01) ++off;
    if (room(formulation, *x) <= 1e-9) ++still_there;
  }
  CAPTURE(at_limit, moved, off, still_there);
  CHECK(at_limit >= 8);
  CHECK(moved >= 15);
  CHECK(3 * off >= 2 * moved);  // others come nearer: where two limits push, or the way is long
  CHECK(10 * still_there <= moved);
}

TEST_CASE(
    "a zero that would touch something where it is nearest stays, and all keep their starts") {
  const CaptureProblem problem = test::without_path("matched_light");
  const Formulation formulation(problem);
  std::vector<Solution> before;
  for (const Eigen::VectorXd& zero : zeros_of(formulation, 48)) {
    before.push_back(judge(problem, formulation, zero));
    before.back().reached = static_cast<int>(before.size());
  }
  const auto moved = [&](int most, const std::function<bool(const Configuration&)>& is_free) {
    std::vector<Solution> after = before;
    CHECK(move_zeros_nearer(problem, formulation, most, 1e-9, is_free, {}, 1, after));
    int count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      CHECK(after[i].reached == before[i].reached);
      if (after[i].x != before[i].x) ++count;
    }
    return count;
  };
  CHECK(moved(100, {}) >= 5);
  CHECK(moved(2, {}) <= 2);
  const auto is_where_it_was = [&](const Configuration& at) {
    return std::any_of(before.begin(), before.end(), [&](const Solution& one) {
      return formulation.configuration(one.x).phi == at.phi;
    });
  };
  CHECK(moved(100, is_where_it_was) == 0);
  CHECK(moved(100, [](const Configuration&) { return false; }) >= 5);
}

TEST_CASE("where the objective is zero everywhere the start posture is the nearest zero") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.robot.joints.front().p.setZero();
  problem.hand.constraint = HandConstraint::None;
  const Formulation formulation(problem);
  const Eigen::VectorXd zero =
      formulation.start_point(Eigen::VectorXd::Constant(formulation.num_variables(), 0.4));
  const auto x = nearest_zero(problem, formulation, zero, {});
  REQUIRE(x);
  CHECK(way(problem, formulation, *x) < 1e-12);
}

TEST_CASE("a zero that is alone is left as it is") {
  const CaptureProblem problem = test::without_path("planar_two_link_c2_a");
  const Formulation formulation(problem);
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(formulation.num_variables(), 0.3);
  const ProjectionResult zero =
      project_onto_constraints(formulation, formulation.start_point(u), true, 60);
  CHECK_FALSE(nearest_zero(problem, formulation, zero.x, {}));
}

}  // namespace stillbase
