// Plans that state more of their optimum than holds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"
#include "verification/residual_velocity.hpp"

namespace stillbase {
namespace {

/// What a random search found, marked as an optimum with a bound that nobody proved.
Plan boasting_plan() {
  CaptureProblem problem = test::without_path("servicer_6dof_held");
  problem.search.optimizer = "random-search";
  problem.search.starts = 2;
  Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Feasible);
  plan.status = PlanStatus::Optimal;
  plan.certificate.kkt_residual = 1e-9;
  return plan;
}

}  // namespace

TEST_CASE("a random configuration with an invented KKT residual is no optimum") {
  CHECK(failures(boasting_plan()).find("kkt_residual") != std::string::npos);
}

TEST_CASE("a bound over more variables than a proof takes is refused") {
  Plan plan = boasting_plan();
  Proof& proof = plan.certificate.proof;
  double least = plan.objective.value;
  for (const Candidate& candidate : plan.candidates) least = std::min(least, candidate.value);
  proof.lower_bound = 0.99 * least;
  proof.gap = least - *proof.lower_bound;
  proof.boxes = 1000;
  proof.statement = "proven: no configuration has a worst case below that";
  CHECK(failures(plan).find("proof_bound_statement") != std::string::npos);
}

TEST_CASE("the KKT residual of an optimum is confirmed by differences, for every measure") {
  const std::string name =
      GENERATE("servicer_6dof_held", "iiwa_cone", "iiwa_mean", "planar_three_link_cvar",
               "planar_three_link_null", "spart_given_push", "servicer_compromise");
  CaptureProblem problem = test::without_path(name);
  problem.search.starts = 8;
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(problem, options);
  INFO(name);
  // A better candidate may collide: then the status is feasible all the same.
  REQUIRE(plan.certificate.kkt_residual <= 1e-6);
  CHECK(failures(plan).find("kkt_residual") == std::string::npos);
  CHECK(failures(plan).find("reduced_curvature") == std::string::npos);
}

TEST_CASE("the conditions of a zero under a narrow cone are left open") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.uncertainty.cone_half_angle = 1e-3 * kPi / 180;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  REQUIRE(plan.objective.nominal < 0.01 * plan.objective.worst_case);
  CHECK(failures(plan) == "");
}

TEST_CASE("a misstated curvature is found") {
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(test::without_path("spart_given_push"), options);
  auto& curvature = plan.certificate.reduced_hessian_min_eigenvalue;
  REQUIRE(curvature);
  REQUIRE(failures(plan).find("reduced_curvature") == std::string::npos);
  const double stated = *curvature;
  curvature = 1.1 * stated;
  CHECK(failures(plan).find("reduced_curvature") != std::string::npos);
  curvature = -stated;
  CHECK(failures(plan).find("reduced_curvature") != std::string::npos);
  curvature.reset();
  CHECK(failures(plan).find("reduced_curvature") != std::string::npos);
}

TEST_CASE("a limit that decides is neither left out nor renamed nor misstated") {
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(test::without_path("planar_three_link_station"), options);
  REQUIRE(plan.binding.size() == 2);
  REQUIRE(failures(plan).find("binding") == std::string::npos);
  const auto fails = [&](const char* name, const std::function<void(Plan&)>& change) {
    Plan altered = plan;
    change(altered);
    return failures(altered).find(name) != std::string::npos;
  };
  CHECK(fails("binding_limits", [](Plan& p) { p.binding.clear(); }));
  for (std::size_t i = 0; i < plan.binding.size(); ++i) {
    INFO(plan.binding[i].name);
    CHECK(fails("binding_limits", [i](Plan& p) {
      p.binding.erase(p.binding.begin() + static_cast<std::ptrdiff_t>(i));
    }));
    CHECK(fails("binding_limits", [i](Plan& p) { p.binding[i].name = "base_x"; }));
    CHECK(fails("binding_limits", [i](Plan& p) { p.binding[i].margin = 1e-3; }));
  }
  for (std::size_t i = 0; i < plan.binding.size(); ++i) {
    for (const double factor : {1.05, 0.95, 5.0, 0.01}) {
      CHECK(fails("binding_", [i, factor](Plan& p) { p.binding[i].multiplier *= factor; }));
    }
    CHECK(fails("binding_limits", [i](Plan& p) { p.binding[i].value += 1e-6; }));
    CHECK(fails("binding_limits", [i](Plan& p) { p.binding[i].unit += "s"; }));
    CHECK(fails("binding_limits", [i](Plan& p) { p.binding.push_back(p.binding[i]); }));
  }
  CHECK(fails("binding_limits", [](Plan& p) { std::reverse(p.binding.begin(), p.binding.end()); }));
  CHECK(fails("binding_limits", [](Plan& p) {
    p.binding.push_back({"joint_2", true, p.problem.robot.joints[1].upper, 0, 1e-9, "rad"});
  }));
}

