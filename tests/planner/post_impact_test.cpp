// The planner's own verdict on the motion after the impact.
#include <catch2/catch.hpp>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {

TEST_CASE("a controller that demands more than a joint's torque limit breaks a limit") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  CHECK(post_impact_failure(problem, at, impact, {}) == "");
  // The base stays as still as before: the limit of one joint is just below what it is asked for.
  const AfterContact run =
      simulate_post_impact(problem, at, impact, problem.post_impact.controllers.front(), {});
  const SimulationSummary& summary = run.simulation.summary;
  problem.robot.joints[0].max_effort = 0.999 * summary.peak_demanded_torques[0];
  problem.post_impact.residual_base_rate_max = 1;
  problem.post_impact.attitude_change_max = 3;
  CHECK(post_impact_failure(problem, at, impact, {}) == "joint torques");
}

}  // namespace stillbase
