#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>

#include <stillbase/proof/minimum.hpp>
#include <stillbase/proof/proof.hpp>

#include "minimum_values.hpp"

namespace stillbase {
namespace {

using proof::Bound;
using proof::bound_minimum;
using proof::MinimumProblem;

std::vector<Scenario> along(const CaptureProblem& problem,
                            const std::vector<Vector3d>& directions) {
  std::vector<Scenario> out;
  for (const Vector3d& direction : directions) {
    Scenario scenario;
    scenario.direction = direction.normalized();
    scenario.restitution = problem.impulse.restitution;
    out.push_back(scenario);
  }
  return out;
}

/// The problem with impulses along `directions` of the contact frame, which is that of the base.
MinimumProblem bounded(const CaptureProblem& problem, const std::vector<Vector3d>& directions) {
  return proof::minimum_problem(problem, along(problem, directions));
}

std::vector<Vector3d> wedge(double middle, double half_angle, int count) {
  std::vector<Vector3d> out;
  for (int i = 0; i < count; ++i) {
    const double angle = count == 1 ? middle : middle + half_angle * (2.0 * i / (count - 1) - 1);
    out.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  return out;
}

/// Joints that hold the hand of planar_three_link at (2.3, 0.5): a turn of the last link, twice.
std::vector<Eigen::VectorXd> self_motion(int count) {
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i < count; ++i) {
    const double psi = 2 * M_PI * i / count;
    const double x = 2.3 - 1.05 - 0.4 * std::cos(psi), y = 0.5 - 0.4 * std::sin(psi);
    const double c = (x * x + y * y - 0.81 - 0.49) / (2 * 0.9 * 0.7);
    if (std::abs(c) > 1) continue;
    for (const double side : {-1.0, 1.0}) {
      const double q2 = side * std::acos(c);
      const double q1 = std::atan2(y, x) - std::atan2(0.7 * std::sin(q2), 0.9 + 0.7 * std::cos(q2));
      out.push_back(Vector3d(q1, q2, psi - q1 - q2));
    }
  }
  return out;
}

double least_on(const MinimumProblem& problem, const std::vector<Eigen::VectorXd>& postures) {
  double least = 1e300;
  for (const Eigen::VectorXd& phi : postures) least = std::min(least, value_at(problem, phi));
  return least;
}

}  // namespace

TEST_CASE("the robust optimum of the redundant planar arm is proven, and no posture is below it") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  const MinimumProblem minimum = bounded(problem, wedge(M_PI, M_PI / 18, 13));
  const double least = least_on(minimum, self_motion(4000));
  const double best = 1.67764963350832e-05;  // the search's, see best_known.csv
  CHECK(best <= least);
  const Bound found = bound_minimum(minimum, best);
  CAPTURE(found.boxes, found.lower, least);
  CHECK_FALSE(found.limit_reached);
  CHECK_FALSE(found.nothing_below_cut);
  CHECK(found.lower <= least);
  CHECK(found.lower >= best * (1 - 1e-3));
}

TEST_CASE("a bound holds and is sharp for every quantity, and for several together") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  const std::vector<Eigen::VectorXd> postures = self_motion(2500);
  using Q = ObjectiveQuantity;
  const std::vector<std::vector<ObjectiveTerm>> objectives = {
      {{Q::JointRateNorm}},
      {{Q::ImpulseMagnitude}},
      {{Q::BaseMomentum, 1, 0.5}},
      {{Q::BaseAngularMomentum, 0.01}, {Q::JointRateNorm, 0.1}, {Q::ImpulseMagnitude, 1}},
      {{Q::TotalAngularMomentum, 0.1}, {Q::BaseAngularVelocity, 1e-4}, {Q::JointRateNorm, 1}}};
  for (const auto& objective : objectives) {
    problem.objective = objective;
    const MinimumProblem minimum = bounded(problem, wedge(M_PI, 0, 1));
    const double least = least_on(minimum, postures);
    const Bound found = bound_minimum(minimum, least);
    CAPTURE(to_string(objective.front().quantity), objective.size(), found.boxes);
    CHECK_FALSE(found.limit_reached);
    CHECK(found.lower <= least);
    CHECK(found.lower >= least * (1 - 1e-3));
  }
}

TEST_CASE("two free joints without any equation: nominal value and worst case over a wedge") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  const double middle = 210 * M_PI / 180;
  for (const int directions : {1, 9}) {
    problem.objective = {{directions == 1 ? ObjectiveQuantity::ImpulseMagnitude
                                          : ObjectiveQuantity::BaseAngularMomentum}};
    const MinimumProblem minimum = bounded(problem, wedge(middle, M_PI / 36, directions));
    std::vector<Eigen::VectorXd> grid;
    for (int i = 0; i < 150; ++i) {
      for (int j = 0; j < 150; ++j) {
        grid.push_back(Eigen::Vector2d(2 * M_PI * i / 150 - M_PI, 2 * M_PI * j / 150 - M_PI));
      }
    }
    double least = least_on(minimum, grid);
    // From the best of the grid downhill by halved steps.
    Eigen::VectorXd at = grid.front();
    for (const auto& phi : grid) at = value_at(minimum, phi) < value_at(minimum, at) ? phi : at;
    for (double step = 0.02; step > 1e-7;) {
      bool moved = false;
      for (int k = 0; k < 8; ++k) {
        const Eigen::VectorXd next =
            at + step * Eigen::Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4));
        const double value = value_at(minimum, next);
        if (!(value < least)) continue;
        least = value;
        at = next;
        moved = true;
      }
      if (!moved) step /= 2;
    }
    const Bound found = bound_minimum(minimum, least, {.relative_gap = 0.01});
    CAPTURE(directions, least, found.lower, found.boxes);
    CHECK_FALSE(found.limit_reached);
    CHECK(found.lower <= least);
    CHECK(found.lower >= least * 0.99);
  }
}

