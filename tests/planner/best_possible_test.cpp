// The bound beside the search.
#include <catch2/catch.hpp>

#include <stillbase/planner/planner.hpp>
#include <stillbase/proof/minimum.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using test::without_path;

double best_of(const Plan& plan) {
  double best = kInfinity;
  for (const Candidate& candidate : plan.candidates) best = std::min(best, candidate.value);
  return best;
}

}  // namespace

TEST_CASE("the best worst case of the redundant planar arm is proven to a thousandth") {
  const Plan plan = make_plan(without_path("planar_three_link_null"));
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::Complete);
  CHECK(proof.solutions.size() >= 4);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
  CHECK(proof.gap == best_of(plan) - *proof.lower_bound);
  CHECK(proof.statement.find("; no posture has a worst case below 1.67") != std::string::npos);
  CHECK(make_plan(without_path("planar_three_link_null")).certificate.proof.lower_bound ==
        proof.lower_bound);
}

TEST_CASE("the bound over a wedge of half a plane finds the directions that it lacks") {
  // Six directions on either side leave 0.9 % and 0.8 % open, however many boxes are examined.
  for (const ObjectiveQuantity quantity :
       {ObjectiveQuantity::JointRateNorm, ObjectiveQuantity::BaseAngularVelocity}) {
    CaptureProblem problem = without_path("planar_two_link_c2_a");
    problem.constraints.impact_case = CaseConstraint::None;
    problem.objective = {{quantity}};
    problem.measure.kind = RiskMeasure::WorstCase;
    problem.uncertainty.cone_half_angle = kPi / 2;
    problem.search.starts = 64;
    const Plan plan = make_plan(problem);
    const Proof& proof = plan.certificate.proof;
    CAPTURE(proof.statement, proof.boxes);
    REQUIRE(proof.lower_bound.has_value());
    CHECK(*proof.lower_bound <= best_of(plan));
    CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
    CHECK(proof.boxes < 20000);
  }
}

TEST_CASE("the bound over a wedge of half a plane comes as near as asked at a fixed hand point") {
  // Of these quantities the worst direction follows the posture: few directions leave 3 to 10 %.
  const ObjectiveQuantity quantity =
      GENERATE(ObjectiveQuantity::ImpulseMagnitude, ObjectiveQuantity::JointRateNorm);
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.objective = {{quantity}};
  problem.uncertainty.cone_half_angle = kPi / 2;
  problem.search.starts = 64;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(proof.statement, proof.boxes);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
  CHECK(proof.boxes < 20000);
}

TEST_CASE("an objective that vanishes nowhere is bounded although no solution is enclosed") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  problem.measure.kind = RiskMeasure::Nominal;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::NotApplicable);
  CHECK(proof.statement.find("proven: no posture has a predicted joint_rate_norm below") == 0);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
  CHECK(*proof.lower_bound <= best_of(plan));
}

TEST_CASE(
    "where the postures of a case are enclosed, the least worst case among them is the bound") {
  CaptureProblem problem = without_path("planar_two_link_c2_a");
  problem.measure.kind = RiskMeasure::WorstCase;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.solutions.size() == 8);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
}

TEST_CASE("base angle, contact time, a moving target, a station box: proven to a hundredth") {
  const int kind = GENERATE(0, 1, 2, 3, 4);
  CaptureProblem problem =
      without_path(kind == 0 ? "planar_three_link_null" : "planar_three_link_client");
  VariableSpec& variables = problem.variables;
  const auto fix_attitude = [&] { variables.base_attitude = AttitudeFreedom::Fixed; };
  std::string words = "no configuration has a worst case below ";
  if (kind == 0) {  // base angle, the hand at a point of N
    variables.joints = {false, true, true};
    variables.base_attitude = AttitudeFreedom::Axis;
    variables.base_attitude_max = 0.5;
    problem.impulse.direction_frame = Frame::Inertial;
    problem.hand.frame = Frame::Inertial;
  } else if (kind == 1) {  // contact time, the hand at the client
    variables.joints = {false, true, true};
    fix_attitude();
    problem.hand.constraint = HandConstraint::Position;
  } else if (kind == 2) {  // the hand at the client at a stated time
    variables.contact_time_lower = variables.contact_time_upper = 72;
    fix_attitude();
    problem.hand.constraint = HandConstraint::Position;
    words = "no posture has a worst case below ";
  } else if (kind == 3) {  // joint and time, the station in a box
    variables.joints = {false, true, false};
    fix_attitude();
    problem.hand.constraint = HandConstraint::None;
    variables.base_position = PositionFreedom::Box;
    variables.base_position_lower = {-0.05, -0.4, -0.1};
    variables.base_position_upper = {0.05, 0.4, 0.1};
  } else {  // two joints that bring the hand's axis along the normal, which turns with the time
    variables.joints = {false, true, true};
    fix_attitude();
    variables.base_position = PositionFreedom::Free;
  }
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(kind, proof.statement);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * 0.99);
  CHECK(proof.statement.find(words) != std::string::npos);
  CHECK(proof.statement.find("not counting") == std::string::npos);
}

