// Margins at the contact are recomputed.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/random.hpp>

#include "collision/closed_forms.hpp"
#include "verification/example_plans.hpp"
#include "verification/margins.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

bool holds(const Plan& plan, const std::string& name) {
  for (const Claim& claim : judge_plan(plan, quick()).claims) {
    if (claim.name == name) return claim.pass;
  }
  FAIL("no claim " << name);
  return false;
}

/// A plan whose problem asks for every margin, with some room; and their values in its list.
Plan margin_plan() {
  Plan plan = arm_plan();
  CaptureProblem& problem = plan.problem;
  problem.constraints.joint_rate_max = 2 * plan.impact.Delta_phidot.cwiseAbs();
  problem.constraints.coupling_singular_value_min = 1e-3;
  problem.constraints.jacobian_singular_value_min = 1e-3;
  problem.constraints.clearance = 1e-3;
  const auto response = verification::posture_response(problem, plan.configuration.phi);
  const auto add = [&plan](const std::string& name, double value, double lower, double upper) {
    plan.constraints.push_back({name, value, lower, upper, 0});
  };
  for (int k = 0; k < 7; ++k) {
    const double limit = problem.constraints.joint_rate_max[k];
    add("joint_rate_" + problem.robot.joints[static_cast<std::size_t>(k)].name,
        plan.impact.Delta_phidot[k], -limit, limit);
  }
  add("coupling_singular_value", verification::coupling_singular_value(response), 1e-3, kInfinity);
  add("jacobian_singular_value", verification::jacobian_singular_value(response, 1), 1e-3,
      kInfinity);
  const Vector3d hand_N = plan.configuration.base * Vector3d(response.dynamics.hand_position);
  const auto motion = verification::target_motion(problem, plan.configuration, hand_N, 60);
  const Pose target = motion->state(60).pose;
  const verification::ContactShapes shapes(problem, plan.configuration, &target);
  add("clearance_1_5_base_link_3", shapes.distance(1, 5).value(), 1e-3, kInfinity);
  return plan;
}

}  // namespace

TEST_CASE("a plan that keeps its margins passes, and every margin has its check") {
  const Plan plan = margin_plan();
  for (const char* name :
       {"joint_rate_limits", "coupling_singular_value", "jacobian_singular_value",
        "shape_clearance", "constraint_values", "constraint_bounds", "candidates_allowed"}) {
    INFO(name);
    CHECK(holds(plan, name));
  }
}

TEST_CASE("a margin that is broken or misstated is found") {
  const Plan good = margin_plan();
  const auto changed = [&good](auto change) {
    Plan plan = good;
    change(plan);
    return plan;
  };
  CHECK_FALSE(holds(changed([](Plan& p) { p.problem.constraints.joint_rate_max /= 3; }),
                    "joint_rate_limits"));
  CHECK_FALSE(
      holds(changed([](Plan& p) { p.problem.constraints.coupling_singular_value_min = 100; }),
            "coupling_singular_value"));
  CHECK_FALSE(
      holds(changed([](Plan& p) { p.problem.constraints.jacobian_singular_value_min = 10; }),
            "jacobian_singular_value"));
  CHECK_FALSE(
      holds(changed([](Plan& p) { p.problem.constraints.clearance = 3.0; }), "shape_clearance"));
  CHECK_FALSE(
      holds(changed([](Plan& p) { p.problem.constraints.clearance = 3.0; }), "candidates_allowed"));
  for (std::size_t i = 0; i < good.constraints.size(); ++i) {
    INFO(good.constraints[i].name);
    CHECK_FALSE(
        holds(changed([i](Plan& p) { p.constraints[i].value += 1e-6; }), "constraint_values"));
    const bool has_lower = std::isfinite(good.constraints[i].lower);
    CHECK_FALSE(holds(changed([&](Plan& p) {
                        ConstraintValue& c = p.constraints[i];
                        c.lower = has_lower ? c.lower - 1e-6 : -1e6;
                      }),
                      "constraint_bounds"));
  }
}

TEST_CASE("distances at the contact agree with the collision scene where both are exact") {
  const Plan plan = margin_plan();
  const verification::ContactShapes shapes(plan.problem, plan.configuration, nullptr);
  // Shape 1 is the base's box of 0.75 m, the last one the sphere of link 7.
  const auto d = reference::body_poses(plan.problem.robot, plan.configuration.phi);
  const CollisionShape& last = plan.problem.robot.shapes.back();
  const Vector3d p = d[static_cast<std::size_t>(last.body)] * last.pose.position;
  const Pose& box = plan.problem.robot.shapes.front().pose;
  const Vector3d q = ((box.inverse() * p).cwiseAbs() - Vector3d::Constant(0.375)).cwiseMax(0);
  CHECK(shapes.distance(1, shapes.count()).value() ==
        Approx(q.norm() - std::get<Sphere>(last.geometry).radius).epsilon(1e-12));
}

TEST_CASE("distances of boxes are those of the collision scene's closed form") {
  Plan plan = arm_plan();
  const Vector3d size(0.7, 0.5, 0.3), other_size(0.1, 0.2, 0.6);
  Random random(72);
  int apart = 0, bounded = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Pose one{random.uniform(0, 1.5) * random.unit_vector(),
                   rotation_exp(2 * random.unit_vector())};
    const Pose other{Vector3d::Zero(), rotation_exp(2 * random.unit_vector())};
    plan.problem.robot.shapes = {{kBase, "one", one, Box{size}},
                                 {kBase, "other", other, Box{other_size}}};
    const verification::ContactShapes shapes(plan.problem, plan.configuration, nullptr);
    const PlacedBox a{size / 2, one.orientation.toRotationMatrix(), one.position};
    const PlacedBox b{other_size / 2, other.orientation.toRotationMatrix(), other.position};
    const double gap = widest_gap(a, b), distance = shapes.distance(1, 2).value();
    CHECK(distance == Approx(gap > 0 ? separate_box_distance(a, b) : gap).epsilon(0).margin(1e-12));
    apart += gap > 0;
    const double enough = random.uniform(0, 0.3), found = shapes.distance(1, 2, enough).value();
    CHECK((found == distance || (found > enough && found <= distance)));
    bounded += found != distance;
  }
  CHECK(apart > 150);
  CHECK(bounded > 50);
}