TEST_CASE("a spatial arm at a point: the bound is the least value of its enclosed postures") {
  CaptureProblem problem = test::shipped("spart_3dof_point");
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.variables.base_position = PositionFreedom::Fixed;
  problem.constraints.joint_limit_margin = 0;
  const Vector3d n = Vector3d(-2, -1, -2).normalized();
  MinimumProblem minimum = bounded(problem, {n, Vector3d(-2.1, -1, -2), Vector3d(-2, -1.1, -2)});
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.frame = Frame::Base;
  problem.hand.position = minimum.where.encounter.stated_hand_point;
  problem.impulse.direction = n;
  problem.impulse.direction_frame = Frame::Base;
  const Proof proof = prove(problem);
  REQUIRE(proof.status == ProofStatus::Complete);
  REQUIRE_FALSE(proof.solutions.empty());
  double least = 1e300;
  for (const JointBox& box : proof.solutions) {
    least = std::min(least, value_at(minimum, (box.lower + box.upper) / 2));
  }
  const Bound over_all = bound_minimum(minimum, least * (1 + 1e-9));
  CAPTURE(over_all.boxes, over_all.lower, least);
  CHECK(over_all.lower <= least * (1 + 1e-9));
  CHECK(over_all.lower >= least * (1 - 1e-3));
  minimum.places = proof.solutions;
  const Bound over_places = bound_minimum(minimum, least * (1 + 1e-9));
  CHECK(over_places.lower >= least * (1 - 1e-3));
  CHECK(over_places.boxes <= 20 * static_cast<long>(proof.solutions.size()));
}

TEST_CASE("a best value that no posture has is found out") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  const MinimumProblem minimum = bounded(problem, wedge(M_PI, 0, 1));
  const double least = least_on(minimum, self_motion(2000));
  const Bound found = bound_minimum(minimum, 0.5 * least);
  CAPTURE(found.boxes, found.lower);
  CHECK(found.nothing_below_cut);
  CHECK(found.lower > 0.5 * least);
}

TEST_CASE("limits of joints and of boxes: the bound holds, and is the same for every call") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  MinimumProblem minimum = bounded(problem, wedge(M_PI, 0, 1));
  const double least = least_on(minimum, self_motion(2000));
  const Bound cut = bound_minimum(minimum, least, {.max_boxes = 10});
  CHECK(cut.limit_reached);
  CHECK(cut.lower <= least);
  CHECK(bound_minimum(minimum, least, {.max_boxes = 10}).lower == cut.lower);
  std::atomic<bool> interrupted = true;
  const Bound stopped = bound_minimum(minimum, least, {.stop = {.interrupted = &interrupted}});
  CHECK(stopped.limit_reached);
  CHECK(stopped.lower <= least);
  // One free joint and no point for the hand.
  minimum.where.hand_equations.clear();
  minimum.where.robot.joints[2].type = JointType::Revolute;
  proof::VariableEncounter& encounter = minimum.where.encounter;
  encounter.variables = {{proof::VariableKind::Joint, 0.2, 1.1, false, 2}};
  std::vector<Eigen::VectorXd> row;
  for (int i = 0; i <= 2000; ++i) {
    Eigen::VectorXd phi = encounter.start;
    phi[2] = 0.2 + 0.9 * i / 2000;
    row.push_back(phi);
  }
  const double least_in_row = least_on(minimum, row);
  const Bound one = bound_minimum(minimum, least_in_row);
  CHECK(one.lower <= least_in_row);
  CHECK(one.lower >= least_in_row * (1 - 1e-3));
}

TEST_CASE("problems that cannot be bounded say why, and constraints that are left out are named") {
  CHECK_FALSE(minimum_objection(test::shipped("spart_3dof_point")).empty());
  CHECK_FALSE(minimum_objection(test::shipped("iiwa_client_50")).empty());
  CaptureProblem problem = test::shipped("planar_three_link_null");
  CHECK(minimum_objection(problem).empty());
  CaptureProblem coupled = problem;
  coupled.robot.coupled_tree = coupled.robot.joints;
  coupled.robot.couplings = {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  CHECK(minimum_objection(coupled) == "some joints follow others");
  problem.constraints.clearance = 0.01;
  problem.constraints.coupling_singular_value_min = 1e-3;
  const double best = 1.678e-5;  // not above the least one by more than the gap
  const MinimumBound bound =
      prove_minimum(problem, along(problem, wedge(M_PI, M_PI / 18, 13)), {}, best);
  CAPTURE(bound.statement);
  CHECK(bound.statement.find("not counting singular values, clearances") != std::string::npos);
  CHECK(bound.statement.find("no posture has a worst case below 1.67") == 0);
  CHECK_FALSE(bound.limit_reached);
  CHECK(bound.lower_bound > 0);
  CHECK(bound.gap == best - bound.lower_bound);
  problem.measure.kind = RiskMeasure::Expectation;
  CHECK(minimum_objection(problem).empty());
  problem.uncertainty.joint_position = JointVectord::Constant(3, 0.01);
  CHECK(minimum_objection(problem).find("posture") != std::string::npos);
  problem.measure.kind = RiskMeasure::Nominal;
  CHECK(minimum_objection(problem).empty());
}

}  // namespace stillbase
