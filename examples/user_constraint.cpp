// A constraint of the user's own: the second joint stays bent to the left at the contact.
#include <cstdio>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/verification.hpp>

int main() {
  using namespace stillbase;
  CaptureProblem problem = read_problem("problems/planar_three_link_null.yaml");
  problem.user.constraints.push_back(
      {.name = "bent_to_the_left",
       .unit = "rad",
       .lower = 0.5,
       .value = [](const Configuration& at, const ImpactSummary&) { return at.phi[1]; }});

  // Search, collisions and approach path as always; the file holds the constraint's values.
  const std::string file = plan_to_json(make_plan(problem), {});
  const Plan plan = read_plan(file, "plan.json").plan;
  for (const ConstraintValue& constraint : plan.constraints) {
    std::printf("%-24s %10.6f in [%g, %g]\n", constraint.name.c_str(), constraint.value,
                constraint.lower, constraint.upper);
  }
  // `verify` does not know the function: it lists the constraint as not recomputed.
  const Verification verdict = verify_plan(plan);
  for (const Claim& claim : verdict.claims) {
    if (claim.name == "constraint_values" || !claim.pass) std::puts(claim.detail.c_str());
  }
  return verdict.pass ? 0 : 1;
}
