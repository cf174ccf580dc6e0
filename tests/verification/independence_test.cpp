// The verifier against a planner that computes with a wrong sign.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/temporary_folder.hpp"

namespace stillbase {
namespace {

std::string problem_path(const std::string& name) {
  return std::string(STILLBASE_SOURCE_DIR) + "/problems/" + name + ".yaml";
}

std::string failures(const Verification& verification) {
  std::string out;
  for (const Claim& claim : verification.claims) {
    if (claim.fails()) out += claim.name + ": " + claim.detail + "\n";
  }
  return out;
}

}  // namespace

// Problems without a case: the whole residual of a case, by another route, gives the flipped sign
// away to that planner itself.
TEST_CASE("plans of a planner with one sign flipped in its dynamics are refused") {
  for (const char* name : {"planar_three_link_null", "iiwa_client_50"}) {
    const TemporaryFolder folder;
    const std::string path = folder.path("flipped.json");
    const std::string command =
        std::string(STILLBASE_FLIPPED_PLANNER) + " '" + problem_path(name) + "' '" + path + "'";
    REQUIRE(std::system(command.c_str()) == 0);
    const PlanFile file = read_plan(read_text_file(path), path);
    // The file itself is in order, and by the planner's own numbers the plan is feasible.
    CHECK(file.stated_sha256 == file.computed_sha256);
    CHECK(file.plan.certificate.max_violation <= 1e-9);
    const Verification verification = judge_plan(file.plan);
    INFO(name);
    CHECK_FALSE(verification.pass);
  }
}

TEST_CASE("plans of the planner itself pass every check") {
  for (const char* name : {"planar_two_link_c2_a", "iiwa_client_50"}) {
    const Plan plan = make_plan(read_problem(problem_path(name)));
    const Verification verification = judge_plan(plan);
    INFO(name << "\n" << failures(verification));
    CHECK(verification.pass);
  }
}

TEST_CASE("plans of other seeds keep the problem's limits after the impact too") {
  for (const unsigned seed : {2u, 3u, 8u}) {
    CaptureProblem problem = read_problem(problem_path("iiwa_client_50"));
    problem.search.seed = seed;
    const Verification verification = judge_plan(make_plan(problem));
    INFO("seed " << seed << "\n" << failures(verification));
    CHECK(verification.pass);
  }
}

}  // namespace stillbase
