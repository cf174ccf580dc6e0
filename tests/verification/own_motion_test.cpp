// The motion after the contact by two codes.
#include <catch2/catch.hpp>

#include <functional>

#include "../reference/random_state.hpp"
#include "reference/controlled_motion.hpp"
#include "verification/contact_case.hpp"
#include "verification/example_plans.hpp"
#include "verification/latched_plan.hpp"
#include "verification/own_motion.hpp"

using namespace stillbase;
using namespace stillbase::verification;
using namespace stillbase::verification_test;

namespace {

using Kind = reference::ControlLaw::Kind;

constexpr std::pair<ControllerKind, Kind> kLaws[] = {
    {ControllerKind::None, Kind::Free},
    {ControllerKind::JointDamping, Kind::JointDamping},
    {ControllerKind::JointDampingLiteral, Kind::JointDampingLiteral},
    {ControllerKind::Rns, Kind::Rns},
    {ControllerKind::RnsDamped, Kind::RnsDamped},
    {ControllerKind::RnsHandback, Kind::RnsHandback},
    {ControllerKind::Detumble, Kind::Detumble},
};

SimulationOptions precise(double horizon, double period) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = 1e-12;
  options.absolute_tolerance = 1e-13;
  options.horizon = horizon;
  options.output_period = horizon / 4;
  options.control_period = period;
  return options;
}

/// Largest difference of the states at the samples.
double apart(const std::vector<TraceSample>& trace, const reference::ControlledMotion& own) {
  double most = own.samples.size() == trace.size() ? 0 : kInfinity;
  for (std::size_t i = 0; i < std::min(trace.size(), own.samples.size()); ++i) {
    const reference::State& state = own.samples[i].state;
    most = std::max({most, (trace[i].state.Omega - state.Omega).norm(),
                     (trace[i].state.phidot - state.phidot).norm(),
                     (trace[i].state.phi - state.phi).norm(),
                     (trace[i].state.wheel_momentum - own.samples[i].wheel_momentum).norm()});
  }
  return most;
}

/// The first controller's motion of a plan, as the verification has it.
AfterContact run_of(const Context& context, const std::string& controller) {
  const Situation& at = context.situation;
  const ContactCase subject = contact_case(context.problem, at.target(), at.event, at.response,
                                           at.at, at.event.n, at.impulse());
  const PostImpactSpec& spec = context.problem.post_impact;
  SimulationOptions options = plant_options_of(spec, context.problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.output_period = spec.horizon / 20;
  return simulate_after_contact(subject, spec, *controller_of(spec, controller), options);
}

}  // namespace

