// The smallest distance along an approach is proven between the samples.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/kinematics.hpp>

#include "verification/clearance.hpp"
#include "verification/example_plans.hpp"
#include "verification/moving_shapes.hpp"

using namespace stillbase;
using namespace stillbase::verification;
using namespace stillbase::verification_test;

namespace {

std::vector<BaseTrack> tracks_of(const Plan& plan) {
  std::vector<BaseTrack> tracks;
  for (std::size_t i = 0; i + 1 < plan.approach.times.size(); ++i) {
    const HermiteSegment segment(plan.approach, i);
    if (plan.problem.approach.base == BaseMode::Held) {
      tracks.emplace_back(segment, plan.approach.base_poses[i]);
    } else {
      tracks.emplace_back(plan.problem.robot, segment, plan.approach.base_poses[i], 0.005);
    }
  }
  return tracks;
}

PathClearance clearance_of(const Plan& plan, const VerifyOptions& options = {}) {
  const Situation situation(plan.problem, plan.configuration, plan.approach.times.front());
  return path_clearance({plan, options, situation, situation.problem}, tracks_of(plan));
}

const Claim& claim_of(const Verification& verification, const std::string& name) {
  for (const Claim& claim : verification.claims) {
    if (claim.name == name) return claim;
  }
  FAIL("no claim " << name);
  std::abort();
}

/// A ball of 4 mm at the hand of an arm on a held base, samples far apart, and a post of 5 mm
/// across the hand's way in the middle of the segment in which the joints move furthest.
Plan post_plan() {
  Plan plan = arm_plan(Flip::None, BaseMode::Held);
  CaptureProblem& problem = plan.problem;
  Approach& approach = plan.approach;
  const auto thin_out = [](auto& values) {
    for (std::size_t i = 0; 10 * i < values.size(); ++i) values[i] = values[10 * i];
    values.resize((values.size() + 9) / 10);
  };
  thin_out(approach.times), thin_out(approach.base_poses), thin_out(approach.base_velocities);
  thin_out(approach.joint_positions), thin_out(approach.joint_velocities);
  thin_out(approach.joint_accelerations), thin_out(approach.joint_torques);

  RobotModel& robot = problem.robot;
  robot.shapes = {{robot.hand_body, "ball", {robot.p_hand, {}}, Sphere{0.002}}};
  robot.shapes[0].pose.orientation = Eigen::Quaterniond::Identity();
  const HermiteSegment segment(approach, approach.times.size() / 2 - 1);
  const auto hand_at = [&](double s) {
    const auto d = reference::compute(robot, {segment.position(s), {}, {}});
    return Vector3d(approach.base_poses[0] * Vector3d(d.hand_position));
  };
  const double h = segment.duration();
  const Vector3d way = hand_at(0.51 * h) - hand_at(0.49 * h);
  Obstacle post;
  post.name = "post";
  post.pose.position = hand_at(h / 2);
  post.pose.orientation = rotation_between(Vector3d::UnitZ(), way.unitOrthogonal());
  post.geometry = Capsule{0.0025, 0.4};
  problem.obstacles = {post};
  problem.approach.resolution = 0.2;
  problem.approach.clearance = 0.005;
  return plan;
}

}  // namespace

TEST_CASE("a post of 5 mm between the samples is found at any resolution of the plan") {
  Plan plan = post_plan();
  for (const double resolution : {0.02, 0.2, 2.0}) {
    plan.problem.approach.resolution = resolution;
    const PathClearance found = clearance_of(plan);
    REQUIRE(found.complete);
    CHECK(found.least.found < 0);
    CHECK(found.least.proven <= found.least.found);
    CHECK(found.least.pair == "ball with post");
  }
  // At the plan's own steps nothing is near.
  CHECK(clearance_of(plan).distance_as_stated.value() > 0.01);
  plan.approach.min_clearance = clearance_of(plan).distance_as_stated.value();
  const Verification verification = judge_plan(plan, quick());
  CHECK(claim_of(verification, "approach_clearance").fails());

  // Beside the hand's way, the proof holds it against the clearance.
  auto& post = plan.problem.obstacles[0];
  const Vector3d aside =
      post.pose.orientation * Vector3d::UnitZ() * (0.2 + 0.0025 + 0.002 + 0.0125);
  post.pose.position += aside;
  const PathClearance passed = clearance_of(plan);
  REQUIRE(passed.complete);
  CHECK(passed.least.found == Approx(0.0125).epsilon(0).margin(5e-4));
  CHECK(passed.least.proven >= passed.least.found - 1.01e-4);
  CHECK(passed.least.proven > 0.005);
}

TEST_CASE("joints that race between two samples are refused, and soon") {
  for (const BaseMode mode : {BaseMode::Floating, BaseMode::Held}) {
    for (const double rate : {1e7, 1e300}) {
      Plan plan = arm_plan(Flip::None, mode);
      plan.approach.joint_velocities[40](2) = rate;
      const Verification verification = judge_plan(plan, quick());
      CHECK_FALSE(verification.pass);
      for (const Claim& claim : verification.claims) {
        if (claim.name == "approach_clearance") CHECK(claim.fails());
      }
    }
  }
}

