// Lower bounds over the attitude of the base alone, any turn or an axis within a cone, against the
// planner's own evaluation of the measure.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/measure.hpp"
#include "proof/case_rows.hpp"
#include "proof/minimum_problem.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

enum class Arm { Planar, Spatial, SpatialAtClient };

/// All joints held, the base turned and free to turn further. The impulse comes along a direction
/// of N, or is that of a client that has tumbled, whose size depends on the direction.
CaptureProblem held_arm(Arm arm, AttitudeFreedom freedom) {
  CaptureProblem problem =
      test::shipped(arm == Arm::Planar ? "planar_three_link_null" : "iiwa_cone");
  problem.variables.joints.assign(problem.variables.joints.size(), false);
  problem.variables.base_attitude = freedom;
  const bool is_cone = freedom == AttitudeFreedom::Cone;
  problem.variables.base_attitude_axis = Vector3d(1, -2, 2) / 3;
  problem.variables.base_attitude_max = is_cone ? 20 * M_PI / 180 : M_PI;
  problem.variables.base_position = PositionFreedom::Free;
  problem.base.orientation = rotation_exp({0.4, -0.7, 0.3});
  problem.hand.constraint = HandConstraint::None;
  problem.hand.position.reset();
  if (arm != Arm::SpatialAtClient) {
    problem.impulse.source = ImpulseSource::PointMass;
    problem.impulse.direction = Vector3d(0.8, 0.36, -0.48);
    problem.impulse.direction_frame = Frame::Inertial;
    problem.impulse.closing_speed = 0.05;
  }
  problem.uncertainty.cone_half_angle = 0.3;
  problem.uncertainty.cone_plane_normal.reset();
  problem.measure.kind = RiskMeasure::Nominal;
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  // Of a planar arm some direction in its plane does not turn the base.
  if (arm == Arm::Planar) {
    problem.objective = {{ObjectiveQuantity::JointRateNorm, 0.1},
                         {ObjectiveQuantity::ImpulseMagnitude, 1}};
  }
  return problem;
}

/// Where the size of the impulse depends on its direction the worst one may be within the cone.
std::vector<Scenario> scenarios_of(CaptureProblem problem) {
  std::vector<Scenario> out = {Formulation(problem).nominal_scenario()};
  if (problem.measure.kind != RiskMeasure::WorstCase) return out;
  const double rim = problem.uncertainty.cone_half_angle;
  for (const double part : {1.0, 0.6}) {
    problem.uncertainty.cone_half_angle = part * rim;
    for (const Scenario& scenario : rim_scenarios(problem, 20)) out.push_back(scenario);
  }
  return out;
}

/// Whether the attitude is allowed, by the words of the problem file.
bool is_allowed(const CaptureProblem& problem, const Eigen::Quaterniond& orientation) {
  const Vector3d& axis = problem.variables.base_attitude_axis;
  const Eigen::Quaterniond turn = orientation * problem.base.orientation.conjugate();
  if (problem.variables.base_attitude != AttitudeFreedom::Cone) return true;
  return axis.dot(turn * axis) >= std::cos(problem.variables.base_attitude_max);
}

/// The least measure over many attitudes and random turns from the best of them.
double least_measure(const CaptureProblem& problem, int starts) {
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  const auto value_at = [&](const Eigen::Quaterniond& orientation) {
    if (!is_allowed(problem, orientation)) return kInfinity;
    const Configuration at{problem.start, {problem.base.position, orientation}, 0};
    return measure.reported(formulation.variables(at));
  };
  std::vector<std::pair<double, Eigen::Quaterniond>> found;
  for (int s = 0; s < starts; ++s) {
    const Eigen::VectorXd u = low_discrepancy_point(s, formulation.num_variables(), 3);
    const auto at = formulation.configuration(formulation.start_point(u)).base.orientation;
    found.emplace_back(value_at(at), at);
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  found.resize(5);
  Random random(8);
  double least = kInfinity;
  for (auto& [value, at] : found) {
    double step = 0.2;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Quaterniond turn = rotation_exp(step * random.uniform() * random.unit_vector());
      const Eigen::Quaterniond next = (turn * at).normalized();
      const double there = value_at(next);
      step *= there < value ? 1.5 : 0.9;
      if (there < value) {
        value = there;
        at = next;
      }
    }
    least = std::min(least, value);
  }
  return least;
}

}  // namespace

