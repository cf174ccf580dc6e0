// The motion after the contact by two codes.
#include <catch2/catch.hpp>

#include <functional>

#include "../reference/random_state.hpp"
#include "reference/controlled_motion.hpp"
#include "verification/contact_case.hpp"
#include "verification/example_plans.hpp"
#include "verification/latched_plan.hpp"
#include "verification/own_motion.hpp"
#include "verification/two_codes.hpp"

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

/// A plan under judgement.
struct Judged {
  explicit Judged(Plan judged) : plan(std::move(judged)) {}
  Plan plan;
  VerifyOptions options;
  Situation situation{plan.problem, plan.configuration};
  Context context{plan, options, situation, situation.problem};
};

Claim second_motion_of(const Judged& stated, const std::string& controller, const AfterContact& run,
                       bool is_checked = true) {
  ClaimList claims;
  check_own_motion(stated.context, controller, run, claims);
  REQUIRE(claims.claims().size() == 1);
  INFO(claims.claims().front().detail);
  REQUIRE(claims.claims().front().is_checked == is_checked);
  return claims.claims().front();
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
      options.wheels.torque = is_sampled ? Vector3d(3, 3, 1) : Vector3d(5e3, 5e3, 5e3);
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
      const std::vector<double> times = times_of(run.trace);

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
      subject.has_friction = true;
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

TEST_CASE("friction, a compliant contact and errors of the model are seen by the second code") {
  Plan plan = verification_test::arm_plan();
  PostImpactSpec& spec = plan.problem.post_impact;
  spec.horizon = 1;
  spec.controllers = {"rns_damped"};
  spec.joint_friction = true;
  for (Joint& joint : plan.problem.robot.joints) joint.coulomb_friction = 0.02;
  spec.model.base_mass_scale = 1.1;
  spec.model.arm_mass_scale = 0.95;
  spec.model.friction_scale = 0.5;
  const bool is_compliant = GENERATE(false, true);
  if (is_compliant) {
    spec.contact.model = ContactModel::Compliant;
    spec.contact.friction = 0.3;
  }
  const Judged stated(plan);
  // The run of a problem that differs, against the second motion of the stated one.
  const auto passes = [&](const std::function<void(CaptureProblem&)>& change) {
    Plan other = plan;
    change(other.problem);
    const AfterContact run = run_of(Judged(other).context, "rns_damped");
    CHECK(run.encounter.has_value() == is_compliant);
    return second_motion_of(stated, "rns_damped", run).pass;
  };
  INFO("compliant: " << is_compliant);
  using Problem = CaptureProblem;
  CHECK(passes([](Problem&) {}));
  CHECK_FALSE(passes([](Problem& x) { x.robot.joints[2].coulomb_friction *= 1.01; }));
  CHECK_FALSE(passes([](Problem& x) { x.post_impact.model.base_mass_scale = 1.1001; }));
  CHECK_FALSE(passes([](Problem& x) { x.post_impact.model.arm_mass_scale = 0.9501; }));
  CHECK_FALSE(passes([](Problem& x) { x.post_impact.model.friction_scale = 0.501; }));
  if (!is_compliant) return;
  CHECK_FALSE(passes([](Problem& x) { x.post_impact.contact.stiffness *= 1.001; }));
  CHECK_FALSE(passes([](Problem& x) { x.post_impact.contact.friction *= 1.001; }));
  CHECK_FALSE(passes([](Problem& x) { x.impulse.restitution += 1e-4; }));
  CHECK_FALSE(passes([](Problem& x) { x.target->mass *= 1.0001; }));
}

TEST_CASE("a motion with two joints at their stops is not verified, with the reason") {
  Plan plan = verification_test::arm_plan();
  plan.problem.post_impact.horizon = 0.5;
  plan.problem.post_impact.controllers = {"none"};
  for (const int k : {1, 3}) {
    Joint& joint = plan.problem.robot.joints[static_cast<std::size_t>(k)];
    joint.upper = plan.configuration.phi(k) + 1e-4;
    joint.lower = plan.configuration.phi(k) - 1e-4;
  }
  const Judged stated(plan);
  const Claim claim = second_motion_of(stated, "none", run_of(stated.context, "none"), false);
  CHECK_THAT(claim.detail, Catch::Contains("two joints"));
}
