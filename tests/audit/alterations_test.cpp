// Altered plans, their fingerprint made right: each is refused, or the altered field is named among
// those that only a repeated search can confirm.
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

using Json = nlohmann::ordered_json;

struct Alteration {
  const char* field;  ///< as the search record names it
  std::function<void(Json&)> apply;
};

Json& certificate(Json& plan) { return plan.at("certificate"); }
Json& proof(Json& plan) { return plan.at("certificate").at("proof"); }
Json& nominal(Json& plan) { return plan.at("objective").at("nominal_optimum"); }
Json& candidate(Json& plan) { return plan.at("candidates").at(1); }
Json& curve(Json& plan) { return plan.at("families").at(0); }
Json& approach(Json& plan) { return plan.at("approach"); }

void scale(Json& number, double factor = 1 + 1e-6) { number = number.get<double>() * factor; }
void add(Json& number, int more) { number = number.get<int>() + more; }

const std::vector<Alteration>& alterations() {
  static const std::vector<Alteration> all = {
      {"status", [](Json& p) { p.at("status") = "feasible"; }},
      {"status", [](Json& p) { p.at("status") = "infeasible"; }},
      {"status", [](Json& p) { p.at("status") = "limit"; }},
      {"optimizer", [](Json& p) { p.at("optimizer") = "nlopt-cobyla"; }},
      {"nominal_optimum", [](Json& p) { p.at("objective").at("nominal_optimum") = nullptr; }},
      {"station", [](Json& p) { nominal(p).at("base_pose").at("position").at(0) = 1e300; }},
      {"station", [](Json& p) { nominal(p).at("base_pose").at("position").at(1) = 0.3; }},
      {"attitude",
       [](Json& p) {
         nominal(p).at("base_pose").at("orientation") = {{"w", 0}, {"x", 1}, {"y", 0}, {"z", 0}};
       }},
      {"time", [](Json& p) { nominal(p).at("contact_time") = 1e6; }},
      {"time", [](Json& p) { scale(nominal(p).at("contact_time")); }},
      {"posture", [](Json& p) { scale(nominal(p).at("joint_positions").at(1)); }},
      {"nominal", [](Json& p) { nominal(p).at("nominal") = 1e-3; }},
      {"worst case", [](Json& p) { scale(nominal(p).at("worst_case")); }},
      {"value", [](Json& p) { scale(nominal(p).at("value")); }},
      {"certificate.kkt_residual", [](Json& p) { certificate(p).at("kkt_residual") = 0; }},
      {"certificate.kkt_residual", [](Json& p) { certificate(p).at("kkt_residual") = 9e-7; }},
      {"kkt", [](Json& p) { certificate(p).at("kkt_residual") = 2e-6; }},
      {"kkt", [](Json& p) { certificate(p).at("kkt_residual") = nullptr; }},
      {"curvature", [](Json& p) { certificate(p).at("reduced_hessian_min_eigenvalue") = 12.5; }},
      {"max_violation", [](Json& p) { certificate(p).at("max_violation") = 5e-10; }},
      {"distinct", [](Json& p) { add(certificate(p).at("distinct_solutions"), 1); }},
      {"distinct", [](Json& p) { add(certificate(p).at("distinct_solutions"), -1); }},
      {"distinct", [](Json& p) { certificate(p).at("distinct_solutions") = 5000; }},
      {"certificate.starts", [](Json& p) { add(certificate(p).at("starts"), 1); }},
      {"starts", [](Json& p) { add(certificate(p).at("starts"), -1); }},
      {"starts", [](Json& p) { certificate(p).at("starts") = 0; }},
      {"certificate.unseen", [](Json& p) { certificate(p).at("unseen") = 0.5; }},
      {"had_rounds", [](Json& p) { certificate(p).at("had_rounds") = true; }},
      {"proof.status", [](Json& p) { proof(p).at("status") = "complete"; }},
      {"proof.status", [](Json& p) { proof(p).at("status") = "undecided"; }},
      {"proof.statement", [](Json& p) { proof(p).at("statement") = "proven: trust me"; }},
      {"proof.found_by_search", [](Json& p) { proof(p).at("found_by_search") = 3; }},
      {"proof.boxes", [](Json& p) { proof(p).at("boxes") = 1000; }},
      {"proof.lower_bound", [](Json& p) { proof(p).at("lower_bound") = 1e-3; }},
      {"proof.gap", [](Json& p) { proof(p).at("gap") = 0; }},
      {"candidates.starts_reached", [](Json& p) { add(candidate(p).at("starts_reached"), 1); }},
      {"starts_reached", [](Json& p) { candidate(p).at("starts_reached") = 100000; }},
      {"candidates.max_violation", [](Json& p) { candidate(p).at("max_violation") = 3e-9; }},
      {"max_violation", [](Json& p) { candidate(p).at("max_violation") = 1e-3; }},
      {"candidate", [](Json& p) { scale(candidate(p).at("worst_case")); }},
      {"candidate", [](Json& p) { candidate(p).at("collision_free") = false; }},
      {"candidate", [](Json& p) { candidate(p).at("judged") = false; }},
      {"candidates", [](Json& p) { p.at("candidates").erase(1); }},
      {"candidates", [](Json& p) { p.at("candidates").push_back(p.at("candidates").at(1)); }},
      {"families.length", [](Json& p) { scale(curve(p).at("length"), 1.01); }},
      {"families.length", [](Json& p) { scale(curve(p).at("length"), 0.999); }},
      {"families.closed", [](Json& p) { curve(p).at("closed") = true; }},
      {"families.complete",
       [](Json& p) { curve(p).at("complete") = !curve(p).at("complete").get<bool>(); }},
      {"families.starts", [](Json& p) { add(curve(p).at("starts"), 1); }},
      {"families", [](Json& p) { curve(p).at("points").erase(2); }},
      {"solver_calls", [](Json& p) { add(p.at("solver_calls").at("sqp"), 7); }},
      {"solver_calls", [](Json& p) { p.at("solver_calls").at("sqp") = 1; }},
      {"solver_calls", [](Json& p) { p.at("solver_calls")["nlopt-cobyla"] = 2; }},
      {"constraints", [](Json& p) { p.at("constraints").erase(0); }},
      {"constraints", [](Json& p) { p.at("constraints").clear(); }},
      {"constraints", [](Json& p) { p.at("constraints").at(0).at("name") = "hand"; }},
      {"approach.polish.before", [](Json& p) { approach(p).at("polish").at("before") = 2; }},
      {"polish", [](Json& p) { approach(p).at("polish").at("after") = 1; }},
      {"approach.detail", [](Json& p) { approach(p).at("detail") = "by hand"; }},
      {"min_clearance", [](Json& p) { approach(p).at("min_clearance") = 0.5; }},
      {"effort_used", [](Json& p) { scale(approach(p).at("effort_used")); }},
      {"names", [](Json& p) { p.at("configuration").at("joint_names").at(0) = "elbow"; }},
      {"objective.name", [](Json& p) { p.at("objective").at("name") = "base_energy"; }},
  };
  return all;
}