TEST_CASE("the parameters of a rotation give the rotation") {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(0, M_PI);
    const Vector3d axis = random.unit_vector();
    const Vector3d sigma = axis * std::tan(angle / 4);
    const proof::RoundUpward upward;
    const Vector3<proof::Dual> s = sigma.cast<proof::Dual>();
    const auto R = proof::rotation_by<proof::Dual>(s, s.squaredNorm());
    const Matrix3d expected = rotation_exp(angle * axis).toRotationMatrix();
    for (Eigen::Index k = 0; k < 9; ++k) {
      CHECK(std::abs(proof::middle(R.data()[k].v) - expected.data()[k]) < 1e-14);
      CHECK(proof::width_of(R.data()[k].v) < 1e-13);
    }
  }
}

TEST_CASE("a box is left out only where no attitude of it is allowed, and most such boxes are") {
  const AttitudeFreedom freedom = GENERATE(AttitudeFreedom::Cone, AttitudeFreedom::Free);
  const CaptureProblem problem = held_arm(Arm::Spatial, freedom);
  const proof::ZeroProblem where = proof::zero_problem(problem);
  Random random(11);
  int left_out = 0, none_allowed = 0, kept = 0;
  for (int i = 0; i < 3000; ++i) {
    const double width = 0.02;
    const Vector3d middle(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    bool any = false;
    for (int k = 0; k < 20; ++k) {
      Vector3d sigma = middle;
      for (double& entry : sigma) entry += width * (k == 0 ? 0 : random.uniform(-1, 1));
      const double angle = 4 * std::atan(sigma.norm());
      const auto at = rotation_exp(angle * sigma.normalized()) * problem.base.orientation;
      any = any || (sigma.norm() <= 1 && is_allowed(problem, at));
    }
    const proof::RoundUpward upward;
    std::array<proof::Dual, 3> box;
    for (int k = 0; k < 3; ++k) {
      box[static_cast<std::size_t>(k)] =
          proof::Dual(proof::Interval(middle[k] - width, middle[k] + width));
    }
    const bool is_out = proof::keeps_inequalities(where, box) == proof::Kept::No;
    CHECK_FALSE((is_out && any));
    left_out += is_out;
    none_allowed += !any;
    kept += any;
  }
  CHECK(left_out > 0.85 * none_allowed);
  CHECK(left_out <= none_allowed);
  CHECK(kept > 10);
}

TEST_CASE("over attitudes alone no bound is above any measure, and it is near the least one") {
  const Arm arm = GENERATE(Arm::Planar, Arm::Spatial, Arm::SpatialAtClient);
  const AttitudeFreedom freedom = GENERATE(AttitudeFreedom::Cone, AttitudeFreedom::Free);
  CaptureProblem problem = held_arm(arm, freedom);
  problem.measure.kind = GENERATE(RiskMeasure::Nominal, RiskMeasure::WorstCase);
  REQUIRE(minimum_objection(problem) == "");
  const bool is_dear =
      arm == Arm::SpatialAtClient && problem.measure.kind == RiskMeasure::WorstCase;
  if (is_dear && freedom == AttitudeFreedom::Free) return;  // see the planner's tests
  const double least = least_measure(problem, 1000);
  const std::vector<Scenario> scenarios = scenarios_of(problem);
  // Told that a value above the least one is the best one it has to stop below the least by itself.
  for (const double more : {1.0, 1.2}) {
    const MinimumBound found = prove_minimum(
        problem, scenarios, {}, more * least,
        {.relative_gap = more > 1 ? 1e-9 : 1e-3, .max_boxes = more > 1 ? 10000 : 30000});
    CAPTURE(static_cast<int>(arm), static_cast<int>(problem.measure.kind), more, least,
            found.statement);
    CHECK(found.lower_bound <= least);
    // Of directions that are not quite the worst ones; the planner adds those of its candidates.
    CHECK(found.lower_bound >= (is_dear ? 0.96 : 0.99) * least);
    CHECK(found.statement.find("contradiction") == std::string::npos);
    CHECK(found.statement.find("no configuration has") == 0);
  }
}

}  // namespace stillbase
