// What a plan says of the momentum after the contact, against the verifier's own account.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "verification/contact_case.hpp"
#include "verification/example_plans.hpp"
#include "verification/grip_load.hpp"
#include "verification/latched_plan.hpp"

using namespace stillbase;
using namespace stillbase::verification;
using namespace stillbase::verification_test;

namespace {

/// The run that the verification judges.
AfterContact run_of(const Context& context) {
  const Situation& at = context.situation;
  const PostImpactSpec& spec = context.problem.post_impact;
  SimulationOptions options = plant_options_of(spec, context.problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance = 1e-13;
  options.output_period = spec.horizon / 200;
  return simulate_after_contact(contact_case(context.problem, at.target(), at.event, at.response,
                                             at.at, at.event.n, at.impulse()),
                                spec, *controller_of(spec, spec.controllers.front()), options);
}

std::string failing(const ClaimList& claims) {
  std::string names;
  for (const Claim& claim : claims.claims()) {
    if (claim.fails()) names += claim.name + " ";
  }
  return names;
}

/// Names of the checks of the account that fail.
std::string failures_of(const Plan& plan, const AfterContact& run) {
  const VerifyOptions options;
  const Situation situation(plan.problem, plan.configuration);
  const Context context{plan, options, situation, situation.problem};
  ClaimList claims;
  check_managed_momentum(context, &run, claims);
  CHECK_FALSE(claims.claims().empty());
  return failing(claims);
}

AfterContact run_of(const Plan& plan) {
  const VerifyOptions options;
  const Situation situation(plan.problem, plan.configuration);
  return run_of(Context{plan, options, situation, situation.problem});
}

}  // namespace

TEST_CASE("an account of the momentum holds, and fails with any number of it altered") {
  const Plan plan = latched_plan();
  REQUIRE(plan.managed_momentum);
  REQUIRE(plan.managed_momentum->limits.size() >= 8);
  const AfterContact run = run_of(plan);
  CHECK(failures_of(plan, run) == "");

  const auto altered = [&](const std::function<void(ManagedMomentum&)>& change) {
    Plan other = plan;
    change(*other.managed_momentum);
    return failures_of(other, run);
  };
  for (int i = 0; i < 3; ++i) {
    CHECK(altered([i](ManagedMomentum& m) { m.angular(i) *= 1 + 1e-6; }) == "managed_momentum ");
    CHECK(altered([i](ManagedMomentum& m) { m.linear(i) += 1e-6 * m.linear.norm(); }) ==
          "managed_momentum ");
  }
  CHECK(altered([](ManagedMomentum& m) { *m.least_time *= 1 + 1e-6; }) == "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) { m.least_time.reset(); }) == "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) { m.remaining.reset(); }) == "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) { *m.remaining += 0.01 * m.angular.norm(); }) ==
        "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) {
          m.rest_time = m.rest_time ? std::optional<double>() : std::optional<double>(3);
        }) == "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) { std::swap(m.limits.front(), m.limits.back()); }) ==
        "capture_limits ");
  CHECK(altered([](ManagedMomentum& m) { m.limits.push_back(m.limits.back()); }) ==
        "capture_limits ");
  for (std::size_t i = 0; i < plan.managed_momentum->limits.size(); ++i) {
    INFO(to_string(plan.managed_momentum->limits[i].limit));
    const auto limit = [&](const std::function<void(LimitUse&)>& change) {
      return altered([&](ManagedMomentum& m) { change(m.limits[i]); });
    };
    CHECK(limit([](LimitUse& use) { use.value += 0.005 * use.most; }) == "capture_limits ");
    CHECK(limit([](LimitUse& use) { use.most *= 1 + 1e-6; }) == "capture_limits ");
    CHECK(limit([](LimitUse& use) { use.place += "_"; }) == "capture_limits ");
    CHECK(limit([](LimitUse& use) { use.unit += "s"; }) == "capture_limits ");
    CHECK(altered([&](ManagedMomentum& m) {
            m.limits.erase(m.limits.begin() + static_cast<std::ptrdiff_t>(i));
          }) == "capture_limits ");
  }
}

