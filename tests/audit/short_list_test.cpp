// Plans that keep fewer candidates than there are solutions.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {

TEST_CASE("enclosed solutions beyond a short list of candidates pass") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.search.max_candidates = 2;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  REQUIRE(plan.candidates.size() == 2);
  REQUIRE(proof.solutions.size() > 2);
  CHECK(failures(plan) == "");
  // One that is said to stand for a solution has to be in its box.
  const auto listed =
      std::find_if(proof.candidates.begin(), proof.candidates.end(), [](int c) { return c >= 0; });
  REQUIRE(listed != proof.candidates.end());
  Plan other = plan;
  for (int& c : other.certificate.proof.candidates) c = c < 0 ? 0 : c;
  CHECK(failures(other).find("proof_solutions_listed") != std::string::npos);
  // Of a whole list none may be left out.
  CaptureProblem enough = problem;
  enough.search.max_candidates = 100;
  Plan whole = make_plan(enough);
  CHECK(failures(whole) == "");
  whole.certificate.proof.candidates.front() = -1;
  CHECK(failures(whole).find("proof_solutions_listed") != std::string::npos);
}

}  // namespace stillbase
