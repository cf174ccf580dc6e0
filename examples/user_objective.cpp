// A term of the objective of the user's own: the rate of the elbow after the impact is made small
// beside the angular velocity of the base.
#include <cstdio>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/verification.hpp>

int main() {
  using namespace stillbase;
  CaptureProblem problem = read_problem("problems/planar_three_link_null.yaml");
  problem.user.terms.push_back(
      {.name = "elbow_rate",
       .unit = "rad/s",
       .size = 10,  // a rate of 10 rad/s counts as much as 1 rad/s of the base
       .value = [](const Configuration&, const ImpactSummary& impact) {
         return impact.Delta_phidot[1];
       }});

  // Search, collisions and approach path as always; the file holds the term's name.
  const std::string file = plan_to_json(make_plan(problem), {});
  const Plan plan = read_plan(file, "plan.json").plan;
  std::printf("%s: %.6g %s\n", plan.objective.name.c_str(), plan.objective.value,
              plan.objective.unit.c_str());
  // `verify` does not know the function: it says that the objective is not recomputed.
  const Verification verdict = verify_plan(plan);
  for (const Claim& claim : verdict.claims) {
    if (!claim.pass) std::printf("%s: %s\n", claim.name.c_str(), claim.detail.c_str());
  }
  return verdict.interrupted ? 1 : 0;
}
