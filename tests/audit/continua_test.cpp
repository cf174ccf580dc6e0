// What a plan says about the curves that its candidates are on.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

/// Zeros on curves and minima beside them, by the predicted value alone.
const Plan& plan_with_families() {
  static const Plan plan = [] {
    CaptureProblem problem = test::shipped("planar_three_link_client");
    problem.measure.kind = RiskMeasure::Nominal;
    problem.search.max_candidates = 100;
    return make_plan(problem);
  }();
  return plan;
}

/// Of a robust measure: its own minima stand in the list beside the best of each curve.
const Plan& robust_plan() {
  static const Plan plan = [] {
    CaptureProblem problem = test::shipped("planar_three_link_client");
    problem.approach.enabled = false;
    return make_plan(problem);
  }();
  return plan;
}

/// The total momentum of a hand that nothing holds: some of its zeros have the hand at the centroid
/// of the system, where it vanishes along every direction.
CaptureProblem problem_at_centroid() {
  CaptureProblem problem = test::shipped("spart_3dof_point");
  problem.objective = {{ObjectiveQuantity::TotalAngularMomentum}};
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.hand = {};
  problem.constraints.joint_limit_margin = 0;
  problem.approach.enabled = false;
  return problem;
}

bool holds(const Plan& plan, const std::string& name) {
  for (const Claim& claim : judge_plan(plan).claims) {
    if (claim.name == name) return claim.pass;
  }
  return false;
}

}  // namespace

TEST_CASE("a plan with continua of solutions passes, and misstated ones are found") {
  const Plan& plan = plan_with_families();
  REQUIRE(plan.families.size() >= 2);
  CHECK(holds(plan, "families_vanish"));
  CHECK(holds(plan, "candidates_list"));

  Plan more_starts = plan;
  ++more_starts.families[0].starts;
  CHECK_FALSE(holds(more_starts, "candidates_list"));

  // A candidate that no start reached is one of a curve, or it is made up.
  Plan alone = plan;
  alone.candidates[0].family = -1;
  alone.candidates[0].starts_reached = 0;
  CHECK_FALSE(holds(alone, "candidates_list"));

  Plan elsewhere = plan;
  const auto off_zero =
      std::find_if(elsewhere.candidates.begin(), elsewhere.candidates.end(),
                   [](const Candidate& candidate) { return candidate.objective > 1e-4; });
  REQUIRE(off_zero != elsewhere.candidates.end());
  off_zero->family = 0;
  CHECK_FALSE(holds(elsewhere, "families_vanish"));
}

