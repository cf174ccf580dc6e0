// More joints than matrices hold in place (20): storage on the heap, from the search to the plan.
#include <catch2/catch.hpp>

#include <stillbase/impact/jump.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("a chain of 24 joints is planned, and articulated bodies give the same jump") {
  constexpr int kJoints = 24;
  Random random(5);
  const RobotModel robot = random_planar_robot(random, kJoints);
  CaptureProblem problem = point_mass_problem(robot, Vector3d(0.6, 0.8, 0));
  problem.search.starts = 4;
  problem.approach.enabled = false;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Optimal);
  REQUIRE(plan.configuration.phi.size() == kJoints);

  const auto jump = compute_jump<double>(robot, plan.configuration.phi, JointVectord::Zero(kJoints),
                                         {}, plan.impact.Fbar);
  // The base's part vanishes, so the joints' is the scale of both.
  const double limit = 1e-12 * jump.Delta_phidot.norm();
  CHECK((jump.Delta_Omega - plan.impact.Delta_Omega).norm() < limit);
  CHECK((jump.Delta_phidot - plan.impact.Delta_phidot).norm() < limit);
  // The base receives what the nominal objective says: here it can vanish.
  CHECK(plan.objective.nominal == Approx(plan.impact.base.norm()).epsilon(0).margin(1e-9));
  CHECK(plan.objective.nominal < 1e-6 * plan.impact.total.norm());
}

}  // namespace stillbase
