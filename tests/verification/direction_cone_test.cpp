#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/audit/audit.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/left_out.hpp>

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

/// Whether the plan passes a check of its warnings; empty: there is no such check.
std::optional<bool> passes(const Plan& plan, const std::string& name) {
  for (const Claim& claim : cone_claims(plan)) {
    if (claim.name == name) return claim.pass;
  }
  return std::nullopt;
}

/// Codes of what the plan's problem leaves out, each with a space behind it.
std::string codes(const Plan& plan) {
  std::string out;
  for (const LeftOut& one : left_out(plan.problem)) out += one.code + " ";
  return out;
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

TEST_CASE("the ball of the contact point has closed forms and holds its part of the samples") {
  Plan plan = uncertain_plan(0.95);
  CaptureProblem& problem = plan.problem;
  problem.target_state.angular_velocity.setZero();
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 10;
  EstimateDeviations& sigma = problem.target_deviations.emplace();
  CHECK(contact_radius(problem, 0.95) == 0);
  sigma.position = Vector3d(0.02, 0, 0);
  CHECK(contact_radius(problem, 0.95) == Approx(0.02 * 1.959963985).epsilon(2e-3));
  sigma.position = Vector3d(0, 0.02, 0.02);
  CHECK(contact_radius(problem, 0.95) ==
        Approx(0.02 * std::sqrt(-2 * std::log(0.05))).epsilon(2e-3));
  // Maxwell's distribution.
  sigma.position.setConstant(0.02);
  CHECK(contact_radius(problem, 0.95) == Approx(0.02 * 2.795483482).epsilon(1e-6));
  CHECK(contact_radius(problem, 0.5) == Approx(0.02 * 1.538172254).epsilon(1e-6));
}

TEST_CASE("a plan says that a residual velocity does not count the error of the normal") {
  Plan plan = uncertain_plan(0.95);
  plan.problem.uncertainty = {};
  CHECK_FALSE(passes(plan, "normal_warning"));
  plan.problem.uncertainty.residual_velocity.emplace();
  CHECK(codes(plan) == "fixed-normal ");
  CHECK(passes(plan, "normal_warning") == false);
  plan.warnings = {{"fixed-normal", "the normal is open"}};
  CHECK(passes(plan, "normal_warning") == true);
  // Known well enough.
  *plan.problem.target_deviations = {};
  plan.problem.target_deviations->orientation.setConstant(1e-3);
  CHECK(codes(plan) == "");
  CHECK(passes(plan, "normal_warning") == false);
  plan.warnings.clear();
  CHECK(passes(plan, "normal_warning") == true);
}

TEST_CASE("a plan says that trials do not count a latch that misses") {
  Plan plan = uncertain_plan(0.95);
  plan.problem.uncertainty = {};
  plan.problem.uncertainty.residual_velocity.emplace();
  plan.problem.impulse.contact = ContactLaw::Latch;
  plan.problem.impulse.restitution = 0;
  CHECK(codes(plan) == "");
  CHECK(passes(plan, "estimate_warning") == true);
  const EstimateDeviations known = *plan.problem.target_deviations;
  EstimateDeviations& sigma = *plan.problem.target_deviations;
  for (const bool is_far : {true, false}) {
    INFO("far " << is_far);
    sigma = known;
    if (is_far) sigma.position.setConstant(0.06);
    if (!is_far) sigma.orientation.setConstant(0.3);
    CHECK(codes(plan) == "wide-estimate ");
    CHECK(passes(plan, "estimate_warning") == false);
    plan.warnings = {{"wide-estimate", "the contact is open"}};
    CHECK(passes(plan, "estimate_warning") == true);
    plan.warnings.clear();
  }
  // Of a hand that waits the contact is where the feature is.
  plan.problem.impulse.contact = ContactLaw::Sticking;
  CHECK(codes(plan) == "");
  CHECK_FALSE(passes(plan, "estimate_warning"));
}