TEST_CASE("points, length and ends of a curve are held against the problem") {
  const Plan& plan = plan_with_families();
  const auto find = [&plan](bool closed) {
    const auto at =
        std::find_if(plan.families.begin(), plan.families.end(), [&](const SolutionFamily& family) {
          return family.is_closed == closed && family.is_complete && family.length > 0.5;
        });
    return static_cast<std::size_t>(at - plan.families.begin());
  };
  for (const char* name :
       {"families_points_vanish", "families_points_allowed", "families_points_apart",
        "families_length", "families_ends", "families_members"}) {
    CHECK(holds(plan, name));
  }
  const std::size_t open = find(false);
  REQUIRE(open < plan.families.size());
  REQUIRE(plan.families[open].points.size() > 6);

  for (const double factor : {0.9, 0.99, 0.9999, 1.0001, 1.01, 1.1}) {
    Plan other = plan;
    other.families[open].length *= factor;
    CHECK_FALSE(holds(other, "families_length"));
  }
  Plan other = plan;
  other.families[open].points[3].phi[1] += 1e-6;
  CHECK_FALSE(holds(other, "families_points_vanish"));
  other = plan;
  other.families[open].points.erase(other.families[open].points.begin() + 3);
  CHECK_FALSE(holds(other, "families_points_apart"));
  other = plan;
  std::swap(other.families[open].points[2], other.families[open].points[4]);
  CHECK_FALSE(holds(other, "families_points_apart"));
  other = plan;
  other.families[open].points.clear();
  CHECK_FALSE(holds(other, "families_points_allowed"));
  // Cut off before its limit, with the length that it then has.
  other = plan;
  SolutionFamily& cut = other.families[open];
  const auto chord_to = [](auto point) {
    const Configuration &here = *point, &there = *(point - 1);
    Eigen::VectorXd d(here.phi.size() + 4);
    d << here.phi - there.phi, here.contact_time - there.contact_time,
        rotation_log(here.base.orientation * there.base.orientation.conjugate());
    return d;
  };
  const Eigen::VectorXd last = chord_to(cut.points.end() - 1);
  const Eigen::VectorXd before = chord_to(cut.points.end() - 2);
  // The angle of its arc is that of both chords, up to the step's third power.
  const double cosine = last.dot(before) / (last.norm() * before.norm());
  const double angle =
      std::acos(std::min(1.0, cosine)) * 2 * last.norm() / (last.norm() + before.norm());
  cut.length -= last.norm() * (1 + angle * angle / 24);
  cut.points.pop_back();
  CHECK(holds(other, "families_length"));
  CHECK_FALSE(holds(other, "families_ends"));
  cut.is_complete = false;  // then nothing is claimed of its ends
  CHECK(holds(other, "families_ends"));
  // Followed to limits at both ends, but not said to be.
  other = plan;
  other.families[open].is_complete = false;
  CHECK_FALSE(holds(other, "families_ends"));
  // Open, not closed.
  other = plan;
  other.families[open].is_closed = true;
  CHECK_FALSE(holds(other, "families_ends"));
  // A candidate of another curve.
  other = plan;
  const auto member = std::find_if(
      other.candidates.begin(), other.candidates.end(),
      [&](const Candidate& candidate) { return candidate.family == static_cast<int>(open); });
  REQUIRE(member != other.candidates.end());
  member->family = open == 0 ? 1 : 0;
  CHECK_FALSE(holds(other, "families_members"));
}

TEST_CASE("starts of a curve are those of the search, and no curve is listed twice") {
  const Plan& plan = plan_with_families();
  for (const Plan* whole : {&plan, &robust_plan()}) {
    REQUIRE(whole->families.size() >= 2);
    for (const char* name : {"families_starts", "families_distinct", "candidates_list"}) {
      CHECK(holds(*whole, name));
    }
    Plan other = *whole;
    other.families[0].starts = 0;
    CHECK_FALSE(holds(other, "families_starts"));
    other.families[0].starts = whole->certificate.starts + 1;
    CHECK_FALSE(holds(other, "families_starts"));
    other = *whole;
    other.families[0].starts += 5;
    CHECK_FALSE(holds(other, "candidates_list"));

    other = *whole;
    other.families.push_back(other.families[0]);
    CHECK_FALSE(holds(other, "families_distinct"));
    // In reverse order, and a part of it only.
    SolutionFamily& again = other.families.back();
    std::reverse(again.points.begin(), again.points.end());
    CHECK_FALSE(holds(other, "families_distinct"));
    again.points.resize(again.points.size() / 2 + 1);
    CHECK_FALSE(holds(other, "families_distinct"));
  }
  // Ends elsewhere count as well.
  Plan other = plan;
  const auto single = std::find_if(other.candidates.begin(), other.candidates.end(),
                                   [](const Candidate& candidate) { return candidate.family < 0; });
  REQUIRE(single != other.candidates.end());
  single->starts_reached += plan.certificate.starts;
  CHECK_FALSE(holds(other, "families_starts"));
}

