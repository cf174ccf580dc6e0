// The motion of the target after the contact is a check, by `reference`.
#include <set>

#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/encounter/encounter.hpp>

#include "verification/example_plans.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

std::optional<Claim> claim_of(const Plan& plan, const std::string& name) {
  VerifyOptions options;
  options.cone_samples = 100;
  for (const Claim& claim : judge_plan(plan, options).claims) {
    if (claim.name == name) return claim;
  }
  return std::nullopt;
}

/// The arm's plan without its approach, which has nothing to do with the target.
Plan waiting_plan() {
  Plan plan = arm_plan();
  plan.problem.approach.enabled = false;
  return plan;
}

}  // namespace

TEST_CASE("an elastic target bounces off with its closing speed") {
  const auto claim = claim_of(straight_plan(), "target_fate");
  REQUIRE(claim);
  CHECK(claim->pass);
  CHECK(*claim->value == Approx(1).epsilon(1e-9));
  CHECK(claim->limit == Approx(1));
  CHECK(claim->unit == "m/s");
  CHECK(claim->detail.find("bounced") == 10);  // after "at least: "
}

TEST_CASE("a target that leaves without restitution stays at the hand") {
  Plan plan = straight_plan();
  plan.problem.impulse.restitution = 0;
  const auto claim = claim_of(plan, "target_fate");
  REQUIRE(claim);
  CHECK(claim->pass);
  CHECK(std::abs(*claim->value) < 1e-12);
  CHECK(claim->detail.find("stays at the hand") != std::string::npos);
}

TEST_CASE("a given impulse has no check of a target") {
  Plan plan = straight_plan();
  plan.problem.impulse.source = ImpulseSource::Given;
  CHECK_FALSE(claim_of(plan, "target_fate"));
}

TEST_CASE("a compliant contact keeps both momenta and about the restitution") {
  Plan plan = waiting_plan();
  plan.problem.post_impact.contact.model = ContactModel::Compliant;
  plan.problem.post_impact.contact.stiffness = 1e6;
  const auto claim = claim_of(plan, "target_fate");
  REQUIRE(claim);
  INFO(claim->detail);
  CHECK(claim->pass);
  CHECK(*claim->value == Approx(0.3 * plan.impact.closing_speed).epsilon(0.05));
  CHECK(claim->detail.find("contact") != std::string::npos);
  for (const char* name : {"post_impact_linear_momentum", "post_impact_angular_momentum"}) {
    const auto momentum = claim_of(plan, name);
    REQUIRE(momentum);
    CHECK(momentum->pass);
  }
}

TEST_CASE("a latched target is held, and its momentum is kept") {
  Plan plan = waiting_plan();
  plan.problem.impulse.contact = ContactLaw::Latch;
  plan.problem.impulse.restitution = 0;
  for (const char* name : {"target_fate", "latch_momentum", "post_impact_angular_momentum"}) {
    const auto claim = claim_of(plan, name);
    REQUIRE(claim);
    INFO(name << " " << claim->detail);
    CHECK(claim->pass);
  }
  CHECK(claim_of(plan, "target_fate")->detail.find("held: latched") == 0);
}

TEST_CASE("impact, objective and first instant of every contact are recomputed") {
  const ContactLaw law =
      GENERATE(ContactLaw::Frictionless, ContactLaw::Sticking, ContactLaw::Latch);
  Plan plan = waiting_plan();
  plan.problem.impulse.contact = law;
  plan.problem.impulse.restitution = law == ContactLaw::Frictionless ? 0.3 : 0;
  plan.problem.uncertainty.cone_half_angle = 0;
  plan.impact = impact_at(plan.problem, plan.configuration);
  CAPTURE(static_cast<int>(law));
  VerifyOptions options;
  const auto failed = [&](const Plan& judged) {
    std::set<std::string> names;
    for (const Claim& claim : judge_plan(judged, options).claims) {
      if (!claim.pass) names.insert(claim.name);
    }
    return names;
  };
  const std::set<std::string> honest = failed(plan);
  for (const char* name : {"impulse_force", "impulse_moment", "joint_velocity_jump",
                           "coupling_rank", "joint_velocity_rns", "total_angular_momentum",
                           "base_angular_momentum", "coupling_angular_momentum", "case_residuals",
                           "impact_case", "first_instant", "target_fate"}) {
    INFO(name);
    CHECK(honest.count(name) == 0);
    CHECK(claim_of(plan, name));
  }
  if (law == ContactLaw::Sticking) CHECK(claim_of(plan, "contact_pushes")->pass);

  // Numbers of another contact are noticed.
  Plan other = plan;
  other.problem.impulse.contact =
      law == ContactLaw::Latch ? ContactLaw::Sticking : ContactLaw::Latch;
  other.problem.impulse.restitution = 0;
  const std::set<std::string> noticed = failed(other);
  CHECK(noticed.count("impulse_force") == 1);
  CHECK(noticed.count("first_instant") == 1);
  Plan off = plan;
  off.impact.base *= 1 + 1e-7;
  CHECK(failed(off).count("first_instant") == 1);
}
