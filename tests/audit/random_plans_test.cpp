// Plans of random problems: what the planner states is what verification and audit find.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/random_capture.hpp"

namespace stillbase {
namespace {

/// A random capture with another measure, base freedom or choice of features.
CaptureProblem random_variant(std::uint64_t number) {
  CaptureProblem problem = random_capture(number);
  problem.search.starts = 16;
  Random random(77, number);
  switch (number % 6) {
    case 1:
      problem.measure.kind = RiskMeasure::Nominal;
      break;
    case 2:
      problem.measure.kind = RiskMeasure::Cvar;
      problem.measure.samples = 32;
      problem.uncertainty.restitution = 0.05;
      break;
    case 3:
      problem.variables.base_attitude = AttitudeFreedom::Axis;
      problem.variables.base_attitude_axis = random.unit_vector();
      problem.variables.base_attitude_max = random.uniform(0.1, 1);
      break;
    case 4: {
      ContactFeature other = problem.target->features.front();
      other.name = "other";
      other.point += random_vector(random, 0.01, 0.1);
      problem.target->features.push_back(other);
      problem.variables.features = {"feature", "other"};
      break;
    }
    case 5:
      problem.variables.base_attitude = AttitudeFreedom::Cone;
      problem.variables.base_attitude_axis = random.unit_vector();
      problem.variables.base_attitude_max = random.uniform(0.1, 0.6);
      break;
    default:
      break;
  }
  return problem;
}

void hold(std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t number = first; number < end; ++number) {
    const Plan plan = make_plan(random_variant(number));
    std::string failed;
    for (const Claim& claim : judge_plan(plan).claims) {
      if (!claim.fails()) continue;
      failed += fmt::format("\n  {}: {:.4g}, limit {:.4g}, {}", claim.name,
                            claim.value.value_or(kInfinity), claim.limit, claim.detail);
    }
    INFO("problem " << number << ", " << to_string(plan.status) << failed);
    CHECK(plan.status != PlanStatus::Infeasible);
    CHECK(failed.empty());
  }
}

/// STILLBASE_RANDOM_PLANS, "143" or "100-150" with the end left out; else all.
void hold_asked(std::uint64_t all) {
  const char* const asked = std::getenv("STILLBASE_RANDOM_PLANS");
  if (asked == nullptr) return hold(0, all);
  const std::string text = asked;
  const std::size_t dash = text.find('-');
  const std::uint64_t first = std::stoull(text);
  hold(first, dash == std::string::npos ? first + 1 : std::stoull(text.substr(dash + 1)));
}

}  // namespace

TEST_CASE("plans of random problems pass verification and audit") { hold(0, 24); }

TEST_CASE("a curve so short that its ends alone are stated passes the audit") { hold(113, 114); }

TEST_CASE(
    "a solve does not end where a rotation vector of the base reaches a bound of its numbers") {
  hold(143, 144);
}

TEST_CASE("of two joints at their stops a plan may state either one") { hold(34, 35); }

TEST_CASE("worst directions of a value that hardly changes along the rim are known to its slope") {
  hold(71, 72);
  hold(645, 646);
}

TEST_CASE("worst directions of a value that bends within a few degrees are known to its slope") {
  hold(60, 61);
}

TEST_CASE("plans of 300 random problems pass verification and audit", "[.slow]") {
  hold_asked(300);
}

}  // namespace stillbase
