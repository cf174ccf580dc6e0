// Base attitude and one joint: three variables where only the direction of the impulse in the base
// matters. The bound against a grid over that direction and the joint.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// A point mass that comes from an inertial direction; the hand is where the posture puts it.
CaptureProblem one_joint(const std::string& name, int joint) {
  CaptureProblem problem = test::without_path(name);
  VariableSpec& variables = problem.variables;
  variables.joints.assign(variables.joints.size(), false);
  variables.joints[static_cast<std::size_t>(joint)] = true;
  variables.base_attitude = AttitudeFreedom::Free;
  variables.base_attitude_max = M_PI;
  problem.hand.constraint = HandConstraint::None;
  problem.constraints = {};
  problem.constraints.joint_limit_margin = 0.05;
  problem.impulse.source = ImpulseSource::PointMass;
  problem.impulse.direction = Vector3d(0.8, 0.36, -0.48);
  problem.impulse.direction_frame = Frame::Inertial;
  problem.impulse.closing_speed = 0.05;
  return problem;
}

/// The least value over a grid: every direction, brought about by the shortest turn.
double least_on_grid(const CaptureProblem& problem, int directions, int angles) {
  const Formulation formulation(problem);
  const VariableSpec& variables = problem.variables;
  const auto free = std::find(variables.joints.begin(), variables.joints.end(), true);
  const auto k = static_cast<int>(free - variables.joints.begin());
  const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
  const bool turns = joint.type == JointType::Continuous;
  const double margin = turns ? 0 : problem.constraints.joint_limit_margin;
  const double lower = turns ? -M_PI : joint.lower + margin;
  const double upper = turns ? M_PI : joint.upper - margin;
  double least = kInfinity;
  for (int i = 0; i < directions; ++i) {
    // Evenly over the sphere, on a spiral.
    const double z = 1 - (2 * i + 1.0) / directions, around = i * M_PI * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vector3d direction_B(r * std::cos(around), r * std::sin(around), z);
    Configuration at{problem.start, problem.base, problem.variables.contact_time_lower};
    at.base.orientation =
        Eigen::Quaterniond::FromTwoVectors(direction_B, *problem.impulse.direction);
    for (int j = 0; j < angles; ++j) {
      at.phi[k] = lower + (upper - lower) * (j + 0.5) / angles;
      const double value = problem.measure.kind == RiskMeasure::WorstCase
                               ? worst_case(problem, formulation, at).value
                               : nominal_value(problem, formulation, at);
      least = std::min(least, value);
    }
  }
  return least;
}

}  // namespace

TEST_CASE("base attitude and one joint: the bound lies below a grid, the best candidate near it",
          "[proofs]") {
  struct Case {
    const char* name;
    int joint;
    ObjectiveQuantity quantity;
    RiskMeasure measure;
  };
  const Case one = GENERATE(
      Case{"spart_3dof_point", 1, ObjectiveQuantity::JointRateNorm, RiskMeasure::WorstCase},
      Case{"spart_3dof_point", 2, ObjectiveQuantity::BaseAngularVelocity, RiskMeasure::WorstCase},
      Case{"iiwa_cone", 3, ObjectiveQuantity::BaseAngularMomentum, RiskMeasure::WorstCase},
      Case{"iiwa_cone", 1, ObjectiveQuantity::ImpulseMagnitude, RiskMeasure::Nominal});
  CaptureProblem problem = one_joint(one.name, one.joint);
  problem.objective = {{one.quantity}};
  problem.measure.kind = one.measure;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  double best = kInfinity;
  for (const Candidate& candidate : plan.candidates) best = std::min(best, candidate.value);
  const bool is_robust = one.measure == RiskMeasure::WorstCase;
  const double on_grid = least_on_grid(problem, is_robust ? 600 : 3000, is_robust ? 40 : 100);
  CAPTURE(one.name, one.joint, proof.statement, proof.boxes, best, on_grid);
  REQUIRE(plan.status != PlanStatus::Infeasible);
  CHECK(on_grid >= best * (1 - 1e-9));
  CHECK(on_grid <= 2 * best);  // the grid is coarse beside the narrow valleys
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best);
  CHECK(*proof.lower_bound >= 0.98 * best);
  CHECK(proof.statement.find("proven: no configuration has ") == 0);
  CHECK(proof.statement.find("not counting") == std::string::npos);
}

}  // namespace stillbase
