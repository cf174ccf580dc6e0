// The words of a proof say what the other fields of the plan say, and no more.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

bool is_refused(const Plan& plan) {
  return failures(plan).find("proof_statement") != std::string::npos;
}

/// The plan with other words in its statement.
Plan with_words(Plan plan, const std::string& from, const std::string& to) {
  std::string& text = plan.certificate.proof.statement;
  const std::size_t at = text.find(from);
  CAPTURE(text, from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(), to);
  return plan;
}

Plan with_statement(Plan plan, const std::string& statement) {
  plan.certificate.proof.statement = statement;
  return plan;
}

const std::string kNoLess = "; the best one is zero, no less is possible";

}  // namespace

TEST_CASE("a statement of enclosed solutions says nothing but their number") {
  const Plan plan = make_plan(test::without_path("planar_two_link_c2_a"));
  const std::string text = plan.certificate.proof.statement;
  REQUIRE(text == "proven complete: 8 solutions enclosed, none missed");
  REQUIRE(failures(plan) == "");
  for (const std::string more :
       {"; the path is free of collision", "; no posture has a worst case below 3.3 N m s",
        "; no posture has a predicted base_angular_momentum below 1e-3 N m s", ".", ", none missed",
        kNoLess.c_str(),
        " (3 others beyond the limits on rates, singular values or clearances; "
        "judged at their middles)"}) {
    INFO(more);
    CHECK(is_refused(with_statement(plan, text + more)));
  }
  CHECK(is_refused(with_words(plan, ", none missed", "")));
  CHECK(
      is_refused(with_words(plan, ", none missed", ", 1 of them missed by the search and added")));
  CHECK(is_refused(with_words(plan, "8 solutions", "08 solutions")));
}

TEST_CASE("the numbers of a stated bound are those of its fields") {
  const Plan plan = make_plan(test::without_path("planar_three_link_null"));
  const std::string text = plan.certificate.proof.statement;
  REQUIRE(text.find("; no posture has a worst case below 1.67") != std::string::npos);
  REQUIRE(failures(plan) == "");
  const std::string bound = text.substr(text.find("below "));
  for (const std::string other :
       {"below 9.9e-05 rad/s (best candidate 1.678e-05, gap 0.061 %)",
        "below 1.676e-05 rad/s (best candidate 1.678e-05, gap 0 %)",
        "below 1.676e-05 rad/s (best candidate 1.677e-05, gap 0.061 %)",
        "below 1.676e-05 N m s (best candidate 1.678e-05, gap 0.061 %)", "below that"}) {
    INFO(text << "\n" << other);
    CHECK(is_refused(with_words(plan, bound, other)));
  }
  CHECK(is_refused(with_words(plan, "no posture has", "no configuration has")));
  CHECK(is_refused(with_statement(plan, text + ", not counting clearances")));
  CHECK(is_refused(with_statement(plan, text + kNoLess)));
  Plan lower = plan;
  *lower.certificate.proof.lower_bound *= 0.99;
  *lower.certificate.proof.gap = plan.certificate.proof.gap.value() +
                                 plan.certificate.proof.lower_bound.value() -
                                 lower.certificate.proof.lower_bound.value();
  CHECK(failures(lower) == "proof_statement ");
  Plan without = plan;
  without.certificate.proof.lower_bound.reset();
  without.certificate.proof.gap.reset();
  CHECK(is_refused(without));
}

TEST_CASE("constraints that a bound does not count are named, all of them") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.constraints.coupling_singular_value_min = 1e-6;
  const Plan plan = make_plan(problem);
  CAPTURE(plan.certificate.proof.statement);
  REQUIRE(failures(plan) == "");
  CHECK(is_refused(with_words(plan, ", not counting singular values", "")));
  CHECK(
      is_refused(with_words(plan, ", not counting singular values", ", not counting joint rates")));
}

TEST_CASE("where nothing is proven the statement gives a reason that holds") {
  CaptureProblem problem = test::without_path("planar_three_link_client");
  problem.search.starts = 16;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.certificate.proof.statement ==
          "no proof: it takes one to three free variables, here are 5");
  REQUIRE(failures(plan) == "");
  for (const std::string other :
       {"no proof: but nothing has less than 0.01 N m s",
        "no proof: it takes one to three free variables, here are 4",
        "no proof: it takes one to three free joints, here are 5",
        "no proof: some joints follow others", "no proof: there are several contact features",
        "no proof: functions of the user are not enclosed",
        "no proof: 4 equations for 6 free variables, so the solutions are not isolated points",
        "no proof: the robot has more than 8 joints",
        "no proof: the base attitude is free about more than one axis", "no proof: ", ""}) {
    INFO(other);
    CHECK(is_refused(with_statement(plan, other)));
  }
  const std::string text = plan.certificate.proof.statement;
  CHECK(is_refused(with_statement(plan, text + kNoLess)));
  CHECK(is_refused(with_statement(plan, text + "; no bound for a predicted base_energy")));
  CHECK(is_refused(with_statement(plan, text + ", for now")));

  problem.measure.kind = RiskMeasure::Nominal;
  const Plan zero = make_plan(problem);
  REQUIRE(zero.certificate.proof.statement == text + kNoLess);
  CHECK(failures(zero) == "");
}

TEST_CASE("the prover repeats why nothing is proven") {
  CaptureProblem problem = test::without_path("planar_three_link_client");
  problem.search.starts = 4;
  const Plan plan = make_plan(problem);
  const auto repeated = [](const Plan& judged) {
    for (const Claim& claim : audit_plan(judged).claims) {
      if (claim.name == "proof_repeated") return claim.pass;
    }
    return false;
  };
  CHECK(repeated(plan));
  CHECK_FALSE(repeated(with_words(plan, "it takes one to three free variables, here are 5",
                                  "4 equations for 5 free variables, so the solutions are not "
                                  "isolated points")));
}

}  // namespace stillbase
