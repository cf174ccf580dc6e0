// The momentum that a capture has to manage, and which limit binds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "planner/capture_limits.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

const LimitUse* find(const ManagedMomentum& managed, CaptureLimit limit) {
  for (const LimitUse& use : managed.limits) {
    if (use.limit == limit) return &use;
  }
  return nullptr;
}

struct Latched {
  CaptureProblem problem = test::shipped("servicer_latch");
  Configuration at = start_configuration(problem);
  ImpactSummary impact = impact_at(problem, at);
};

}  // namespace

TEST_CASE("11114.4678 N m s take wheels of 176 N m 63.150 s at least") {
  Latched x;
  x.problem.post_impact.wheels.torque.setConstant(176);
  x.problem.post_impact.controllers.clear();
  x.impact.total = Vector3d(-11114.4678, 300, 11000);
  const auto managed = account_after_impact(x.problem, x.at, x.impact).momentum;
  REQUIRE(managed);
  REQUIRE(managed->least_time);
  CHECK(*managed->least_time == Approx(63.150).epsilon(0).margin(5e-4));
  // Without a wheel about an axis that needs one there is no time.
  x.problem.post_impact.wheels.torque.y() = 0;
  CHECK_FALSE(account_after_impact(x.problem, x.at, x.impact).momentum->least_time.has_value());
  x.impact.total.y() = 0;
  CHECK(account_after_impact(x.problem, x.at, x.impact).momentum->least_time.has_value());
}

TEST_CASE("after a latch the managed momentum is that of robot and target, else the robot's") {
  Latched x;
  const auto managed = account_after_impact(x.problem, x.at, x.impact).momentum;
  REQUIRE(managed);
  CHECK(managed->angular == x.impact.total);
  CHECK(managed->linear.norm() == Approx(224 * 0.015).epsilon(1e-12));
  // The latch that the simulation makes has it.
  const AfterContact run = simulate_post_impact(x.problem, x.at, x.impact, "none");
  const TraceSample& first = run.simulation.trace.front();
  CHECK((first.total - managed->angular).norm() < 1e-9 * first.total.norm());
  const Vector3d P_B = first.state.base.orientation.conjugate() * first.P_N;
  CHECK((P_B - managed->linear).norm() < 1e-9 * P_B.norm());

  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  const auto bounced = account_after_impact(problem, at, impact).momentum;
  REQUIRE(bounced);
  CHECK(bounced->linear.norm() == Approx(impact.Fbar.head<3>().norm()));
  CHECK_FALSE(bounced->least_time.has_value());
  const CaptureProblem given = test::shipped("spart_given_push");
  const Configuration there = start_configuration(given);
  CHECK_FALSE(account_after_impact(given, there, impact_at(given, there)).momentum.has_value());
}

TEST_CASE("a latch that takes no impulse at all leaves the target's momentum to be managed") {
  const CaptureProblem matched = test::shipped("matched_medium");
  const Configuration at = start_configuration(matched);
  ImpactSummary impact = impact_at(matched, at);
  REQUIRE(impact.before);
  const Vector3d managed = account_after_impact(matched, at, impact).momentum->linear;
  CHECK(managed.norm() > 1);
  impact.Fbar.setZero();
  CHECK(account_after_impact(matched, at, impact).momentum->linear == managed);
}

TEST_CASE("the limit that is used most stands first, and every limit is there once") {
  Latched x;
  PostImpactSpec& spec = x.problem.post_impact;
  spec.controllers = {"detumble"};
  spec.wheels.torque.setConstant(1);
  spec.wheels.momentum.setConstant(50);
  spec.grip.force = 1e4;
  spec.grip.moment = 1e4;
  const auto managed = account_after_impact(x.problem, x.at, x.impact).momentum;
  REQUIRE(managed);
  CHECK(managed->limits.size() == 9);
  for (std::size_t i = 1; i < managed->limits.size(); ++i) {
    CHECK(managed->limits[i].part() <= managed->limits[i - 1].part());
  }
  for (int i = 0; i < 9; ++i) CHECK(find(*managed, static_cast<CaptureLimit>(i)) != nullptr);
  REQUIRE(managed->remaining);
}