TEST_CASE("multipliers of attitudes and of distances between bodies are recomputed") {
  CaptureProblem problem = test::without_path("deos_latch");
  problem.objective.front().quantity = ObjectiveQuantity::JointRateNorm;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  const auto has = [&](const std::string& begin) {
    return std::any_of(plan.binding.begin(), plan.binding.end(),
                       [&](const BindingLimit& limit) { return limit.name.rfind(begin, 0) == 0; });
  };
  REQUIRE(has("clearance_"));
  REQUIRE(has("base_attitude"));
  REQUIRE(failures(plan).find("binding") == std::string::npos);
  for (std::size_t i = 0; i < plan.binding.size(); ++i) {
    INFO(plan.binding[i].name);
    for (const double factor : {5.0, 2.0, 0.5, 0.01}) {
      Plan altered = plan;
      altered.binding[i].multiplier *= factor;
      CHECK_THAT(failures(altered), Catch::Contains("binding_multipliers"));
    }
    Plan altered = plan;
    altered.binding.erase(altered.binding.begin() + static_cast<std::ptrdiff_t>(i));
    CHECK_THAT(failures(altered), Catch::Contains("binding_limits"));
  }
}

TEST_CASE("multipliers that nothing recomputes are left open by name") {
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(test::without_path("planar_three_link_station"), options);
  REQUIRE(plan.binding.size() == 2);
  // The objective of a user is no part of the file.
  plan.objective.user_terms = {"mine"};
  VerifyOptions judge;
  judge.post_impact = false;
  judge.prover = nullptr;
  const auto claims = audit_plan(plan, judge).claims;
  const auto open = std::find_if(claims.begin(), claims.end(), [](const Claim& claim) {
    return claim.name == "binding_multipliers";
  });
  REQUIRE(open != claims.end());
  CHECK_FALSE(open->is_checked);
  for (const BindingLimit& limit : plan.binding) {
    CHECK_THAT(open->detail, Catch::Contains(limit.name));
  }
}

TEST_CASE("a feasible configuration states the size of its KKT residual") {
  CaptureProblem problem = test::without_path("servicer_6dof_held");
  problem.search.optimizer = "random-search";
  problem.search.starts = 2;
  Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Feasible);
  CHECK(failures(plan).find("kkt_residual") == std::string::npos);
  plan.certificate.kkt_residual = 2e-5;
  CHECK(failures(plan).find("kkt_residual") != std::string::npos);
}

namespace {

/// What is said of the first-order conditions.
std::string said(const Plan& plan) {
  VerifyOptions judge;
  judge.post_impact = false;
  judge.prover = nullptr;
  for (const Claim& claim : judge_plan(plan, judge).claims) {
    if (claim.name == "kkt_residual") {
      return claim.fails() ? "fails: " + claim.detail : claim.detail;
    }
  }
  return "nothing";
}

}  // namespace

TEST_CASE("a minimum where a corner and two edges of boxes are equally near is one") {
  CaptureProblem problem = test::without_path("deos_latch_residual");
  PlannerOptions options;
  options.prover = nullptr;
  // Rounding decides whether a seed comes to the last digits of the kink: two of five do.
  Plan plan;
  for (problem.search.seed = 1; problem.search.seed <= 20; ++problem.search.seed) {
    plan = make_plan(problem, options);
    if (plan.status == PlanStatus::Optimal) break;
  }
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK_THAT(said(plan), Catch::StartsWith("first-order conditions"));
  // One of the three alone does not make it a minimum, which is what a search may state.
  plan.status = PlanStatus::Feasible;
  plan.certificate.kkt_residual = 0.26;
  CHECK_THAT(said(plan), Catch::StartsWith("not verified"));
  plan.status = PlanStatus::Optimal;
  plan.certificate.kkt_residual = 0;
  // Off the minimum the conditions do not hold to any side: they fail, or are left open where it
  // ends at another kink.
  int failed = 0;
  for (const int joint : {1, 2, 3, 4, 5}) {
    for (const double step : {-1e-3, 1e-3}) {
      Plan beside = plan;
      beside.configuration.phi[joint] += step;
      const std::string words = said(beside);
      INFO("joint " << joint << " by " << step << ": " << words);
      CHECK_THAT(words, !Catch::StartsWith("first-order conditions"));
      failed += words.rfind("fails", 0) == 0 ? 1 : 0;
    }
  }
  CHECK(failed >= 2);
}

