#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/audit/audit.hpp>
#include <stillbase/encounter/direction_cone.hpp>

#include "verification/checks.hpp"
#include "verification/example_plans.hpp"

using namespace stillbase;
using namespace stillbase::verification;
using stillbase::verification_test::arm_plan;

namespace {

/// The check of the cone of a plan, without the other checks.
std::vector<Claim> cone_claims(const Plan& plan) {
  const VerifyOptions options;
  ClaimList claims;
  const Situation situation(plan.problem, plan.configuration);
  check_direction_cone({plan, options, situation, situation.problem}, claims);
  return claims.claims();
}

/// A plan whose target is an uneven body, known with errors of every kind.
Plan uncertain_plan(double confidence) {
  Plan plan = arm_plan();
  CaptureProblem& problem = plan.problem;
  problem.target->inertia = Vector3d(3, 3.5, 4.2).asDiagonal();
  EstimateDeviations sigma;
  sigma.position.setConstant(0.01);
  sigma.orientation = Vector3d(0.02, 0.03, 0.01);
  sigma.linear_velocity.setConstant(1e-4);
  sigma.angular_velocity = Vector3d(5e-4, 1e-3, 2e-4);
  sigma.mass = 0.1;
  sigma.moments = Vector3d(0.01, 0.02, 0.01);
  problem.target_deviations = sigma;
  problem.variables.contact_time_lower = plan.configuration.contact_time - 5;
  problem.variables.contact_time_upper = plan.configuration.contact_time + 5;
  problem.uncertainty.cone_confidence = confidence;
  problem.uncertainty.cone_half_angle = direction_cone(problem, confidence).half_angle;
  return plan;
}

}  // namespace

TEST_CASE("a stated cone has no check against a covariance") {
  CHECK(cone_claims(arm_plan()).empty());
}

TEST_CASE("a cone by weighted points contains the stated part of independent samples") {
  for (const double confidence : {0.5, 0.95, 0.99}) {
    const auto claims = cone_claims(uncertain_plan(confidence));
    REQUIRE(claims.size() == 1);
    INFO(claims[0].detail);
    CHECK(claims[0].name == "direction_cone");
    CHECK(claims[0].pass);
  }
}

TEST_CASE("the wedge of a plane contains the stated part of independent samples") {
  Plan plan = uncertain_plan(0.9);
  CaptureProblem& problem = plan.problem;
  problem.uncertainty.cone_plane_normal = Vector3d(1, 2, 2) / 3;
  problem.uncertainty.cone_half_angle = direction_cone(problem, 0.9).half_angle;
  const auto claims = cone_claims(plan);
  REQUIRE(claims.size() == 1);
  INFO(claims[0].detail);
  CHECK(claims[0].pass);
}

TEST_CASE("a cone that does not follow from the covariance is refused") {
  for (const double factor : {0.0, 0.8, 1.3, 3.0}) {
    Plan plan = uncertain_plan(0.95);
    plan.problem.uncertainty.cone_half_angle *= factor;
    const auto claims = cone_claims(plan);
    REQUIRE(claims.size() == 1);
    INFO(factor << ": " << claims[0].detail);
    CHECK_FALSE(claims[0].pass);
  }
  Plan plan = uncertain_plan(0.95);
  plan.problem.target_deviations->angular_velocity *= 2;
  CHECK_FALSE(cone_claims(plan).front().pass);
  plan.problem.target_deviations.reset();
  const Verification verification = judge_plan(plan);
  const auto claim = std::find_if(verification.claims.begin(), verification.claims.end(),
                                  [](const Claim& c) { return c.name == "direction_cone"; });
  REQUIRE(claim != verification.claims.end());
  CHECK_FALSE(claim->pass);
}
