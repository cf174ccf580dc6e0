// The nominal measure: which candidate is chosen, and which ones a short list keeps.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Joint rates after an impulse along 210 deg: zeros, and local minima of which some have a smaller
/// worst case over the wedge.
CaptureProblem rates_of_two_links() {
  CaptureProblem problem = test::without_path("planar_two_link_c2_b");
  problem.constraints.impact_case = CaseConstraint::None;
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  problem.uncertainty.cone_half_angle = kPi / 6;
  return problem;
}

double least_objective(const std::vector<Candidate>& candidates) {
  double least = kInfinity;
  for (const Candidate& candidate : candidates) least = std::min(least, candidate.objective);
  return least;
}

}  // namespace

TEST_CASE("no candidate has a lower nominal value than the nominal optimum, few starts or many") {
  CaptureProblem problem = test::without_path("iiwa_cone");
  problem.hand.constraint = HandConstraint::None;
  problem.constraints.joint_limit_margin = 0;
  problem.start << 0.3, -0.6, 0.4, 1.2, 0.2, 0.9, 0.1;
  for (std::size_t k = 0; k < 7; ++k) problem.variables.joints[k] = k == 1 || k == 3;
  for (const std::uint64_t seed : {1u, 4u, 7u}) {
    problem.search.starts = 1;
    problem.search.seed = seed;
    const Plan plan = make_plan(problem);
    REQUIRE(plan.nominal_optimum.has_value());
    CAPTURE(seed, plan.candidates.size());
    for (const Candidate& candidate : plan.candidates) {
      CHECK(candidate.objective >= plan.nominal_optimum->nominal * (1 - 1e-6));
    }
  }
}

TEST_CASE("the nominal measure chooses the least nominal value, whatever the worst cases") {
  for (const double degrees : {180.0, 210.0, 240.0, 270.0}) {
    CaptureProblem problem = rates_of_two_links();
    const double angle = degrees * kPi / 180;
    problem.impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    const Plan plan = make_plan(problem);
    CAPTURE(degrees);
    double least = kInfinity, least_worst_case = kInfinity;
    for (const Candidate& candidate : plan.candidates) {
      if (candidate.collision_free) least = std::min(least, candidate.objective);
    }
    REQUIRE(least < 1e-9);
    CHECK(plan.objective.nominal < 1e-9);
    // Of the zeros the one with the least worst case.
    for (const Candidate& candidate : plan.candidates) {
      const bool is_zero = candidate.collision_free && candidate.objective < 1e-9;
      if (is_zero) least_worst_case = std::min(least_worst_case, candidate.worst_case);
    }
    CHECK(plan.objective.worst_case == least_worst_case);
  }
}

TEST_CASE("candidates of the nominal measure come in order of their nominal values") {
  const Plan plan = make_plan(rates_of_two_links());
  REQUIRE(plan.candidates.size() >= 3);
  bool has_minimum = false;
  for (std::size_t i = 1; i < plan.candidates.size(); ++i) {
    const Candidate &before = plan.candidates[i - 1], &after = plan.candidates[i];
    CAPTURE(i, before.objective, after.objective);
    const bool are_equal = std::abs(before.objective - after.objective) < 1e-8;
    CHECK((are_equal ? before.worst_case <= after.worst_case : before.objective < after.objective));
    has_minimum = has_minimum || after.objective > 1e-3;
  }
  CHECK(has_minimum);
}

TEST_CASE("a short list keeps the least nominal value, with a fixed attitude and a free one") {
  for (const AttitudeFreedom attitude : {AttitudeFreedom::Fixed, AttitudeFreedom::Axis}) {
    CaptureProblem problem = rates_of_two_links();
    problem.objective = {{ObjectiveQuantity::BaseEnergy}};
    problem.uncertainty.cone_half_angle = kPi / 3;
    problem.variables.base_attitude = attitude;
    problem.impulse.direction_frame = Frame::Inertial;
    problem.search.max_candidates = 1000;
    const double least = least_objective(make_plan(problem).candidates);
    problem.search.max_candidates = 1;
    const Plan plan = make_plan(problem);
    CAPTURE(static_cast<int>(attitude));
    REQUIRE(plan.candidates.size() == 1);
    CHECK(plan.candidates.front().objective <= least * (1 + 1e-8));
  }
}

}  // namespace stillbase
