// Equations of a case that others imply where they hold.
#include <catch2/catch.hpp>

#include <algorithm>

#include <Eigen/Geometry>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/projection.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using test::shipped;

}  // namespace

TEST_CASE("two of the three G2 equations of a rank 2 arm are solved, and the third one holds") {
  CaptureProblem problem = shipped("spart_g2");
  problem.constraints.clearance.reset();
  const Formulation formulation(problem);
  CHECK(formulation.num_equations() == 2);
  CHECK(formulation.freedom() == 4);
  int solved = 0;
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 5));
    const ProjectionResult there = project_onto_constraints(formulation, start, false, 40);
    if (!(there.violation <= 1e-12)) continue;
    ++solved;
    int base_rows = 0;
    for (const ConstraintValue& value : formulation.report(there.x)) {
      if (value.name.rfind("case_base_", 0) != 0) continue;
      ++base_rows;
      worst = std::max(worst, value.violation);
    }
    CHECK(base_rows == 3);
  }
  CHECK(solved > 200);
  CHECK(worst <= 1e-9);
}

TEST_CASE("equations are counted where they hold also when there are more of them than variables") {
  CaptureProblem problem = shipped("spart_3dof_point");
  problem.constraints.impact_case = CaseConstraint::C2;
  const HandSpec at_point = problem.hand;
  problem.hand.constraint = HandConstraint::None;
  // Of the total two, of a coupling part of rank 2 two, one of the four implied by the others.
  CHECK(Formulation(problem).num_equations() == 3);
  problem.hand = at_point;  // three more
  const Formulation formulation(problem);
  CHECK(formulation.num_variables() == 6);
  CHECK(formulation.num_equations() == 6);
  problem.variables.joints[0] = false;
  try {
    const Formulation refused(problem);
    FAIL("was accepted");
  } catch (const InputError& error) {
    REQUIRE(error.findings().size() == 1);
    CHECK(error.findings()[0].rule == "too-few-variables");
    CHECK_THAT(error.findings()[0].message,
               Catch::Contains("6 independent equations") && Catch::Contains("only 5 variables"));
  }
}

TEST_CASE("equations that presolve removes hold wherever the others do") {
  CaptureProblem problem = shipped("spart_3dof_point");
  problem.constraints.impact_case = CaseConstraint::C2;
  problem.hand.constraint = HandConstraint::None;
  const Formulation free(problem);
  Configuration last;
  int solved = 0;
  for (int i = 0; i < 60; ++i) {
    const Eigen::VectorXd start =
        free.start_point(low_discrepancy_point(i, free.num_variables(), 3));
    const ProjectionResult found = project_onto_constraints(free, start, false, 60);
    if (!(found.violation <= 1e-12)) continue;
    ++solved;
    for (const ConstraintValue& value : free.report(found.x)) CHECK(value.violation < 1e-9);
    last = free.configuration(found.x);
  }
  REQUIRE(solved > 30);
  // With the hand's point fixed there, too: the projection finds this posture.
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.position =
      last.base * Vector3d(compute_kinematics<double>(problem.robot, last.phi).r_bh);
  const Formulation formulation(problem);
  CHECK(formulation.num_equations() <= 6);
  const ProjectionResult again = project_onto_constraints(
      formulation, formulation.variables(last) + 1e-3 * Eigen::VectorXd::LinSpaced(6, -1, 1), false,
      60);
  CHECK(again.violation < 1e-10);
  for (const ConstraintValue& value : formulation.report(again.x)) CHECK(value.violation < 1e-9);
}

TEST_CASE("equations that are independent where they hold all stay") {
  CHECK(Formulation(shipped("planar_two_link_c2_a")).num_equations() == 2);
  // The total momentum (2) and the approach axis (2).
  CHECK(Formulation(shipped("iiwa_case_c")).num_equations() == 4);
}

TEST_CASE("a planar problem in a slanting plane is that of its twin in the plane of two axes") {
  CaptureProblem problem = shipped("planar_two_link_c2_a");
  REQUIRE(problem.impulse.direction_frame == Frame::Base);
  const Eigen::Quaterniond slant(Eigen::AngleAxisd(0.5236, Vector3d::UnitX()));
  problem.base.orientation = slant;
  problem.impulse.direction = slant * *problem.impulse.direction;
  problem.impulse.direction_frame = Frame::Inertial;
  const Formulation formulation(problem);
  CHECK(formulation.num_equations() == 2);
  const SearchResult result = search(problem, formulation, {});
  CHECK(result.candidates.size() == 8);
  for (const Eigen::VectorXd& x : result.points) {
    for (const ConstraintValue& value : formulation.report(x)) CHECK(value.violation <= 1e-9);
  }
}

TEST_CASE("hand and case equations of a slanting plane: each is kept once") {
  CaptureProblem problem = shipped("planar_three_link_null");
  const Eigen::Quaterniond slant(Eigen::AngleAxisd(0.5236, Vector3d::UnitX()));
  problem.base.orientation = slant;
  problem.hand.position = slant * Vector3d(1.8, 0.05, 0);  // the impulse passes the centroid there
  problem.hand.frame = Frame::Inertial;
  problem.impulse.direction = slant * *problem.impulse.direction;
  problem.impulse.direction_frame = Frame::Inertial;
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_axis = slant * Vector3d::UnitZ();
  problem.constraints.impact_case = CaseConstraint::C;
  const Formulation formulation(problem);
  CHECK(formulation.num_variables() == 4);
  CHECK(formulation.num_equations() == 3);
  const SearchResult result = search(problem, formulation, {});
  CHECK(result.status == PlanStatus::Feasible);
  CHECK(result.candidates.front().max_violation <= 1e-9);
}

}  // namespace stillbase
