// Solutions of which the last joint may have any angle: found, stated once, recomputed.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/plan/free_roll.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

/// The hand's axis is that of the last joint, whose body is symmetric about it.
const Plan& plan_with_rolls() {
  static const Plan plan = make_plan(test::without_path("mounted_six_joint"));
  return plan;
}

bool is_same_but_for(int joint, Configuration a, const Configuration& b) {
  a.phi[joint] = b.phi[joint];
  return (a.phi - b.phi).norm() < 1e-3 && std::abs(a.contact_time - b.contact_time) < 1e-3 &&
         a.base.orientation.angularDistance(b.base.orientation) < 1e-3;
}

}  // namespace

TEST_CASE("solutions that differ in a free roll alone are one candidate with its range") {
  const Plan& plan = plan_with_rolls();
  const int last = plan.problem.robot.hand_body;
  REQUIRE(plan.candidates.size() >= 10);
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& candidate = plan.candidates[i];
    REQUIRE(candidate.family >= 0);
    const SolutionFamily& roll = plan.families[static_cast<std::size_t>(candidate.family)];
    CHECK(free_joint(roll) == last);
    CHECK(is_same_but_for(last, candidate.configuration, roll.points.front()));
    for (std::size_t j = 0; j < i; ++j) {
      CHECK_FALSE(is_same_but_for(last, candidate.configuration, plan.candidates[j].configuration));
    }
  }
  CHECK(failures(plan) == "");
}

TEST_CASE("a joint that may roll freely stands as in the start posture where that is free") {
  CaptureProblem problem = test::without_path("mounted_six_joint");
  const int last = problem.robot.hand_body;
  problem.search.starts = 8;
  for (const double start : {problem.start[last], 0.25}) {
    problem.start[last] = start;
    const Plan plan = make_plan(problem);
    REQUIRE_FALSE(plan.candidates.empty());
    for (const Candidate& candidate : plan.candidates) {
      if (candidate.collision_free) CHECK(candidate.configuration.phi[last] == start);
    }
  }
}

TEST_CASE("a roll that matters is not joined") {
  CaptureProblem problem = test::without_path("mounted_six_joint");
  problem.search.starts = 8;
  Body& body = problem.robot.bodies[static_cast<std::size_t>(problem.robot.hand_body)];
  body.centroid += Vector3d(0.02, 0, 0);
  const Plan plan = make_plan(problem);
  for (const SolutionFamily& family : plan.families) CHECK_FALSE(free_joint(family));
}

TEST_CASE("a hand whose axis is tilted by the rounding of a file has no roll to list") {
  CaptureProblem problem = test::without_path("mounted_six_joint");
  problem.search.starts = 8;
  // 1.57079633 of a robot file: more than the search leaves open, less than a verified plan may.
  const double tilt = 1.57079633 - kPi / 2;
  problem.robot.R_hand = problem.robot.R_hand * rotation_exp(Vector3d(tilt, 0, 0));
  const Plan plan = make_plan(problem);
  REQUIRE_FALSE(plan.candidates.empty());
  for (const SolutionFamily& family : plan.families) CHECK_FALSE(free_joint(family));
  CHECK(failures(plan) == "");
}

TEST_CASE("a misstated range of a free joint is found") {
  const int last = plan_with_rolls().problem.robot.hand_body;
  Plan wider = plan_with_rolls();
  wider.families[0].points.back().phi[last] += 0.1;
  wider.families[0].length += 0.1;
  CHECK(failures(wider).find("families_rolls_stated") != std::string::npos);
  Plan narrower = plan_with_rolls();
  narrower.families[0].points.front().phi[last] += 0.1;
  narrower.families[0].length -= 0.1;
  CHECK(failures(narrower).find("families_rolls_stated") != std::string::npos);
  Plan elsewhere = plan_with_rolls();
  std::swap(elsewhere.candidates[0].family, elsewhere.candidates[1].family);
  CHECK(failures(elsewhere).find("families_rolls_stated") != std::string::npos);

  Plan twice = plan_with_rolls();
  twice.families.push_back(twice.families[0]);
  CHECK(failures(twice).find("families_distinct") != std::string::npos);

  // Another joint is not free: whatever it changes, its range is none.
  Plan invented = plan_with_rolls();
  SolutionFamily& family = invented.families[0];
  const Joint& joint = invented.problem.robot.joints[0];
  const double margin = invented.problem.constraints.joint_limit_margin;
  const Configuration middle = invented.candidates[0].configuration;
  family.points = {middle, middle};
  family.points.front().phi[0] = joint.lower + margin;
  family.points.back().phi[0] = joint.upper - margin;
  family.length = family.points.back().phi[0] - family.points.front().phi[0];
  CHECK(failures(invented).find("families_rolls ") != std::string::npos);
}

TEST_CASE("a free joint that is left out of every list is found") {
  Plan none = plan_with_rolls();
  none.families.clear();
  for (Candidate& candidate : none.candidates) candidate.family = -1;
  CHECK(failures(none).find("candidates_list") != std::string::npos);
  Plan fewer = plan_with_rolls();
  const int last = static_cast<int>(fewer.families.size()) - 1;
  REQUIRE(free_joint(fewer.families.back()));
  fewer.families.pop_back();
  for (Candidate& candidate : fewer.candidates) {
    if (candidate.family == last) candidate.family = -1;
  }
  CHECK(failures(fewer).find("candidates_list") != std::string::npos);
}

}  // namespace stillbase