TEST_CASE("under detumble the limit that binds is the one at which a load stays longest") {
  CaptureProblem problem = test::shipped("detumble_client_1000");
  PostImpactSpec& spec = problem.post_impact;
  const Configuration at = start_configuration(problem);
  const ImpactSummary impact = impact_at(problem, at);
  const auto by_wheels = account_after_impact(problem, at, impact).momentum;
  REQUIRE(by_wheels->longest_held);
  REQUIRE(by_wheels->rest_time);
  CHECK(by_wheels->longest_held->limit == CaptureLimit::WheelTorque);
  CHECK(by_wheels->longest_held->time > 0.5 * *by_wheels->rest_time);
  CHECK(by_wheels->longest_held->time <= *by_wheels->rest_time);
  CHECK(is_bound(*by_wheels, spec.horizon));
  // Stronger wheels leave it to a weaker grip, which has to turn the target.
  const LimitUse* const moment = find(*by_wheels, CaptureLimit::GripMoment);
  REQUIRE(moment != nullptr);
  spec.grip.moment = 0.03 * moment->value;
  spec.wheels.torque *= 10;
  const auto by_grip = account_after_impact(problem, at, impact).momentum;
  REQUIRE(by_grip->longest_held);
  REQUIRE(by_grip->rest_time);
  CHECK(by_grip->longest_held->limit == CaptureLimit::GripMoment);
  CHECK(by_grip->longest_held->place == problem.robot.hand);
  CHECK(by_grip->longest_held->time > 0.9 * *by_grip->rest_time);
  spec.controllers = {"rns_damped"};
  CHECK_FALSE(account_after_impact(problem, at, impact).momentum->longest_held.has_value());
}

TEST_CASE("under detumble the limit that binds is the one whose change changes the time") {
  struct Case {
    const char* name;
    std::optional<CaptureLimit> binds;
    std::function<void(CaptureProblem&)> change;
  };
  const auto strong = [](CaptureProblem& problem) { problem.post_impact.wheels.torque *= 20; };
  const Case cases[] = {
      {"wheels", CaptureLimit::WheelTorque, [](CaptureProblem&) {}},
      {"strong wheels", CaptureLimit::WheelTorque, strong},
      {"grip moment", CaptureLimit::GripMoment,
       [&](CaptureProblem& problem) {
         strong(problem);
         problem.post_impact.grip.moment = 1.5;
       }},
      {"grip force", CaptureLimit::GripForce,
       [&](CaptureProblem& problem) {
         strong(problem);
         problem.post_impact.grip.force = 1;
       }},
      {"joint torque", CaptureLimit::JointTorque,
       [&](CaptureProblem& problem) {
         strong(problem);
         for (Joint& joint : problem.robot.joints) joint.max_effort = 1;
       }},
      // The wheels' torque is held for most of the time, and then the joints come to rest.
      {"gains beside wheels", std::nullopt,
       [](CaptureProblem& problem) { problem.post_impact.wheels.torque *= 30; }},
      {"gains alone", std::nullopt,
       [](CaptureProblem& problem) { problem.post_impact.wheels.torque *= 500; }},
  };
  const auto account = [](const CaptureProblem& problem) {
    const Configuration at = start_configuration(problem);
    return *account_after_impact(problem, at, impact_at(problem, at)).momentum;
  };
  for (const Case& one : cases) {
    INFO(one.name);
    CaptureProblem problem = test::shipped("detumble_client_1000");
    one.change(problem);
    const PostImpactSpec& spec = problem.post_impact;
    const ManagedMomentum managed = account(problem);
    REQUIRE(managed.rest_time);
    REQUIRE(is_bound(managed, spec.horizon) == one.binds.has_value());
    if (one.binds) CHECK(managed.longest_held->limit == *one.binds);
    if (one.binds == CaptureLimit::WheelTorque)
      CHECK(*managed.rest_time < 1.05 * *managed.least_time);
    // A tenth more of each limit saves time where it binds and next to none elsewhere.
    const auto saved = [&](const std::function<void(CaptureProblem&)>& more) {
      CaptureProblem other = problem;
      more(other);
      return 1 - *account(other).rest_time / *managed.rest_time;
    };
    const std::map<CaptureLimit, double> savings = {
        {CaptureLimit::WheelTorque,
         saved([](CaptureProblem& other) { other.post_impact.wheels.torque *= 1.1; })},
        {CaptureLimit::GripForce,
         saved([](CaptureProblem& other) { *other.post_impact.grip.force *= 1.1; })},
        {CaptureLimit::GripMoment,
         saved([](CaptureProblem& other) { *other.post_impact.grip.moment *= 1.1; })},
        {CaptureLimit::JointTorque, saved([](CaptureProblem& other) {
           for (Joint& joint : other.robot.joints) joint.max_effort *= 1.1;
         })}};
    for (const auto& [limit, saving] : savings) {
      INFO(to_string(limit) << " " << saving);
      CHECK((saving > 0.05) == (one.binds == limit));
    }
  }
}