TEST_CASE("a curve that is missing in the list is found") {
  const auto without = [](Plan plan, int number) {
    plan.families.erase(plan.families.begin() + number);
    for (Candidate& candidate : plan.candidates) {
      if (candidate.family == number) candidate.family = -1;
      if (candidate.family > number) --candidate.family;
    }
    return plan;
  };
  const Plan& plan = plan_with_families();
  int left_out = 0;
  for (int i = 0; i < static_cast<int>(plan.families.size()); ++i) {
    const bool has_starts = std::any_of(
        plan.candidates.begin(), plan.candidates.end(), [&](const Candidate& candidate) {
          return candidate.family == i && candidate.starts_reached > 0;
        });
    if (!has_starts) continue;
    INFO("curve " << i);
    CHECK_FALSE(holds(without(plan, i), "candidates_list"));
    ++left_out;
  }
  CHECK(left_out >= 2);

  // Of a robust measure it is known of the curve on which the nominal optimum is, and of curves
  // whose candidates are no minima of the measure.
  const Plan& robust = robust_plan();
  REQUIRE(holds(robust, "candidates_list"));
  REQUIRE(robust.nominal_optimum);
  REQUIRE(robust.nominal_optimum->nominal < 1e-12);
  REQUIRE(robust.families.size() >= 2);
  for (int i = 0; i < static_cast<int>(robust.families.size()); ++i) {
    INFO("curve " << i << " of the robust plan");
    CHECK_FALSE(holds(without(robust, i), "candidates_list"));
  }
}

TEST_CASE(
    "starts of a curve are no fewer than those of its candidates also where the list is cut") {
  CaptureProblem problem = test::shipped("planar_three_link_client");
  problem.measure.kind = RiskMeasure::Nominal;
  problem.approach.enabled = false;
  problem.search.max_candidates = 3;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.certificate.distinct_solutions > 3);
  CHECK(holds(plan, "candidates_list"));
  const auto member =
      std::find_if(plan.candidates.begin(), plan.candidates.end(), [](const Candidate& candidate) {
        return candidate.family >= 0 && candidate.starts_reached > 1;
      });
  REQUIRE(member != plan.candidates.end());
  Plan other = plan;
  other.families[static_cast<std::size_t>(member->family)].starts = member->starts_reached - 1;
  CHECK_FALSE(holds(other, "candidates_list"));
}

TEST_CASE("an arm mounted at the base's centroid has two closed curves of C2 postures") {
  // Its joint transmits no moment about the centroid: the base's part vanishes everywhere.
  CaptureProblem problem = test::without_path("planar_two_link_c2_a");
  problem.robot.joints.front().p.setZero();
  const Plan plan = make_plan(problem);
  CHECK(plan.families.size() == 2);
  for (const SolutionFamily& family : plan.families) CHECK(family.is_closed);
  CHECK(plan.candidates.size() <= 4);
  for (const Candidate& candidate : plan.candidates) CHECK(candidate.family >= 0);
  CHECK(failures(plan).find("families") == std::string::npos);
  CHECK(failures(plan).find("candidates_list") == std::string::npos);
}

TEST_CASE("lengths of curves that bend strongly are held to a part of a thousandth") {
  // The hand is near the centroid of the system: closed curves of some 0.1 rad.
  const Plan plan = make_plan(problem_at_centroid());
  REQUIRE(!plan.families.empty());
  CHECK(holds(plan, "families_length"));
  for (std::size_t i = 0; i < plan.families.size(); ++i) {
    for (const double factor : {0.9, 0.999, 1.001, 1.1}) {
      INFO("curve " << i << " of " << plan.families[i].points.size() << " points, times "
                    << factor);
      Plan other = plan;
      other.families[i].length *= factor;
      CHECK_FALSE(holds(other, "families_length"));
    }
  }
}

TEST_CASE("an objective that is zero everywhere leaves the self-motion as its curves of zeros") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.robot.joints.front().p.setZero();
  problem.hand.position = Vector3d(1.3, 0.5, 0);
  problem.measure.kind = RiskMeasure::Nominal;
  const Plan plan = make_plan(problem);
  CHECK(plan.certificate.proof.status == ProofStatus::NotApplicable);
  CHECK(plan.families.size() == 1);
  CHECK(failures(plan) == "");
}

