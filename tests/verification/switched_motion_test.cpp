// Motion whose equations change on the way, by two codes: dry friction, stops, a compliant contact.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/core/rotation.hpp>
#include <stillbase/simulation/contact.hpp>

#include "../reference/random_state.hpp"
#include "reference/resting_joints.hpp"
#include "verification/two_codes.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

constexpr double kStep = 1e-12;  // error of a step

struct Case {
  RobotModel robot;
  reference::State state;
  Controller controller;
  SimulationOptions options;
  reference::ControlLaw law;

  SimulationResult simulated() const {
    return simulate_post_impact(robot, {}, {Pose{}, state.phi, state.Omega, state.phidot},
                                controller, options);
  }
  /// By the second code, of a robot that may differ.
  reference::ControlledMotion second(const RobotModel& other, const SimulationResult& run) const {
    reference::ControlledRobot subject{other, other, {}};
    subject.has_friction = true;
    subject.stop_restitution = options.stop_restitution;
    return reference::controlled_motion(subject, law, {Pose{}, state}, times_of(run.trace), kStep,
                                        {});
  }
};

Case damped_case(std::uint64_t seed, double period) {
  Random random(seed);
  Case out;
  out.robot = reference_test::random_robot(random, 4, false);
  for (Joint& joint : out.robot.joints) joint.max_effort = joint.max_velocity = kInfinity;
  out.state = reference_test::random_state(random, 4);
  out.state.phidot *= 0.3;
  out.state.Omega *= 0.3;
  out.controller.kind = ControllerKind::JointDamping;
  out.options = precise(2, period);
  out.options.output_period = 0.1;
  out.options.friction = true;
  out.law.kind = reference::ControlLaw::Kind::JointDamping;
  out.law.K_phi = out.controller.K_phi;
  out.law.rank_edge = out.controller.rank_edge;
  out.law.period = period;
  return out;
}

int samples_at_rest(const SimulationResult& run) {
  int count = 0;
  for (const TraceSample& sample : run.trace) {
    count += static_cast<int>((sample.state.phidot.array() == 0).count());
  }
  return count;
}

/// A resting robot whose hand a target is about to push.
struct PushedHand {
  Case at;
  EncounterPlant plant;
  TargetPlantState target;

  explicit PushedHand(std::uint64_t seed) : at(damped_case(seed, 0.01)) {
    Random random(seed);
    at.state.phidot.setZero();
    at.state.Omega.setZero();
    at.options.output_period = 0.05;
    plant.mass = 20;
    plant.inertia = reference_test::random_body(random, "target").inertia;
    plant.contact = {2e4, 30, 0.3, 1e-4, Vector3d(0.3, 0.1, -0.1), Vector3d::UnitX()};
    plant.servo_posture = at.state.phi;
    target.pose.orientation = Eigen::Quaterniond(reference_test::random_rotation(random));
    target.angular_velocity = reference_test::random_vector(random, 0.1);
    const Vector3d n = target.pose.orientation * plant.contact.normal;
    target.velocity = 0.1 * n + reference_test::random_vector(random, 0.02);
    const auto hand = reference::compute(at.robot, at.state);
    target.pose.position =
        hand.hand_position - target.pose.orientation * plant.contact.point - 0.003 * n;
  }

  EncounterResult simulated() const {
    return simulate_encounter(at.robot, {}, {Pose{}, at.state.phi, at.state.Omega, at.state.phidot},
                              target, plant, at.controller, at.options);
  }

  /// Largest difference of a run to the second code's with another contact.
  double distance(const EncounterResult& run,
                  const std::function<void(reference::SpringContact&)>& change) const {
    reference::ControlledRobot subject{at.robot, at.robot, {}};
    subject.has_friction = true;
    subject.contact = {plant.mass,
                       plant.inertia,
                       plant.contact.stiffness,
                       plant.contact.damping,
                       plant.contact.friction,
                       plant.contact.slip_rate,
                       plant.contact.point,
                       plant.contact.normal,
                       plant.servo.stiffness,
                       plant.servo.damping,
                       {}};
    if (plant.servo.stiffness.size() > 0) subject.contact->servo_posture = plant.servo_posture;
    change(*subject.contact);
    reference::Motion first{Pose{}, at.state};
    first.target = {target.pose, target.velocity, target.angular_velocity};
    const auto own = reference::controlled_motion(subject, at.law, first,
                                                  times_of(run.simulation.trace), kStep, {});
    REQUIRE(own.complete);
    return apart(run.simulation.trace, own);
  }
};

}  // namespace

TEST_CASE("joints under dry friction stick and slip alike by two codes") {
  int resting = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    for (const double period : {0.1, 0.0}) {
      Case at = damped_case(seed, period);
      for (Joint& joint : at.robot.joints) {
        joint.coulomb_friction = 0.8;
        joint.viscous_friction = 0.1;
      }
      const SimulationResult run = at.simulated();
      REQUIRE(run.status == SimulationStatus::Finished);
      resting += samples_at_rest(run);
      const auto own = at.second(at.robot, run);
      INFO("seed " << seed << ", period " << period);
      REQUIRE(own.complete);
      CHECK(apart(run.trace, own) < 1e-7);
      RobotModel other = at.robot;
      other.joints.front().coulomb_friction *= 1.001;
      CHECK(apart(run.trace, at.second(other, run)) > 1e-6);
    }
  }
  CHECK(resting > 100);
}