TEST_CASE("random robots move alike by two codes under every law, sampled and continuous") {
  Random random(17);
  for (const double period : {0.05, 0.0}) {
    for (const auto& [kind, law_kind] : kLaws) {
      const bool is_sampled = period > 0;
      RobotModel robot = reference_test::random_robot(random, 5, is_sampled);
      // Kinks within a step would hide behind the errors of both integrators.
      const bool has_limits =
          is_sampled && (kind == ControllerKind::JointDamping || kind == ControllerKind::Detumble);
      for (Joint& joint : robot.joints) {
        joint.max_effort = has_limits ? 30 : kInfinity;
        joint.max_velocity = kInfinity;
        joint.viscous_friction = 0.4;
      }
      const reference::State state = reference_test::random_state(random, 5);
      JointResistance resistance;
      resistance.model = ResistanceModel::RotorInertia;
      resistance.rotor_inertia = JointVectord::LinSpaced(5, 0, 0.4);
      Controller controller;
      controller.kind = kind;
      controller.handback_start = is_sampled ? 0.25 : 0;
      controller.K_handback = 0.01;
      controller.friction_compensation = true;
      SimulationOptions options = precise(0.8, period);
      // The first wheel is soon full, the second one must not be overfilled, the third one binds.
      options.wheels.torque = is_sampled ? Vector3d(3, 3, 1) : Vector3d(1e3, 1e3, 1e3);
      if (is_sampled) options.wheels.momentum = Vector3d(0.5, 2, kInfinity);
      options.friction = true;
      // The law knows of friction that the joints do not have.
      RobotModel known = robot;
      for (Joint& joint : known.joints) joint.coulomb_friction = 0.7;
      options.controller_robot = known;
      if (is_sampled) {
        options.thrusters = {0.5, 0.3, 0.2};
        options.sensors.base_rate_error = 1e-3;
        options.sensors.joint_position_error = 2e-3;
        options.sensors.joint_rate_error = 3e-3;
        options.sensors.delay = 2 * period;
      }
      PlantState start{Pose{}, state.phi, state.Omega, state.phidot};
      start.wheel_momentum = Vector3d(0.1, -0.2, 0.3);
      const SimulationResult run =
          simulate_post_impact(robot, resistance, start, controller, options);
      REQUIRE(run.status == SimulationStatus::Finished);
      std::vector<double> times;
      for (const TraceSample& sample : run.trace) times.push_back(sample.time);

      reference::ControlLaw law{law_kind,
                                controller.K_omega,
                                controller.K_phi,
                                controller.rank_edge,
                                controller.joint_rate_edge,
                                period,
                                controller.handback_start,
                                controller.K_handback,
                                controller.K_detumble,
                                controller.reserve,
                                controller.friction_transition_rate};
      reference::ControlledRobot subject{robot, known, resistance.rotor_inertia};
      subject.wheels = {options.wheels.torque, options.wheels.momentum};
      subject.has_viscous_friction = true;
      if (is_sampled) {
        subject.thrusters = {0.5, 0.3, 0.2};
        subject.sensors = reference::Sensors{1e-3, 2e-3, 3e-3, 2};
      }
      const reference::Motion first{Pose{}, state, start.wheel_momentum};
      const auto own = reference::controlled_motion(subject, law, first, times, 1e-12, {});
      REQUIRE(own.complete);
      INFO(to_string(kind) << ", period " << period);
      CHECK(apart(run.trace, own) < 1e-7);
      if (is_sampled) {
        const Eigen::VectorXd torque = run.summary.peak_demanded_torques;
        CHECK((torque - own.peak_demanded_torques).norm() <= 1e-7 * (1 + torque.norm()));
        const Vector3d wheels = run.summary.peak_wheel_torques;
        CHECK((wheels - own.peak_wheel_torques).norm() <= 1e-7 * (1 + wheels.norm()));
      }

      // A gain that is wrong by a thousandth is seen, under all laws that have it.
      const auto notices = [&](const std::function<void(reference::ControlLaw&)>& change) {
        reference::ControlLaw altered = law;
        change(altered);
        const auto wrong = reference::controlled_motion(subject, altered, first, times, 1e-12, {});
        return apart(run.trace, wrong) > 1e-6;
      };
      if (law_kind == Kind::Free) continue;
      CHECK(notices([](reference::ControlLaw& x) { x.friction_rate = 0; }));
      const bool has_rns = is_reaction_null_space_control(kind);
      if (has_rns) CHECK(notices([](reference::ControlLaw& x) { x.K_omega *= 1.001; }));
      if (law_kind != Kind::Rns && !has_limits)
        CHECK(notices([](reference::ControlLaw& x) { x.K_phi *= 1.001; }));
      if (law_kind == Kind::RnsHandback) {
        CHECK(notices([](reference::ControlLaw& x) { x.K_handback *= 1.001; }));
      }
      if (law_kind == Kind::Detumble && has_limits) {
        CHECK(notices([](reference::ControlLaw& x) { x.reserve += 0.001; }));
      }
    }
  }
}

