// What the boxes' variables make of the encounter, against the planner's formulation.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/io/problem_file.hpp>

#include "proof/zero_problem.hpp"

namespace stillbase::proof {
namespace {

/// A client that tumbles about no principal axis; base angle and time free.
CaptureProblem tumbling_client() {
  CaptureProblem problem =
      read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/planar_three_link_client.yaml");
  problem.target_state.angular_velocity = {0.05, -0.1, 0.08};
  problem.target_state.pose.orientation = rotation_exp({0.3, 0.2, -0.5});
  problem.base.orientation = rotation_exp({0.1, -0.6, 0.2});
  problem.variables.base_attitude_axis = Vector3d(1, 2, -1).normalized();
  problem.variables.contact_time_lower = 10;
  problem.variables.joints = {false, true, false};
  problem.hand.constraint = HandConstraint::None;
  return problem;
}

double beyond(const Interval& x, double value) {
  return std::max(x.lower() - value, value - x.upper());
}

}  // namespace

TEST_CASE("wrench, closing speed and their slopes are those of the planner's formulation") {
  CaptureProblem problem = tumbling_client();
  const bool is_direction_in_N = GENERATE(false, true);
  if (is_direction_in_N) {
    problem.impulse.direction = Vector3d(2, -1, 3).normalized();
    problem.impulse.direction_frame = Frame::Inertial;
    problem.impulse.source = ImpulseSource::Given;
    problem.impulse.moment = {0.1, 0.2, -0.3};
  }
  const Formulation formulation(problem);
  const ZeroProblem zeros = zero_problem(problem);
  REQUIRE(zeros.encounter.num_variables() == 3);
  REQUIRE(formulation.num_variables() == 3);
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd x =
        formulation.start_point(Vector3d(random.uniform(), random.uniform(), random.uniform()));
    const auto at = [&](const Eigen::VectorXd& y) {
      return encounter_at(formulation.encounter_model(), formulation.configuration(y));
    };
    const Encounter<double> exact = at(x);
    // Slopes by differences.
    constexpr double kStep = 1e-5;
    const Eigen::VectorXd angle = kStep * Eigen::VectorXd::Unit(3, 1);
    const Eigen::VectorXd time = kStep * Eigen::VectorXd::Unit(3, 2);
    const Vector6d by_angle = (at(x + angle).F - at(x - angle).F) / (2 * kStep);
    const Vector6d by_time = (at(x + time).F - at(x - time).F) / (2 * kStep);
    const double speed_by_time =
        (at(x + time).closing_speed - at(x - time).closing_speed) / (2 * kStep);

    const RoundUpward upward;
    const double unit = zeros.encounter.time_unit;
    std::array<Dual, 3> variables;
    for (int k = 0; k < 3; ++k) {
      const auto index = static_cast<std::size_t>(k);
      variables[index] = Dual(Interval(k == 2 ? x[k] / unit : x[k]), k, 3);
    }
    const auto range = encounter_over<Dual>(zeros.encounter, variables);
    for (int k = 0; k < 6; ++k) {
      CHECK(beyond(range.F[k].v, exact.F[k]) < 1e-9);
      CHECK(width_of(range.F[k].v) < 1e-8);
      CHECK(beyond(range.F[k].d[1], by_angle[k]) < 1e-7);
      CHECK(beyond(range.F[k].d[2] / unit, by_time[k]) < 1e-7);
    }
    if (is_direction_in_N) continue;
    CHECK(beyond(range.closing_speed.v, exact.closing_speed) < 1e-9);
    CHECK(beyond(range.closing_speed.d[2] / unit, speed_by_time) < 1e-7);
  }
}

}  // namespace stillbase::proof