TEST_CASE("a joint reaches its stop, rests there and leaves it alike by two codes") {
  int hits = 0, resting = 0;
  for (const std::uint64_t seed : {11, 12, 13, 14, 15, 16}) {
    for (const double restitution : {0.0, 0.4}) {
      Case at = damped_case(seed, 0.1);
      for (Joint& joint : at.robot.joints) joint.coulomb_friction = 0.05;
      Joint& joint = at.robot.joints[1];
      joint.lower = at.state.phi(1) - 0.01;
      joint.upper = at.state.phi(1) + 0.01;
      at.options.stop_restitution = restitution;
      const SimulationResult run = at.simulated();
      REQUIRE(run.status == SimulationStatus::Finished);
      hits += run.summary.stop_hits;
      resting += samples_at_rest(run);
      const auto own = at.second(at.robot, run);
      INFO("seed " << seed << ", restitution " << restitution);
      REQUIRE(own.complete);
      CHECK(apart(run.trace, own) < 1e-7);
      if (run.summary.stop_hits == 0) continue;
      RobotModel other = at.robot;
      other.joints[1].lower -= 1e-5;
      other.joints[1].upper += 1e-5;
      CHECK(apart(run.trace, at.second(other, run)) > 1e-6);
    }
  }
  CHECK(hits > 12);
  CHECK(resting > 20);
}

TEST_CASE("hand and target push each other alike by two codes") {
  for (const std::uint64_t seed : {21, 22, 23}) {
    PushedHand pushed(seed);
    for (Joint& joint : pushed.at.robot.joints) joint.coulomb_friction = 0.3;
    pushed.plant.servo = {JointVectord::Constant(4, 50), JointVectord::Constant(4, 2)};
    pushed.at.options.horizon = 0.5;
    const EncounterResult run = pushed.simulated();
    REQUIRE(run.simulation.status == SimulationStatus::Finished);
    REQUIRE(run.contact.contacts > 0);
    INFO("seed " << seed);
    using Contact = reference::SpringContact;
    const auto distance = [&](const std::function<void(Contact&)>& change) {
      return pushed.distance(run, change);
    };
    CHECK(distance([](Contact&) {}) < 1e-7);
    CHECK(distance([](Contact& c) { c.stiffness *= 1.001; }) > 1e-6);
    CHECK(distance([](Contact& c) { c.damping *= 1.01; }) > 1e-6);
    CHECK(distance([](Contact& c) { c.friction = -c.friction; }) > 1e-4);
    CHECK(distance([](Contact& c) { c.friction *= 1.01; }) > 1e-6);
    CHECK(distance([](Contact& c) { c.servo_stiffness *= 1.01; }) > 1e-6);
    CHECK(distance([](Contact& c) { c.servo_damping *= 1.1; }) > 1e-6);
    CHECK(distance([](Contact& c) { c.inertia *= 1.001; }) > 1e-6);
  }
}

TEST_CASE("a hand that is braked before the gap opens is pushed again by two codes") {
  for (const std::uint64_t seed : {21, 22, 23}) {
    PushedHand pushed(seed);
    // The damping takes the force away while the spring is still pressed, and the joints are braked
    // faster than the spring opens.
    pushed.plant.contact.damping = 2000;
    pushed.at.controller.K_phi = pushed.at.law.K_phi = 40;
    pushed.at.options.horizon = 2;
    const EncounterResult run = pushed.simulated();
    REQUIRE(run.simulation.status == SimulationStatus::Finished);
    INFO("seed " << seed);
    CHECK(run.contact.contacts == 1);
    CHECK(pushed.distance(run, [](reference::SpringContact&) {}) < 1e-7);
  }
}

TEST_CASE("the damping that leaves a restitution is the same by closed form and by integration") {
  for (const double e : {0.001, 0.05, 0.3, 0.7, 0.99, 1.0}) {
    const double closed = contact_damping(e, 1e5, 12);
    INFO("restitution " << e);
    CHECK(reference::damping_for(e, 1e5, 12) == Approx(closed).epsilon(1e-9).margin(1e-6));
  }
}

TEST_CASE("joints at rest start where they are pushed beyond friction, and not into a stop") {
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(8, 8);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(8);
  load.tail(2) << 3, -1;
  const auto directions = [&](std::vector<reference::RestingJoint> joints) {
    return reference::starting_directions(H, load, joints);
  };
  CHECK(directions({{0, 2.5}, {1, 0.5}}) == std::vector<int>{1, -1});
  CHECK(directions({{0, 3}, {1, 1}}) == std::vector<int>{0, 0});
  CHECK(directions({{0, 2, -kInfinity, 0}, {1, 0.5, -kInfinity, 0}}) == std::vector<int>{0, -1});
  // The second one alone would stay: the first one pulls it along.
  H(6, 7) = H(7, 6) = 0.9;
  load(7) = -0.5;
  CHECK(directions({{1, 0.6}}) == std::vector<int>{-1});
  CHECK(directions({{0, 0}, {1, 0.6}}) == std::vector<int>{1, -1});
}