TEST_CASE("the limit that detumble holds longest is recounted by the samples of the run") {
  const Plan plan = latched_plan();
  REQUIRE(plan.managed_momentum->longest_held);
  const AfterContact run = run_of(plan);
  const auto fails = [&](const std::function<void(std::optional<HeldLimit>&)>& change) {
    Plan other = plan;
    change(other.managed_momentum->longest_held);
    return failures_of(other, run) == "capture_limits ";
  };
  CHECK_FALSE(fails([](std::optional<HeldLimit>&) {}));
  CHECK(fails([](std::optional<HeldLimit>& held) { held.reset(); }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->time *= 0.5; }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->time *= 1.5; }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->time -= 0.15; }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->time += 0.15; }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->place += "_"; }));
  CHECK(fails([](std::optional<HeldLimit>& held) { held->limit = CaptureLimit::Reach; }));
  Plan other = latched_plan("rns_damped");
  const AfterContact damped = run_of(other);
  CHECK_FALSE(other.managed_momentum->longest_held);
  CHECK(failures_of(other, damped) == "");
  other.managed_momentum->longest_held = plan.managed_momentum->longest_held;
  CHECK(failures_of(other, damped) == "capture_limits ");
}

TEST_CASE("another joint than the one that uses most of a limit is no account of it") {
  const Plan plan = latched_plan();
  const AfterContact run = run_of(plan);
  const std::vector<Joint>& joints = plan.problem.robot.joints;
  const JointVectord& rates = run.simulation.summary.peak_joint_rates;
  const auto part = [&](std::size_t k) {
    return rates[static_cast<Eigen::Index>(k)] / joints[k].max_velocity;
  };
  std::size_t least = 0, largest = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (part(k) < part(least)) least = k;
    if (part(k) > part(largest)) largest = k;
  }
  REQUIRE(part(least) < 0.9 * part(largest));
  Plan other = plan;
  for (LimitUse& use : other.managed_momentum->limits) {
    if (use.limit != CaptureLimit::JointRate) continue;
    CHECK(use.place == joints[largest].name);
    use.place = joints[least].name;
    use.value = rates[static_cast<Eigen::Index>(least)];
    use.most = joints[least].max_velocity;
  }
  std::stable_sort(other.managed_momentum->limits.begin(), other.managed_momentum->limits.end(),
                   [](const LimitUse& x, const LimitUse& y) { return x.part() > y.part(); });
  CHECK(failures_of(other, run) == "capture_limits ");
}

TEST_CASE("demands on grip, wheels and time fail by name whatever the plan says") {
  const Plan plan = latched_plan();
  const AfterContact run = run_of(plan);
  const auto with = [&](const std::function<void(PostImpactSpec&)>& change) {
    Plan other = plan;
    change(other.problem.post_impact);
    other.managed_momentum.reset();
    other.status = PlanStatus::Infeasible;  // whose account may be missing
    return failures_of(other, run);
  };
  const SimulationSummary& summary = run.simulation.summary;
  CHECK(with([](PostImpactSpec&) {}) == "");
  CHECK(with([&](PostImpactSpec& s) { s.grip.force = 0.99 * summary.peak_grip_force; }) ==
        "grip_force ");
  CHECK(with([&](PostImpactSpec& s) { s.grip.moment = 0.99 * summary.peak_grip_moment; }) ==
        "grip_moment ");
  CHECK(with([&](PostImpactSpec& s) { s.wheels.torque *= 0.9; }) == "wheel_torque ");
  CHECK(with([&](PostImpactSpec& s) {
          s.wheels.momentum.setConstant(0.9 * summary.peak_wheel_momenta.maxCoeff());
        }) == "wheel_momentum ");
  AfterContact restless = run;
  restless.simulation.summary.rest_time.reset();
  Plan other = plan;
  other.managed_momentum.reset();
  CHECK(failures_of(other, restless) == "managed_momentum_stated detumbled ");
}