TEST_CASE("the base attitude alone, free or within a cone: proven to a hundredth") {
  const bool is_cone = GENERATE(false, true);
  const bool is_client = GENERATE(false, true);
  CaptureProblem problem = without_path("iiwa_cone");
  VariableSpec& variables = problem.variables;
  variables.joints.assign(variables.joints.size(), false);
  variables.base_attitude = is_cone ? AttitudeFreedom::Cone : AttitudeFreedom::Free;
  variables.base_attitude_axis = Vector3d(1, -2, 2) / 3;
  if (is_cone) variables.base_attitude_max = 20 * M_PI / 180;
  problem.hand.constraint = HandConstraint::None;
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  if (!is_client) {
    problem.impulse.source = ImpulseSource::PointMass;
    problem.impulse.direction = Vector3d(0.8, 0.36, -0.48);
    problem.impulse.direction_frame = Frame::Inertial;
    problem.impulse.closing_speed = 0.05;
  }
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(is_cone, is_client, proof.statement, proof.boxes);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * 0.99);
  CHECK(proof.statement.find("proven: no configuration has a worst case below ") == 0);
  CHECK(proof.statement.find("not counting") == std::string::npos);
}

TEST_CASE("attitude and more than it: no bound, with the number of variables") {
  CaptureProblem problem = without_path("iiwa_cone");
  VariableSpec& variables = problem.variables;
  variables.joints.assign(variables.joints.size(), false);
  variables.joints[1] = true;
  variables.base_attitude = AttitudeFreedom::Free;
  problem.hand.constraint = HandConstraint::None;
  CHECK(minimum_objection(problem) == "it takes one to three free variables, here are 4");
  variables.joints[1] = false;
  CHECK(minimum_objection(problem) == "");
  variables.contact_time_lower = 60;
  CHECK(minimum_objection(problem) == "it takes one to three free variables, here are 4");
}

TEST_CASE(
    "of a wedge that rotates with the base only the middle direction is bounded, a valid bound") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.variables.joints = {false, true, false};
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_axis = Vector3d(1, 0.5, 0.3).normalized();
  problem.variables.base_attitude_max = 0.5;
  problem.impulse.direction_frame = Frame::Inertial;
  problem.impulse.direction = Vector3d(-1, 0.6, 0.4).normalized();
  problem.hand.constraint = HandConstraint::None;
  problem.hand.position.reset();
  problem.variables.base_position = PositionFreedom::Free;
  problem.uncertainty.cone_half_angle = 0.8;
  // Least where the wedge lies in the arm's plane: across it the arm is heavier.
  problem.objective = {{ObjectiveQuantity::ImpulseMagnitude}};
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(proof.statement);
  CHECK(proof.statement.find("contradiction") == std::string::npos);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  // Of the middle's direction alone: no nominal value is smaller.
  REQUIRE(plan.nominal_optimum.has_value());
  CHECK(*proof.lower_bound <= plan.nominal_optimum->nominal);
  CHECK(*proof.lower_bound >= plan.nominal_optimum->nominal * 0.99);
}

TEST_CASE("means over samples: proven to a hundredth, with the number of samples") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.measure.kind = GENERATE(RiskMeasure::Expectation, RiskMeasure::Cvar);
  problem.uncertainty.restitution = 0.1;
  problem.uncertainty.target_mass = 0.2;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(proof.statement);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * 0.99);
  const bool is_cvar = problem.measure.kind == RiskMeasure::Cvar;
  const std::string words = std::string(is_cvar ? "a CVaR of" : "an expected") +
                            " base_angular_velocity (64 samples) below ";
  CHECK(proof.statement.find("no posture has " + words) != std::string::npos);
}

TEST_CASE("where the best candidate is zero no bound is looked for") {
  const Plan zero = make_plan(without_path("planar_two_link_c2_a"));
  CHECK_FALSE(zero.certificate.proof.lower_bound.has_value());
}

/// Joint rates vanish where the arm lies along the impulse, in valleys a few degrees wide.
CaptureProblem narrow_valleys() {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.hand.constraint = HandConstraint::None;
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  problem.measure.kind = RiskMeasure::Nominal;
  problem.variables.joints = {true, false, true};
  problem.start[1] = 0;
  return problem;
}

TEST_CASE("a better posture that the search had missed is found by the proof") {
  CaptureProblem problem = narrow_valleys();
  problem.search.starts = 1;
  const Plan plan = make_plan(problem);
  INFO(plan.certificate.proof.statement);
  CHECK(plan.certificate.proof.statement.find("which the search had missed") != std::string::npos);
  CHECK(best_of(plan) < 1e-9);
  CHECK(plan.certificate.proof.statement.find("no less is possible") != std::string::npos);
}

TEST_CASE("three free joints without any equation: the least worst case of an arm of seven") {
  CaptureProblem problem = without_path("iiwa_cone");
  problem.hand.constraint = HandConstraint::None;
  for (std::size_t k = 0; k < 7; ++k) problem.variables.joints[k] = k == 1 || k == 3 || k == 5;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.statement.find("no posture has a worst case below 0.053") != std::string::npos);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
}

}  // namespace stillbase
