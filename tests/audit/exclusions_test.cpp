// Candidates that rank before the chosen one, and reasons against them that do not hold.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

PlannerOptions without_proof() {
  PlannerOptions options;
  options.prover = nullptr;
  return options;
}

/// Failed checks of the search record, the time after the impact included.
std::string failing(const Plan& plan) {
  VerifyOptions options;
  options.prover = nullptr;
  options.cone_samples = 200;
  std::string names;
  for (const Claim& claim : audit_plan(plan, options).claims) {
    if (claim.fails()) names += claim.name + " ";
  }
  return names;
}

/// What is left open under a name; empty: nothing.
std::string open_under(const Plan& plan, const std::string& name) {
  for (const Claim& claim : audit_plan(plan, {}).claims) {
    if (claim.name == name && !claim.is_checked) return claim.detail;
  }
  return "";
}

std::string failing_with(const Plan& plan, const std::function<void(Plan&)>& change) {
  Plan other = plan;
  change(other);
  return failing(other);
}

std::size_t first_excluded(const Plan& plan, const std::string& begin) {
  const auto at = std::find_if(
      plan.candidates.begin(), plan.candidates.end(),
      [&](const Candidate& candidate) { return candidate.excluded.rfind(begin, 0) == 0; });
  REQUIRE(at != plan.candidates.end());
  return static_cast<std::size_t>(at - plan.candidates.begin());
}

Plan plan_without_path() {
  CaptureProblem problem = test::shipped("detumble_client_1000");
  problem.approach.enabled = false;
  const Plan plan = make_plan(problem, without_proof());
  REQUIRE(plan.candidates.size() > 1);
  return plan;
}

}  // namespace

TEST_CASE("a candidate without a path is neither in collision nor refused in free words") {
  CaptureProblem problem = test::shipped("matched_light");
  problem.objective.front().quantity = ObjectiveQuantity::BaseEnergy;
  const Plan plan = make_plan(problem, without_proof());
  const std::size_t i = first_excluded(plan, "no approach path: ");
  REQUIRE(plan.candidates[i].collision_free);
  CHECK(failing(plan) == "");
  const std::string open = open_under(plan, "search_exclusions");
  CHECK_THAT(open, Catch::Contains("candidates.excluded of " + std::to_string(i)));
  CHECK_THAT(open, Catch::Contains("no approach path"));
  const auto with_reason = [&](const std::string& reason) {
    return failing_with(plan, [&](Plan& p) { p.candidates[i].excluded = reason; });
  };
  CHECK(with_reason("at the contact: link_2 with base") == "candidates_excluded ");
  CHECK(with_reason("because") == "candidates_excluded ");
  CHECK(with_reason("no approach path: nothing fits") == "candidates_excluded ");
  CHECK(with_reason("no better where its path ends") == "candidates_excluded ");
  CHECK(with_reason("not tried") == "candidates_excluded ");
  CHECK(with_reason("after the impact: base rate") == "candidates_excluded ");
  CHECK(with_reason("after the impact: joint_2 reaches its stop") == "candidates_excluded ");
  CHECK(with_reason("after the impact: bad luck") == "candidates_excluded ");
  // The same words with the collision stated beside them.
  CHECK(failing_with(plan, [&](Plan& p) {
          Candidate& candidate = p.candidates[i];
          candidate.excluded = "at the contact: link_2 with base";
          candidate.collision_free = false;
          candidate.collision = "link_2 with base";
        }) == "candidates_collision ");
}

TEST_CASE("what a candidate collides with is recomputed") {
  const Plan plan = plan_without_path();
  const auto at =
      std::find_if(plan.candidates.begin(), plan.candidates.end(),
                   [](const Candidate& candidate) { return !candidate.collision_free; });
  REQUIRE(at != plan.candidates.end());
  const auto i = static_cast<std::size_t>(at - plan.candidates.begin());
  CHECK(failing(plan) == "");
  CHECK(failing_with(plan, [&](Plan& p) {
          const std::string pair = "link_7 with base";
          REQUIRE(p.candidates[i].collision != pair);
          if (!p.candidates[i].excluded.empty())
            p.candidates[i].excluded = "at the contact: " + pair;
          p.candidates[i].collision = pair;
        }) == "candidates_collision ");
  CHECK_THAT(failing_with(plan,
                          [&](Plan& p) {
                            p.candidates[i].collision_free = true;
                            p.candidates[i].collision.clear();
                          }),
             Catch::Contains("candidates_collision "));
}

TEST_CASE("a limit after the impact is exceeded, by as much as is said") {
  CaptureProblem problem = test::shipped("detumble_client_1000");
  problem.approach.enabled = false;
  const Plan whole = make_plan(problem, without_proof());
  REQUIRE(whole.managed_momentum);
  // The wheel about one axis holds less than what the best configuration brings.
  Eigen::Index axis = 0;
  const double most = whole.managed_momentum->angular.cwiseAbs().maxCoeff(&axis);
  problem.post_impact.wheels.momentum[axis] = 0.999 * most;
  const Plan plan = make_plan(problem, without_proof());
  const std::size_t i = first_excluded(plan, "after the impact: wheel momentum of ");
  CHECK(failing(plan) == "");
  const std::string stated = plan.candidates[i].excluded;
  const auto with_reason = [&](const std::string& reason) {
    INFO(reason);
    return failing_with(plan, [&](Plan& p) { p.candidates[i].excluded = reason; });
  };
  std::string other = stated;
  const std::size_t number = other.find(": ", 20) + 2;
  other.insert(number, "1");
  CHECK(with_reason(other) == "candidates_excluded ");
  CHECK(with_reason(stated + ", too") == "candidates_excluded ");
  CHECK(with_reason("after the impact: joint rates") == "candidates_excluded ");
  CHECK(with_reason("after the impact: load of the grip") == "candidates_excluded ");
}

TEST_CASE("a limit of the motion after the impact is confirmed by another simulation") {
  CaptureProblem problem = test::shipped("detumble_client_1000");
  problem.approach.enabled = false;
  problem.post_impact.horizon = 2;
  const Plan plan = make_plan(problem, without_proof());
  Plan altered = plan;
  std::size_t i = 0;
  while (i < altered.candidates.size() && !altered.candidates[i].collision_free) ++i;
  REQUIRE(i < altered.candidates.size());
  // Robot and target do not rest so soon.
  altered.candidates[i].excluded =
      "after the impact: robot and target do not rest within the horizon of 2 s";
  CHECK_THAT(failing(altered), !Catch::Contains("candidates_excluded"));
  altered.candidates[i].excluded =
      "after the impact: robot and target do not rest within the horizon of 3 s";
  CHECK_THAT(failing(altered), Catch::Contains("candidates_excluded"));
}

TEST_CASE("a plan that does not state its choice leaves it open") {
  Plan plan = make_plan(test::without_path("planar_three_link_station"), without_proof());
  CHECK(open_under(plan, "choice") == "");
  plan.choice.better = -1;
  CHECK_THAT(open_under(plan, "choice"), Catch::Contains("does not state it"));
}

}  // namespace stillbase