/// Fields of the search record that nothing confirms.
std::string unverified(const Plan& plan) {
  VerifyOptions options;
  options.post_impact = false;
  options.prover = nullptr;
  options.cone_samples = 200;
  std::string text;
  for (const Claim& claim : audit_plan(plan, options).claims) {
    if (!claim.is_checked) text += claim.detail + "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("every altered plan is refused, or the field is one that nothing confirms") {
  CaptureProblem problem = test::shipped("planar_three_link_client");
  problem.post_impact.controllers.clear();
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  REQUIRE(plan.candidates.size() > 2);
  REQUIRE(!plan.families.empty());
  REQUIRE(failures(plan) == "");
  const std::string open = unverified(plan);
  CHECK(open.find("not verified: the search's own record") != std::string::npos);
  const Json text = Json::parse(plan_to_json(plan, {}));
  CHECK(alterations().size() >= 48);
  for (const Alteration& alteration : alterations()) {
    Json altered = text;
    alteration.apply(altered);
    INFO(alteration.field << "\n" << altered.diff(text, altered).dump().substr(0, 300));
    REQUIRE(altered != text);
    try {
      const PlanFile file = read_plan(altered.dump(), "altered.json");
      const bool is_named = unverified(file.plan).find(alteration.field) != std::string::npos;
      CHECK((!failures(file.plan).empty() || is_named));
    } catch (const InputError&) {
      SUCCEED("refused on reading");
    }
  }
}

TEST_CASE(
    "that no better candidate is missing is not verified but where nothing better is possible") {
  const auto names_optimum = [](const Plan& plan) {
    return unverified(plan).find("choice.better") != std::string::npos;
  };
  CaptureProblem problem = test::without_path("planar_three_link_client");
  problem.search.starts = 16;
  CHECK(names_optimum(make_plan(problem)));
  problem.measure.kind = RiskMeasure::Nominal;
  Plan zero = make_plan(problem);
  REQUIRE(zero.objective.value < 1e-12);
  CHECK_FALSE(names_optimum(zero));
  zero.choice.better = 1;
  CHECK(names_optimum(zero));
  CHECK_FALSE(names_optimum(make_plan(test::without_path("planar_two_link_c2_a"))));  // enclosed
  Plan bounded = make_plan(test::without_path("planar_three_link_null"));
  CHECK_FALSE(names_optimum(bounded));
  *bounded.certificate.proof.lower_bound *= 0.9;
  CHECK(names_optimum(bounded));
}

TEST_CASE("the stated probability of a better minimum fits the rounds of starts and the status") {
  CaptureProblem problem = test::without_path("servicer_6dof_held");
  problem.post_impact.controllers.clear();
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  REQUIRE(plan.status == PlanStatus::Optimal);
  REQUIRE(plan.certificate.had_rounds);
  REQUIRE(plan.certificate.unseen <= 0.05);
  REQUIRE(failures(plan) == "");
  const auto failing = [&](const std::function<void(Plan&)>& change) {
    Plan altered = plan;
    change(altered);
    return failures(altered);
  };
  CHECK(failing([](Plan& p) { p.certificate.had_rounds = false; }) == "search_record ");
  // exp(-k), of no whole k.
  CHECK(failing([](Plan& p) { p.certificate.unseen = 0.04; }) == "search_record ");
  CHECK(failing([](Plan& p) { p.certificate.unseen = 0; }) == "search_record ");
  // Two starts at the best minimum are too few for an optimum.
  const double few = std::exp(-2.0);
  CHECK(failing([&](Plan& p) { p.certificate.unseen = few; }) == "search_record ");
  CHECK(failing([&](Plan& p) {
          p.certificate.unseen = few;
          p.status = PlanStatus::Feasible;
        }) == "");
}

}  // namespace stillbase