TEST_CASE("a motion after the contact that is wrong anywhere fails against the second one") {
  Plan plan = verification_test::arm_plan();
  int checked = 0;  // the checks of a plan that is not complete would not run
  PostImpactSpec& spec = plan.problem.post_impact;
  spec.horizon = 2;
  spec.handback_start = 0.5;
  spec.wheels.torque = Vector3d(0.5, 0.5, 0.5);
  for (const char* controller :
       {"rns_damped", "joint_damping", "none", "rns_handback", "detumble"}) {
    spec.controllers = {controller};
    (void)check_plan(plan, {}, [&](const Context& context, ClaimList&) {
      const AfterContact run = run_of(context, controller);
      REQUIRE(run.simulation.trace.size() == 21);
      const auto passes = [&](const std::function<void(AfterContact&)>& spoil) {
        AfterContact altered = run;
        spoil(altered);
        ClaimList claims;
        check_own_motion(context, controller, altered, claims);
        REQUIRE(claims.claims().size() == 1);
        REQUIRE(claims.claims().front().is_checked);
        return claims.all_pass();
      };
      INFO(controller);
      ++checked;
      CHECK(passes([](AfterContact&) {}));
      const auto at = [](AfterContact& x) -> PlantState& { return x.simulation.trace[3].state; };
      CHECK_FALSE(passes([&](AfterContact& x) { at(x).phi(2) += 1e-5; }));
      CHECK_FALSE(passes([&](AfterContact& x) { at(x).phidot *= 1 + 1e-4; }));
      CHECK_FALSE(passes([&](AfterContact& x) { at(x).Omega *= 1 + 1e-4; }));
      CHECK_FALSE(passes([&](AfterContact& x) { at(x).base.position.x() += 1e-5; }));
      CHECK_FALSE(passes([&](AfterContact& x) {
        at(x).base.orientation = at(x).base.orientation * rotation_exp({0, 1e-5, 0});
      }));
      CHECK_FALSE(passes([&](AfterContact& x) { at(x).wheel_momentum.y() += 1e-4; }));
      if (std::string(controller) == "none") return;
      CHECK_FALSE(
          passes([](AfterContact& x) { x.simulation.summary.peak_demanded_torques *= 1 + 1e-5; }));
    });
  }
}

TEST_CASE("a held target is braked alike by two codes, within the loads of its grip") {
  Plan plan = latched_plan();
  PostImpactSpec& spec = plan.problem.post_impact;
  spec.horizon = 4;
  SECTION("loads that do not bind") {}
  SECTION("a force") { spec.grip.force = 2; }
  SECTION("a moment") { spec.grip.moment = 1; }
  SECTION("a target that the controller takes for lighter") { spec.model.target_mass_scale = 0.8; }
  SECTION("a target that the controller does not know of") { spec.model.target_mass_scale = 0; }
  SECTION("momentum of the wheels before the contact") { spec.wheels.preset = {2, -1, 1}; }
  SECTION("all momentum by reaction null space control") { spec.controllers = {"rns_handback"}; }
  const VerifyOptions options;
  const Situation situation(plan.problem, plan.configuration);
  const Context context{plan, options, situation, situation.problem};
  const std::string controller = spec.controllers.front();
  const AfterContact run = run_of(context, controller);
  REQUIRE(run.is_held);
  const auto check = [&](const AfterContact& motion) {
    ClaimList claims;
    check_own_motion(context, controller, motion, claims);
    INFO(claims.claims().front().detail);
    CHECK(claims.claims().front().is_checked);
    return claims.all_pass();
  };
  CHECK(check(run));
  AfterContact altered = run;
  altered.simulation.trace.back().state.wheel_momentum *= 1 + 1e-4;
  CHECK_FALSE(check(altered));
}

TEST_CASE("a motion that the second code lacks is not verified, with the reason") {
  const auto reason = [](const std::function<void(CaptureProblem&)>& change) {
    Plan plan = verification_test::arm_plan();
    plan.problem.post_impact.horizon = 0.2;
    plan.problem.post_impact.controllers = {"rns_damped"};
    change(plan.problem);
    ClaimList claims;
    (void)check_plan(plan, {}, [&](const Context& context, ClaimList&) {
      check_own_motion(context, "rns_damped", run_of(context, "rns_damped"), claims);
    });
    REQUIRE(claims.claims().size() == 1);
    CHECK_FALSE(claims.claims().front().is_checked);
    return claims.claims().front().detail;
  };
  CHECK_THAT(reason([](CaptureProblem& x) {
               x.post_impact.joint_friction = true;
               x.robot.joints.front().coulomb_friction = 0.1;
             }),
             Catch::Contains("Coulomb"));
  CHECK_THAT(
      reason([](CaptureProblem& x) { x.post_impact.contact.model = ContactModel::Compliant; }),
      Catch::Contains("compliant"));
}