TEST_CASE("a momentum that vanishes over the whole cone is compared to a part of its terms") {
  const Plan plan = make_plan(problem_at_centroid());
  REQUIRE(plan.nominal_optimum);
  REQUIRE(plan.nominal_optimum->worst_case < 1e-10);  // of those that are equal the nearest
  const char* const names[] = {"nominal_optimum_nominal", "nominal_optimum_worst_case",
                               "nominal_optimum_value",   "nominal_optimum_is_lowest",
                               "candidates_objective",    "candidates_worst_case",
                               "candidates_value",        "families_vanish",
                               "families_points_vanish"};
  for (const char* name : names) {
    INFO(name);
    CHECK(holds(plan, name));
  }
  Plan other = plan;
  other.nominal_optimum->nominal += 1e-10;  // N m s
  CHECK_FALSE(holds(other, "nominal_optimum_nominal"));
  other = plan;
  const auto still =
      std::find_if(other.candidates.begin(), other.candidates.end(),
                   [](const Candidate& candidate) { return candidate.worst_case < 1e-12; });
  REQUIRE(still != other.candidates.end());
  still->objective += 1e-10;
  CHECK_FALSE(holds(other, "candidates_objective"));
  other = plan;
  other.families[0].points[2].phi[1] += 1e-6;
  CHECK_FALSE(holds(other, "families_points_vanish"));
}

TEST_CASE("a limit that holds all along a curve does not end it") {
  CaptureProblem problem = test::without_path("planar_three_link_null");
  problem.measure.kind = RiskMeasure::Nominal;
  problem.variables.joints = {false, true, false};
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_axis = Vector3d::UnitZ();
  problem.variables.base_attitude_max = M_PI;
  problem.impulse.direction = Vector3d(-0.8, 0.6, 0);
  problem.impulse.direction_frame = Frame::Inertial;
  problem.hand = {};
  problem.search.starts = 24;
  SECTION("a stated closing speed") {
    problem.constraints.closing_speed_min = problem.impulse.closing_speed;
  }
  SECTION("a box of no height") {
    problem.hand.position = Vector3d(1, 0, 0);
    problem.hand.constraint = HandConstraint::Position;
    problem.variables.base_position = PositionFreedom::Box;
    problem.variables.base_position_lower = {-9, -9, 0};
    problem.variables.base_position_upper = {9, 9, 0};
  }
  const Plan plan = make_plan(problem);
  const auto is_cut = [](const SolutionFamily& family) { return !family.is_complete; };
  CHECK(std::any_of(plan.families.begin(), plan.families.end(), is_cut));
  CHECK(holds(plan, "families_ends"));
}

TEST_CASE("curves of a base with free attitude are followed up to half a rotation") {
  CaptureProblem problem = test::shipped("spart_3dof_point");
  problem.variables.base_attitude_max = 3.14159265358979323846;
  problem.approach.enabled = false;
  problem.search.starts = 24;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.families.size() >= 2);
  const auto cut = std::count_if(plan.families.begin(), plan.families.end(),
                                 [](const SolutionFamily& family) { return !family.is_complete; });
  CHECK(cut > 0);
  for (const char* name : {"families_points_vanish", "families_points_allowed",
                           "families_points_apart", "families_length", "families_ends",
                           "families_starts", "families_distinct", "candidates_list"}) {
    INFO(name);
    CHECK(holds(plan, name));
  }
}

TEST_CASE("an impact at the system's centroid is C1: the parts are measured by the arms") {
  for (const RiskMeasure measure : {RiskMeasure::Nominal, RiskMeasure::WorstCase}) {
    CaptureProblem problem = problem_at_centroid();
    problem.measure.kind = measure;
    problem.robot.shapes.clear();  // or the posture that is best touches the base
    const Plan plan = make_plan(problem);
    REQUIRE(plan.objective.worst_case < kZeroObjective);  // N m s, over the whole cone
    const CaseJudgement& judgement = plan.impact.judgement;
    CHECK(judgement.impact_case == ImpactCase::C1);
    CHECK(judgement.total < 10 * kZeroObjective);  // of 0.12 N m s, |f| times the arms
    CHECK(judgement.base == Approx(judgement.coupling).epsilon(1e-9));
    CHECK(judgement.base > 0.01);
    CHECK(judgement.base < 10);
    CHECK(plan.status == PlanStatus::Optimal);  // no less than zero is possible
    INFO(failures(plan));
    CHECK(failures(plan).empty());
    Plan other = plan;
    other.impact.judgement.base *= 1.01;
    CHECK_FALSE(holds(other, "case_residuals"));
  }
}

}  // namespace stillbase