TEST_CASE("wheels that are too small and a grip that is too weak break the limits by name") {
  Latched x;
  PostImpactSpec& spec = x.problem.post_impact;
  spec.controllers = {"detumble"};
  spec.residual_base_rate_max = 10;
  spec.attitude_change_max = 3;
  spec.horizon = 30;
  for (Joint& joint : x.problem.robot.joints) {
    joint.lower = -20;
    joint.upper = 20;
    joint.max_velocity = 20;
  }
  const double h = x.impact.total.lpNorm<Eigen::Infinity>();
  spec.wheels.torque.setConstant(h / 5);
  spec.wheels.momentum.setConstant(2 * h);
  CHECK(post_impact_failure(x.problem, x.at, x.impact, {}) == "");
  const auto enough = account_after_impact(x.problem, x.at, x.impact).momentum;
  REQUIRE(find(*enough, CaptureLimit::WheelMomentum) != nullptr);
  CHECK(find(*enough, CaptureLimit::WheelMomentum)->margin() > 0);

  spec.wheels.momentum.setConstant(0.5 * h);
  CHECK(post_impact_failure(x.problem, x.at, x.impact, {}).find("wheel momentum of ") == 0);
  const auto full = account_after_impact(x.problem, x.at, x.impact).momentum;
  CHECK(find(*full, CaptureLimit::WheelMomentum)->value == Approx(h).epsilon(1e-3));
  CHECK(find(*full, CaptureLimit::WheelMomentum)->margin() < 0);
  spec.wheels.preset = -0.5 * x.impact.total;
  CHECK(find(*account_after_impact(x.problem, x.at, x.impact).momentum, CaptureLimit::WheelMomentum)
            ->part() == Approx(1).epsilon(0.02));
  spec.wheels.preset.setZero();
  // Thrusters take what the wheels do not.
  spec.thrusters.torque = 1;
  CHECK(find(*account_after_impact(x.problem, x.at, x.impact).momentum, CaptureLimit::WheelMomentum)
            ->part() <= 1 + 1e-6);
  spec.thrusters.torque = 0;
  spec.wheels.momentum.setConstant(2 * h);

  spec.horizon = 3;
  CHECK(post_impact_failure(x.problem, x.at, x.impact, {}) ==
        "robot and target do not rest within the horizon of 3 s");
  const auto late = account_after_impact(x.problem, x.at, x.impact).momentum;
  CHECK_FALSE(late->rest_time.has_value());
  CHECK(find(*late, CaptureLimit::TimeWindow)->place == "horizon");
  CHECK(find(*late, CaptureLimit::TimeWindow)->part() > 1);
  spec.horizon = 30;
  spec.grip.force = 1e-6;  // what coasting takes is more
  const std::string open = post_impact_failure(x.problem, x.at, x.impact, {});
  CHECK(open.find("grip force of hand") == 0);
  CHECK(open.find(" after 0.01 s") != std::string::npos);  // what follows is not simulated
}

TEST_CASE("a joint that rests at its stop uses all of its range and no more") {
  Latched x;
  x.problem.post_impact.controllers.clear();
  // Beyond the stop by rounding, as the end of a simulation leaves it.
  Joint& joint = x.problem.robot.joints[0];
  x.at.phi[0] = 0.7;
  joint.lower = -1.1;
  joint.upper = 0.7 * (1 - 1e-14);
  const auto managed = account_after_impact(x.problem, x.at, x.impact).momentum;
  const LimitUse* stop = find(*managed, CaptureLimit::JointStop);
  REQUIRE(stop != nullptr);
  REQUIRE(stop->place == joint.name);
  CHECK(stop->margin() == 0);
  CHECK_FALSE(is_exceeded(*stop));
}

TEST_CASE("momentum about an axis without a wheel is told as such") {
  const LimitUse use{CaptureLimit::WheelMomentum, "z", 4.731, 0, "N m s"};
  CHECK(limit_words(use) == "wheel momentum of z: 4.731 N m s, and there is no wheel about z");
  CHECK(limit_words({CaptureLimit::WheelMomentum, "y", 12.3, 10, "N m s"}) ==
        "wheel momentum of y: 12.3 N m s of 10 N m s");
}

}  // namespace stillbase
