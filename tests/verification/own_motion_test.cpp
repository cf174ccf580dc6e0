// The motion after the contact by two codes.
#include <catch2/catch.hpp>

#include "../reference/random_state.hpp"
#include "reference/controlled_motion.hpp"
#include "verification/contact_case.hpp"
#include "verification/example_plans.hpp"
#include "verification/own_motion.hpp"

using namespace stillbase;
using namespace stillbase::verification;

namespace {

using Kind = reference::ControlLaw::Kind;

constexpr std::pair<ControllerKind, Kind> kLaws[] = {
    {ControllerKind::None, Kind::Free},
    {ControllerKind::JointDamping, Kind::JointDamping},
    {ControllerKind::JointDampingLiteral, Kind::JointDampingLiteral},
    {ControllerKind::Rns, Kind::Rns},
    {ControllerKind::RnsDamped, Kind::RnsDamped},
};

SimulationOptions precise(double horizon, double period) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = 1e-11;
  options.absolute_tolerance = 1e-13;
  options.horizon = horizon;
  options.output_period = horizon / 4;
  options.control_period = period;
  return options;
}

/// Largest difference of the velocities at the samples.
double apart(const std::vector<TraceSample>& trace, const reference::ControlledMotion& own) {
  double most = own.samples.size() == trace.size() ? 0 : kInfinity;
  for (std::size_t i = 0; i < std::min(trace.size(), own.samples.size()); ++i) {
    const reference::State& state = own.samples[i].state;
    most = std::max({most, (trace[i].state.Omega - state.Omega).norm(),
                     (trace[i].state.phidot - state.phidot).norm(),
                     (trace[i].state.phi - state.phi).norm()});
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
      RobotModel robot = reference_test::random_robot(random, 5, period > 0);
      for (Joint& joint : robot.joints) {
        joint.max_effort = kind == ControllerKind::JointDamping ? 30 : kInfinity;
        joint.max_velocity = kInfinity;
      }
      const reference::State state = reference_test::random_state(random, 5);
      JointResistance resistance;
      resistance.model = ResistanceModel::RotorInertia;
      resistance.rotor_inertia = JointVectord::LinSpaced(5, 0, 0.4);
      Controller controller;
      controller.kind = kind;
      const SimulationOptions options = precise(0.8, period);
      const PlantState start{Pose{}, state.phi, state.Omega, state.phidot};
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
                                period};
      const reference::ControlledRobot subject{robot, robot, resistance.rotor_inertia};
      const auto own =
          reference::controlled_motion(subject, law, {Pose{}, state}, times, 1e-11, {});
      REQUIRE(own.complete);
      INFO(to_string(kind) << ", period " << period);
      CHECK(apart(run.trace, own) < 1e-7);
      if (period > 0) {
        const Eigen::VectorXd torque = run.summary.peak_demanded_torques;
        CHECK((torque - own.peak_demanded_torques).norm() <= 1e-7 * (1 + torque.norm()));
      }

      // A gain that is wrong by a thousandth is seen, by all laws that have it.
      law.K_phi *= 1.001;
      law.K_omega *= 1.001;
      const auto wrong =
          reference::controlled_motion(subject, law, {Pose{}, state}, times, 1e-11, {});
      if (law_kind != Kind::Free) CHECK(apart(run.trace, wrong) > 1e-6);
    }
  }
}

TEST_CASE("a motion after the contact that is wrong anywhere fails against the second one") {
  Plan plan = verification_test::arm_plan();
  int checked = 0;  // the checks of a plan that is not complete would not run
  for (const char* controller : {"rns_damped", "joint_damping", "none"}) {
    plan.problem.post_impact.controllers = {controller};
    plan.problem.post_impact.horizon = 2;
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
      if (std::string(controller) == "none") return;
      CHECK_FALSE(
          passes([](AfterContact& x) { x.simulation.summary.peak_demanded_torques *= 1 + 1e-5; }));
    });
  }
}

TEST_CASE("a motion that the second code lacks is not verified, with the reason") {
  Plan plan = verification_test::arm_plan();
  plan.problem.post_impact.horizon = 0.2;
  plan.problem.post_impact.controllers = {"rns_handback"};
  ClaimList claims;
  (void)check_plan(plan, {}, [&](const Context& context, ClaimList&) {
    check_own_motion(context, "rns_handback", run_of(context, "rns_handback"), claims);
  });
  REQUIRE(claims.claims().size() == 1);
  CHECK_FALSE(claims.claims().front().is_checked);
  CHECK_THAT(claims.claims().front().detail, Catch::Contains("wheels"));
}
