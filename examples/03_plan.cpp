// A search: all postures of the paper's two-link arm in which an impact does not rotate the base.
//
//   optimal: 8 candidates, 3 without collision
//   chosen: joint_1 -7.62 deg, joint_2 97.13 deg; base 0 N m s
//
// Run from the root of the repository.
#include <algorithm>
#include <cstdio>

#include <stillbase/stillbase.hpp>

int main() {
  using namespace stillbase;
  CaptureProblem problem = read_problem("problems/planar_two_link_c2_a.yaml");
  problem.search.seed = 1;  // every field of the file is a member; the same seed, the same plan

  const Plan plan = make_plan(problem);
  const auto free = std::count_if(plan.candidates.begin(), plan.candidates.end(),
                                  [](const Candidate& c) { return c.collision_free; });
  std::printf("%s: %zu candidates, %ld without collision\n", to_string(plan.status).c_str(),
              plan.candidates.size(), static_cast<long>(free));

  std::printf("chosen:");
  for (int k = 0; k < problem.robot.n(); ++k) {
    std::printf(" %s %.2f deg", problem.robot.joints[static_cast<std::size_t>(k)].name.c_str(),
                plan.configuration.phi[k] * 180 / M_PI);
  }
  std::printf("; base %.1g N m s\n", plan.objective.nominal);

  // Every candidate has its value for the nominal direction and over the cone of directions.
  for (const Candidate& candidate : plan.candidates) {
    std::printf("  worst case %.3g N m s%s\n", candidate.worst_case,
                candidate.collision_free ? "" : (", " + candidate.collision).c_str());
  }
  const ImpactSummary at_start = impact_at(problem, start_configuration(problem));
  std::printf("in the start posture the base takes %.3g N m s\n", at_start.base.norm());
  return plan.status == PlanStatus::Optimal ? 0 : 1;
}