TEST_CASE("a grip's wrench that is not the rate of the target's momentum is found") {
  for (const char* controller : {"detumble", "rns_damped", "none"}) {
    const Plan plan = latched_plan(controller);
    const VerifyOptions options;
    const Situation situation(plan.problem, plan.configuration);
    const Context context{plan, options, situation, situation.problem};
    const AfterContact run = run_of(context);
    const auto passes = [&](const std::function<void(AfterContact&)>& spoil) {
      AfterContact other = run;
      spoil(other);
      ClaimList claims;
      check_grip_load(context, other, claims);
      REQUIRE(claims.claims().size() == 1);
      REQUIRE(claims.claims().front().is_checked);
      return claims.all_pass();
    };
    INFO(controller);
    CHECK(passes([](AfterContact&) {}));
    Vector6d largest = Vector6d::Zero();
    for (const TraceSample& sample : run.simulation.trace) {
      largest = largest.cwiseMax(sample.grip_wrench.cwiseAbs());
    }
    for (int i = 0; i < 6; ++i) {
      const double size = i < 3 ? largest.head<3>().norm() : largest.tail<3>().norm();
      CHECK_FALSE(
          passes([&](AfterContact& x) { x.simulation.trace[2].grip_wrench(i) += 1e-5 * size; }));
    }
    CHECK_FALSE(passes([](AfterContact& x) { x.simulation.trace[0].wheel_torque.x() += 0.1; }));
  }
}

TEST_CASE("what a plan says of the time after the horizon is recomputed") {
  Plan plan = arm_plan();
  plan.problem.approach.enabled = false;
  plan.after_horizon = motion_after_horizon(plan.problem, plan.configuration, plan.impact,
                                            plan.problem.post_impact.controllers.front());
  REQUIRE(plan.after_horizon);
  const auto fails = [](const Plan& judged) {
    std::string names;
    for (const Claim& claim : judge_plan(judged, {}).claims) {
      if (claim.fails() && claim.name.find("after_horizon") == 0) names += claim.name + " ";
    }
    return names;
  };
  CHECK(fails(plan) == "");
  plan.after_horizon->joint_rate *= 1.001;
  CHECK(fails(plan) == "after_horizon_joint_rate ");
  plan.after_horizon->joint_rate /= 1.001;
  std::optional<double>& stop_time = plan.after_horizon->stop_time;
  if (stop_time) {
    *stop_time *= 1.01;
    CHECK(fails(plan) == "after_horizon_stop_time ");
    stop_time.reset();
  } else {
    stop_time = 2 * plan.problem.post_impact.horizon;
  }
  CHECK(fails(plan) == "after_horizon ");
  plan.after_horizon.reset();
  CHECK(fails(plan) == "after_horizon ");
}

TEST_CASE("a stop that a joint reaches at once is compared to rounding") {
  Plan plan = arm_plan();
  plan.problem.approach.enabled = false;
  for (int k = 0; k < plan.problem.robot.n(); ++k) {
    plan.problem.robot.joints[k].lower = plan.problem.robot.joints[k].upper =
        plan.configuration.phi[k];
  }
  plan.after_horizon = motion_after_horizon(plan.problem, plan.configuration, plan.impact,
                                            plan.problem.post_impact.controllers.front());
  REQUIRE(plan.after_horizon);
  REQUIRE(plan.after_horizon->stop_time);
  REQUIRE(*plan.after_horizon->stop_time < 1e-9);
  const auto fails_later_by = [&](double seconds) {
    Plan judged = plan;
    *judged.after_horizon->stop_time += seconds;
    for (const Claim& claim : judge_plan(judged, {}).claims) {
      if (claim.name == "after_horizon_stop_time") return claim.fails();
    }
    FAIL("not judged");
    return true;
  };
  CHECK_FALSE(fails_later_by(0));
  CHECK_FALSE(fails_later_by(1e-12));
  CHECK(fails_later_by(1e-6));
}

TEST_CASE("where no joint reaches a stop after the horizon, none is named") {
  Plan plan = arm_plan();
  plan.problem.approach.enabled = false;
  plan.problem.post_impact.controllers = {"joint_damping"};
  plan.after_horizon =
      motion_after_horizon(plan.problem, plan.configuration, plan.impact, "joint_damping");
  REQUIRE(plan.after_horizon);
  REQUIRE_FALSE(plan.after_horizon->stop_time);
  const auto fails = [](const Plan& judged) {
    std::string names;
    for (const Claim& claim : verify_plan(judged, {}).claims) {
      if (claim.fails() && claim.name.find("after_horizon") == 0) names += claim.name + " ";
    }
    return names;
  };
  CHECK(fails(plan) == "");
  plan.after_horizon->joint = plan.problem.robot.joints.front().name;
  CHECK(fails(plan) == "after_horizon ");
  plan.after_horizon->joint.clear();
  plan.problem.post_impact.controllers.clear();
  CHECK(fails(plan) == "after_horizon ");
}