TEST_CASE("shapes that overlap fail also where no clearance is demanded") {
  Plan plan = arm_plan();
  plan.problem.approach.clearance = 0;
  Obstacle box;  // its distance to the arm's capsules has no size where they overlap
  box.name = "box";
  const std::size_t middle = plan.approach.times.size() / 2;
  const auto d =
      reference::compute(plan.problem.robot, {plan.approach.joint_positions[middle], {}, {}});
  box.pose.position = plan.approach.base_poses[middle] * Vector3d(d.hand_position);
  box.geometry = Box{{0.05, 0.05, 0.05}};
  plan.problem.obstacles = {box};
  CHECK(claim_of(judge_plan(plan, quick()), "approach_clearance").fails());
}

TEST_CASE("the proven distance is below all of many samples and close to their smallest") {
  for (const BaseMode mode : {BaseMode::Floating, BaseMode::Held}) {
    const Plan plan = arm_plan(Flip::None, mode);
    const PathClearance found = clearance_of(plan);
    REQUIRE(found.complete);
    CHECK(found.difference_of_codes < 1e-5);
    const Situation situation(plan.problem, plan.configuration, plan.approach.times.front());
    const CollisionScene scene(situation.problem);
    const std::vector<BaseTrack> tracks = tracks_of(plan);
    double of_path = kInfinity, with_hand = kInfinity;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const HermiteSegment segment(plan.approach, i);
      for (int j = 0; j <= 10; ++j) {
        const double s = segment.duration() * j / 10;
        const auto kinematics =
            compute_kinematics<double>(plan.problem.robot, JointVectord(segment.position(s)));
        const Pose target = situation.target()->state(segment.begin() + s).pose;
        const Pose base = tracks[i].pose(s);
        of_path = std::min(of_path, scene.nearest(kinematics, base, &target, false)->distance);
        with_hand = std::min(with_hand, scene.nearest(kinematics, base, &target)->distance);
      }
    }
    CHECK(found.of_path.proven <= of_path + 1e-6);
    CHECK(found.of_path.found <= of_path + 1e-6 + 1e-4);
    CHECK(found.of_path.proven >= found.of_path.found - 1.01e-4);
    CHECK(found.of_path.found >= of_path - 1e-3);
    CHECK(found.least.proven <= with_hand + 1e-6);
    CHECK(found.least.proven >= found.least.found - 1.01e-4);
    CHECK(found.least.found >= with_hand - 1e-3);
  }
}

TEST_CASE("no distance of two shapes changes by more than the bound on their motion") {
  const Plan plan = arm_plan();
  CaptureProblem problem = plan.problem;
  Obstacle antenna, beacon;
  antenna.name = "antenna", beacon.name = "beacon";
  antenna.frame = Frame::Base, beacon.frame = Frame::Inertial;
  antenna.pose.position = {0.1, 0.2, 1.6}, beacon.pose.position = {1.5, -0.4, 1};
  antenna.geometry = Box{{0.05, 0.3, 0.02}}, beacon.geometry = Cylinder{0.1, 0.3};
  problem.obstacles = {antenna, beacon};
  const CollisionScene scene(problem);
  MovingShapes shapes(problem, scene);
  Random random(21);
  double tightest = 0;
  for (int trial = 0; trial < 60; ++trial) {
    PathTravel travel;
    travel.joints = Eigen::VectorXd(7);
    Eigen::VectorXd phi(7), other(7);
    const double size = trial % 3 == 0 ? 0.5 : 0.02;
    const double rest = trial % 2;
    for (int k = 0; k < 7; ++k) {
      phi(k) = random.uniform(-2, 2);
      travel.joints(k) = random.index(2) * random.uniform(0, size);
      other(k) = phi(k) + travel.joints(k) * (random.index(2) == 0 ? 1 : -1);
    }
    travel.base = {rest * 0.1 * size, rest * 0.3 * size};
    travel.target_translation = rest * 0.2 * size;
    travel.target_rotation = rest * size;
    const auto moved = [&](const Pose& pose, double translation, double rotation) {
      return Pose{pose.position + translation * random.unit_vector(),
                  rotation_exp(rotation * random.unit_vector()) * pose.orientation};
    };
    const Pose base{{0.1, 0.2, -0.1}, rotation_exp(random.unit_vector())};
    const Pose target{base * Vector3d(1.5, 0.3, 1), rotation_exp(2 * random.unit_vector())};
    shapes.place(phi, base, &target);
    std::vector<double> before, bound;
    for (int pair = 0; pair < shapes.pair_count(); ++pair) {
      before.push_back(shapes.distance(pair, kInfinity).upper);
      bound.push_back(shapes.motion(pair, travel));
    }
    const double room = shapes.hand_room(), room_bound = shapes.hand_motion(travel);
    const Pose target_moved = moved(target, travel.target_translation, travel.target_rotation);
    shapes.place(other, moved(base, travel.base.translation, travel.base.rotation), &target_moved);
    CHECK(std::abs(shapes.hand_room() - room) <= room_bound + 1e-12);
    for (int pair = 0; pair < shapes.pair_count(); ++pair) {
      const double after = shapes.distance(pair, kInfinity).upper;
      if (before[pair] < 0 || after < 0) continue;
      const double change = std::abs(after - before[pair]);
      CHECK(change <= bound[pair] + 1e-9);
      if (bound[pair] > 0) tightest = std::max(tightest, change / bound[pair]);
    }
  }
  CHECK(tightest > 0.5);
}
