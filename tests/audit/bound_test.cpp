// What a plan says of the least measure there is, held against its candidates and against a search
// by the second dynamics.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

using test::without_path;

const Plan& plan_of_null() {
  static const Plan plan = make_plan(without_path("planar_three_link_null"));
  return plan;
}

/// Base angle free, the hand at a point of N.
CaptureProblem free_attitude() {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.variables.joints = {false, true, true};
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_max = 0.5;
  problem.impulse.direction_frame = Frame::Inertial;
  problem.hand.frame = Frame::Inertial;
  return problem;
}

/// Contact time free, the hand at the turning client.
CaptureProblem free_time() {
  CaptureProblem problem = without_path("planar_three_link_client");
  problem.variables.joints = {false, true, true};
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.hand.constraint = HandConstraint::Position;
  return problem;
}

/// Mean of the worst over samples that differ in everything but the posture.
CaptureProblem sampled() {
  CaptureProblem problem = without_path("planar_three_link_client");
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 72;
  problem.hand.constraint = HandConstraint::Position;
  problem.measure.kind = RiskMeasure::Cvar;
  problem.measure.samples = 12;
  problem.uncertainty.closing_speed = 0.005;
  problem.uncertainty.restitution = 0.1;
  problem.uncertainty.target_mass = 0.2;
  problem.uncertainty.target_inertia = 0.2;
  problem.uncertainty.contact_point = 0.01;
  problem.uncertainty.contact_time = 0.5;
  return problem;
}

/// All joints held, the base free to turn, an impulse along a direction of N.
CaptureProblem any_attitude(AttitudeFreedom freedom) {
  CaptureProblem problem = without_path("iiwa_cone");
  VariableSpec& variables = problem.variables;
  variables.joints.assign(variables.joints.size(), false);
  variables.base_attitude = freedom;
  variables.base_attitude_axis = Vector3d(1, -2, 2) / 3;
  if (freedom == AttitudeFreedom::Cone) variables.base_attitude_max = 20 * M_PI / 180;
  problem.hand.constraint = HandConstraint::None;
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  problem.impulse.source = ImpulseSource::PointMass;
  problem.impulse.direction = Vector3d(0.8, 0.36, -0.48);
  problem.impulse.direction_frame = Frame::Inertial;
  problem.impulse.closing_speed = 0.05;
  return problem;
}

}  // namespace

TEST_CASE("a bound over all attitudes passes, and the search refutes one that is 2 % too high") {
  const AttitudeFreedom freedom = GENERATE(AttitudeFreedom::Free, AttitudeFreedom::Cone);
  const RiskMeasure kind = GENERATE(RiskMeasure::Nominal, RiskMeasure::WorstCase);
  CaptureProblem problem = any_attitude(freedom);
  problem.measure.kind = kind;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(static_cast<int>(freedom), static_cast<int>(kind), proof.statement);
  REQUIRE(proof.lower_bound.value_or(0) > 0);
  // Of the client's shape, which does not matter for an impulse along a stated direction, other
  // checks complain.
  CHECK(failures(plan).find("proof") == std::string::npos);
  Plan boasting = plan;
  double best = kInfinity;
  for (const Candidate& candidate : plan.candidates) best = std::min(best, candidate.value);
  boasting.certificate.proof.lower_bound = 1.02 * best;
  CHECK(failures(boasting).find("proof_bound_searched") != std::string::npos);
}

TEST_CASE("a proven bound passes") {
  REQUIRE(plan_of_null().certificate.proof.lower_bound.value_or(0) > 0);
  CHECK(failures(plan_of_null()).empty());
}

TEST_CASE("a misstated bound is found") {
  const std::vector<std::pair<const char*, std::function<void(Plan&)>>> lies = {
      {"proof_bound ", [](Plan& p) { *p.certificate.proof.lower_bound *= 1.001; }},
      {"proof_bound_statement", [](Plan& p) { *p.certificate.proof.gap *= 1 + 1e-6; }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.gap.reset(); }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.statement = "proven: trust"; }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.boxes = 0; }}};
  for (const auto& [claim, lie] : lies) {
    Plan plan = plan_of_null();
    lie(plan);
    INFO(claim);
    CHECK(failures(plan).find(claim) != std::string::npos);
  }
}

TEST_CASE("better postures that a plan does not list are found by an own search") {
  Plan plan = plan_of_null();
  Proof& proof = plan.certificate.proof;
  // As if the worst of the candidates were the best there is.
  proof.lower_bound = plan.candidates.back().value * 0.999;
  CHECK(failures(plan).find("proof_bound_searched") != std::string::npos);
}

TEST_CASE(
    "bounds over base angle, contact time and samples pass, and too high ones are found out") {
  const int kind = GENERATE(0, 1, 2);
  const CaptureProblem problem = kind == 0 ? free_attitude() : kind == 1 ? free_time() : sampled();
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CAPTURE(kind, proof.statement);
  REQUIRE(proof.lower_bound.value_or(0) > 0);
  CHECK(failures(plan) == "");

  Plan boasting = plan;
  *boasting.certificate.proof.lower_bound *= 1.001;
  CHECK(failures(boasting).find("proof_bound ") != std::string::npos);
  Plan nearer = plan;
  *nearer.certificate.proof.gap /= 2;
  CHECK(failures(nearer).find("proof_bound_statement") != std::string::npos);
  Plan other = plan;
  std::string& words = other.certificate.proof.statement;
  words.replace(words.find(" has a"), 6, " can a");
  CHECK(failures(other).find("proof_bound_statement") != std::string::npos);

  // As if the good candidates had not been found: the search of the audit finds better ones.
  Plan worse = plan;
  double best = kInfinity;
  for (const Candidate& candidate : plan.candidates) best = std::min(best, candidate.value);
  worse.certificate.proof.lower_bound = 1.5 * best;
  CHECK(failures(worse).find("proof_bound_searched") != std::string::npos);
}

TEST_CASE("where a case leaves single postures only these can be below the bound") {
  CaptureProblem problem = without_path("planar_two_link_c2_a");
  problem.measure.kind = RiskMeasure::WorstCase;
  Plan plan = make_plan(problem);
  CAPTURE(plan.certificate.proof.statement);
  REQUIRE(plan.certificate.proof.lower_bound.value_or(0) > 0);
  CHECK(failures(plan) == "");
  *plan.certificate.proof.lower_bound *= 1.5;
  CHECK(failures(plan).find("proof_bound_searched") != std::string::npos);
}

}  // namespace stillbase