TEST_CASE("an invented minimum at a kink of a limit fails, a feasible configuration is left open") {
  CaptureProblem problem = test::without_path("deos_latch_residual");
  // The box about a cylinder has its widest gap, and that a kink where faces are parallel.
  const auto& box = std::get<Box>(problem.target->shapes.front().geometry);
  problem.target->shapes.front().geometry = Cylinder{box.size.x() / 2, box.size.z()};
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(problem, options);
  // Two corners of the base's box are equally far from the target's end: no slope counts as the
  // limit's.
  CHECK_THAT(said(plan), Catch::Contains("no gradient here"));
  // The search may have come as near to a minimum between the sides as differences show. One of
  // another quantity is invented, and none with the slopes of either side.
  plan.status = PlanStatus::Optimal;
  plan.certificate.kkt_residual = 1e-9;
  plan.problem.objective.front().quantity = ObjectiveQuantity::ImpulseMagnitude;
  CHECK_THAT(said(plan), Catch::StartsWith("fails"));
}

TEST_CASE("the steps of differences are shortened beside a singular posture") {
  // A joint's rate before the contact is at its limit where the arm is nearly straight.
  CaptureProblem problem = test::without_path("matched_medium");
  problem.objective.front().quantity = ObjectiveQuantity::BaseMomentum;
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(problem, options);
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK_THAT(said(plan), Catch::StartsWith("first-order conditions"));
  plan.configuration.phi[1] += 1e-3;
  CHECK_THAT(said(plan), Catch::StartsWith("fails"));
}

TEST_CASE("a minimum where the two ends of a segment of velocities are equally bad is one") {
  CaptureProblem problem = test::without_path("matched_residual");
  problem.measure.kind = RiskMeasure::WorstCase;
  Matrix6d& covariance = problem.uncertainty.residual_velocity->covariance.emplace();
  covariance.setZero();
  covariance(0, 0) = 4e-6;
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(problem, options);
  REQUIRE(plan.status == PlanStatus::Optimal);
  const verification::Situation at(plan.problem, plan.configuration);
  const verification::ResidualCase residual = verification::residual_case(at);
  const auto ends = verification::local_maxima(residual);
  const double worst = residual.square(residual.at(ends[0]));
  REQUIRE(residual.square(residual.at(ends[1])) == Approx(worst).epsilon(1e-6));
  REQUIRE(residual.square(residual.velocity) < 0.99 * worst);
  CHECK_THAT(said(plan), Catch::StartsWith("first-order conditions"));
  // Where the nominal value is least both ends are equally bad too, and no minimum.
  REQUIRE(plan.nominal_optimum);
  plan.configuration = plan.nominal_optimum->configuration;
  CHECK_THAT(said(plan), Catch::StartsWith("fails"));
}

namespace {

/// A latch with a matched hand, for the mean over a stated covariance of what is left.
CaptureProblem matched_problem(double linear_variance, double angular_variance) {
  CaptureProblem problem = test::without_path("matched_residual");
  Vector6d variances;
  variances << Vector3d::Constant(linear_variance), Vector3d::Constant(angular_variance);
  problem.uncertainty.residual_velocity->covariance = variances.asDiagonal();
  return problem;
}

}  // namespace

TEST_CASE("limits of two bodies with a common end restrict once") {
  PlannerOptions options;
  options.prover = nullptr;
  Plan plan = make_plan(matched_problem(9e-4, 9e-4), options);
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK(failures(plan).find("reduced_curvature") == std::string::npos);
  *plan.certificate.reduced_hessian_min_eigenvalue += 0.1;
  CHECK(failures(plan).find("reduced_curvature") != std::string::npos);
}

TEST_CASE("a limit that nothing changes takes no part in the first-order conditions") {
  // Links 4 and 6 are 0.025 m apart at every posture, which is the clearance: the limit is reached,
  // and its slopes are rounding, another one at each posture.
  CaptureProblem problem = test::without_path("ets7_envisat_fast");
  problem.search.optimizer = "random-search";
  problem.search.starts = 2;
  for (int seed = 0; seed < 12; ++seed) {
    problem.search.seed = seed;
    const Plan plan = make_plan(problem);
    REQUIRE(plan.status == PlanStatus::Feasible);
    REQUIRE(plan.certificate.kkt_residual > 1e-3);
    const std::string found = said(plan);
    CAPTURE(seed, found);
    CHECK(found.find("fails") == std::string::npos);
    CHECK(found.find("relative: first-order conditions by differences") != std::string::npos);
  }
}

TEST_CASE("a limit without a value on one side of the configuration leaves the conditions open") {
  CaptureProblem problem = matched_problem(1, 1e-12);
  problem.search.starts = 16;
  CHECK(failures(make_plan(problem)).find("kkt_residual") == std::string::npos);
}

}  // namespace stillbase
