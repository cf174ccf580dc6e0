// A hand whose axes follow from the stated direction of the impulse.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {

TEST_CASE("the axes of a hand beside a stated direction are those of the planner, and are checked",
          "[proofs]") {
  const HandConstraint kind = GENERATE(HandConstraint::Axis, HandConstraint::Pose);
  const Frame frame = GENERATE(Frame::Base, Frame::Inertial);
  CaptureProblem problem = test::without_path("planar_two_link_post_impact_b");
  problem.variables.joints = {false, true};
  problem.base.orientation = Eigen::AngleAxisd(0.3, Vector3d::UnitZ());
  problem.impulse.direction_frame = frame;
  problem.hand.constraint = kind;
  const Plan plan = make_plan(problem);
  CAPTURE(static_cast<int>(kind), static_cast<int>(frame), failures(plan));
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK(plan.certificate.proof.solutions.size() == 1);
  CHECK(failures(plan).empty());
  Plan turned = plan;
  turned.configuration.phi[1] += 1e-3;
  CHECK(failures(turned).find("hand_axis") != std::string::npos);
  const bool is_pose = kind == HandConstraint::Pose;
  CHECK((failures(turned).find("hand_orientation") != std::string::npos) == is_pose);
  // A proof that leaves the solution out is found out by a search of its own.
  Plan without = plan;
  JointBox& box = without.certificate.proof.solutions.front();
  box.lower[1] += 1;
  box.upper[1] += 1;
  CHECK(failures(without).find("proof_recount") != std::string::npos);
}

}  // namespace stillbase
