#include "app/problem_draft.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/robot/assembled_robot.hpp>

#include "app/draft_encounter.hpp"
#include "app/draft_robot.hpp"
#include "app/draft_words.hpp"
#include "app/tool.hpp"
#include "app/words.hpp"
#include "robot/assembly.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

// m/s, that of berthing. Of faster targets the arm takes more momentum and runs into its stops.
constexpr double kClosingSpeed = 0.03;
constexpr double kRestitution = 0.1;
constexpr double kWait = 2;  // s, of the approach
/// With fewer the motion that keeps the base still leaves the joints little to move in.
constexpr int kJointsToHoldBase = 6;
constexpr double kLeastLift = 0.1;  // m, of an arm that lies on the base

constexpr double kDistance = 1.5;  // m, of the target at the start

/// Part of the joints' rate limits that the hand moves with at 0.3 rad/s or m/s.
double velocity_scale(const RobotModel& robot) {
  double fastest = 0;
  for (const Joint& joint : robot.joints) {
    if (std::isfinite(joint.max_velocity)) fastest = std::max(fastest, joint.max_velocity);
  }
  return fastest > 0 ? std::clamp(0.3 / fastest, 1e-3, 1.0) : 1.0;
}

/// Of the slowest joint through most of its range, s.
double longest_motion(const RobotModel& robot) {
  double longest = 0;
  for (const Joint& joint : robot.joints) {
    const double rate = joint.max_velocity * velocity_scale(robot);
    const double range = joint.upper - joint.lower;
    const double travel = joint.is_prismatic() ? range : std::min(range, 2 * kPi);
    if (std::isfinite(travel) && rate > 0) longest = std::max(longest, 1.1 * travel / rate);
  }
  return longest;
}

/// Distance from which the target takes as long as that, m.
double distance_for_motion(const RobotModel& robot) {
  constexpr double kReserve = 10;  // s, for the acceleration, the wait and the window
  return kClosingSpeed * (longest_motion(robot) + kReserve);
}

double draft_distance(const RobotModel& robot) {
  const double distance = distance_for_motion(robot);
  return distance > kDistance ? rounded_to(distance, 0.5) : kDistance;
}

/// How the target comes, in B at the start, which is N.
struct DraftMotion {
  Vector3d spin_axis;  ///< not a unit vector, as it is stated
  Vector3d omega, velocity;
};

/// The rotation is about the axis (1, 2, 2), the other way round where its face recedes so.
DraftMotion draft_motion(const DraftEncounter& encounter, const TargetBody& target, double spin) {
  DraftMotion motion;
  motion.velocity = -kClosingSpeed * encounter.direction;
  motion.spin_axis = Vector3d(1, 2, 2);
  const Vector3d point = encounter.target.orientation * target.features.front().point;
  const auto closing_speed = [&] {
    motion.omega = spin / kDegrees * motion.spin_axis / 3;
    return -encounter.direction.dot(motion.velocity + motion.omega.cross(point));
  };
  if (closing_speed() < kClosingSpeed / 2) {
    motion.spin_axis = -motion.spin_axis;
    closing_speed();
  }
  return motion;
}

/// Whether the target comes over the arm at the start while that moves, or over the place of the
/// contact while the hand waits there.
bool sweeps_over_arm(const RobotModel& robot, const DraftEncounter& encounter,
                     const TargetBody& target, const DraftMotion& motion) {
  const auto pose_before = [&](double time) {
    return Pose{encounter.target.position - time * motion.velocity,
                rotation_exp(-time * motion.omega) * encounter.target.orientation};
  };
  const double half = std::get<Box>(target.shapes.front().geometry).size.x() / 2;
  const Vector3d place = encounter.target * target.features.front().point;
  SceneParts parts;
  parts.target = target;
  parts.allowed_contacts = encounter.allowed_contacts;
  const CollisionScene scene = CollisionScene(robot, parts).target_pairs_only();
  const auto start = compute_kinematics<double>(robot, encounter.start);
  constexpr double kStep = 0.05;  // s
  const auto steps = static_cast<int>((kWait + longest_motion(robot)) / kStep);
  for (int k = 1; k <= steps; ++k) {
    const double time = k * kStep;
    const Pose then = pose_before(time);
    const bool is_over = time <= kWait ? (then.inverse() * place).cwiseAbs().maxCoeff() < half
                                       : scene.first_hit(start, Pose{}, &then).has_value();
    if (is_over) return true;
  }
  return false;
}

/// What speaks against a plan for this problem, by what takes no search.
std::vector<std::string> doubts_of(const RobotModel& robot, const DraftEncounter& encounter,
                                   const TargetBody& target, const DraftMotion& motion,
                                   double distance) {
  std::vector<std::string> doubts;
  if (sweeps_over_arm(robot, encounter, target, motion)) {
    doubts.emplace_back(
        "the target turns so fast that it sweeps over the arm before the contact: `plan` may find "
        "no approach; name a smaller --spin or --target-mass");
  }
  if (const double needed = distance_for_motion(robot); distance < needed) {
    doubts.push_back(fmt::format(
        "the contact is after {:.3g} s, the robot waits for {:g} s of them, and its slowest joint "
        "takes up to {:.3g} s: `plan` may find no approach in time; a --distance of {:.3g} m "
        "leaves enough",
        distance / kClosingSpeed, kWait, longest_motion(robot), rounded_to(needed + 0.05, 0.1)));
  }
  return doubts;
}

/// Gain of damped joints at which a push at the hand takes at most half of every torque limit,
/// 1/s: the torque is at most the gain times the push times the arm that it has about the joint.
/// @param push N s
double damping_gain(const RobotModel& robot, double push) {
  double gain = PostImpactSpec{}.K_phi;
  double arm = robot.p_hand.norm();  // of the hand about the last joint, at most
  for (int k = robot.n() - 1; k >= 0; --k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const double load = push * (joint.is_prismatic() ? 1 : arm);
    if (std::isfinite(joint.max_effort)) gain = std::min(gain, 0.5 * joint.max_effort / load);
    arm += joint.p.norm() + (joint.is_prismatic() ? std::max(-joint.lower, joint.upper) : 0);
  }
  return gain;
}

/// A box with one feature on its +x face, off the middle.
TargetBody box_target(double mass) {
  TargetBody target;
  const double edge = rounded_to(std::cbrt(mass / kDensity), 0.05);
  target.name = "client";
  target.mass = mass;
  target.inertia = homogeneous_inertia(mass, Box{Vector3d::Constant(edge)});
  target.shapes.push_back({Pose{}, Box{Vector3d::Constant(edge)}});
  target.features.push_back(
      {"face", Vector3d(edge / 2, rounded_to(edge / 8, 0.01), 0), Vector3d::UnitX()});
  return target;
}

std::string joint_value(const Joint& joint, double value) {
  return joint.is_prismatic() ? fmt::format("{:.4f} m", value)
                              : fmt::format("{:.2f} deg", value * kDegrees);
}

/// The robot with its mount, and where its hand touches the target.
struct DraftScene {
  DraftRobot robot;
  TargetBody target;
  DraftEncounter encounter;
};

[[noreturn]] void refuse_arm(const DraftRobot& robot, const DraftObstruction& obstruction) {
  std::string missing =
      "in each the target touches the arm or the base; name a smaller "
      "--target-mass or another --hand";
  if (!obstruction.links_are_free) {
    missing =
        "in all 4000 that were tried links touch each other; `stillbase check "
        "--suggest-contacts` names the pairs that always do, whose shapes are too large";
  } else if (!obstruction.points_outwards) {
    missing = "the hand always points at the base; name another --hand";
  }
  throw CommandLineError(
      fmt::format("no posture was found in which the hand {} reaches the target's face without a "
                  "collision: {}{}, or write the problem by hand",
                  robot.hand, missing, robot.is_put_together ? ", a smaller --base-size" : ""));
}

/// The arm stands on the base; where its hand never points away from the base it lies; where that
/// does not help it stands and the hand points anywhere. A robot with a base of its own has no
/// frame for its hand but its links: where none is free the tip of a finger is the hand, and in the
/// end the robot stands on a base as an arm does.
/// @throws InputError, AssemblyError, CommandLineError
DraftScene draft_scene(const DraftRequest& request) {
  DraftRobot standing = draft_robot(request, {});
  const double mass = request.target_mass > 0 ? request.target_mass
                                              : rounded_mass(0.1 * standing.model.total_mass());
  const TargetBody target = box_target(mass);
  DraftObstruction obstruction;
  const auto find = [&](DraftRobot& robot, double outwards) {
    return find_encounter(robot.model, target, robot.is_put_together, outwards, obstruction);
  };
  if (auto found = find(standing, kOutwards)) return {std::move(standing), target, *found};
  if (standing.is_put_together) {
    DraftMount mount;
    mount.is_lying = true;
    const Vector3d foot = DraftMount{}.pose(standing.base_size).position +
                          find_link(standing.model, kBaseLink)->pose.position;
    // Its -x side faces the base then.
    mount.lift =
        std::max(kLeastLift, reach_of_base(standing.model, kBaseLink, foot, -Vector3d::UnitX()));
    DraftRobot lying = draft_robot(request, mount);
    if (auto found = find(lying, kOutwards)) return {std::move(lying), target, *found};
  }
  if (auto found = find(standing, kAnyDirection)) return {std::move(standing), target, *found};
  for (std::size_t i = 0; !standing.is_put_together && i < standing.tips.size(); ++i) {
    DraftRobot on_tip = draft_robot(request, {}, standing.tips[i]);
    if (auto found = find(on_tip, kOutwards)) return {std::move(on_tip), target, *found};
  }
  if (!standing.is_put_together) {
    DraftRequest on_base = request;
    on_base.base_mass = rounded_mass(10 * standing.model.total_mass());
    DraftScene scene = draft_scene(on_base);
    scene.robot.notes.push_back(
        "the file's own base stands on it: no link of the hand ends where its shapes do");
    return scene;
  }
  refuse_arm(standing, obstruction);
}

}  // namespace

Draft draft_problem(const DraftRequest& request) {
  DraftScene scene;
  try {
    scene = draft_scene(request);
  } catch (const AssemblyError& error) {
    throw InputError({{request.robot, 0, error.rule(), error.what()}});
  }
  const DraftRobot& draft_of = scene.robot;
  const RobotModel& robot = draft_of.model;
  const TargetBody& target = scene.target;
  const DraftEncounter* const encounter = &scene.encounter;
  const double target_mass = target.mass;
  Draft draft;
  draft.notes = draft_of.notes;
  std::string robot_lines = draft_of.base_lines;
  if (draft_of.is_put_together) {
    if (encounter->standoff > 0) {
      const Vector3d place = encounter->standoff * encounter->axis;
      robot_lines += fmt::format(", hand_frame: {{position: {}}}", vector_text(place));
      draft.notes.push_back(
          fmt::format("the hand's frame is {:.3g} m beyond {}, where the shapes of its body end{}",
                      encounter->standoff, draft_of.hand,
                      encounter->is_further ? ", and further: nearer no posture is free" : ""));
    }
    robot_lines += "}\n";
  }
  robot_lines += draft_of.joint_lines;

  std::string start, resistance;
  double shortest_slide = kInfinity;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const char* const comma = k > 0 ? ", " : "";
    start += comma + yaml_word(joint.name) + ": " + joint_value(joint, encounter->start[k]);
    // Rotor inertia times gear ratio squared: published values of harmonic drives lie near this.
    const double effort = std::isfinite(joint.max_effort) ? joint.max_effort : 50;
    // A drive that the robot file states is part of the robot.
    resistance += fmt::format("{}{}: {:.3g}", comma, yaml_word(joint.name),
                              joint.rotor_inertia > 0 ? 0 : std::clamp(0.01 * effort, 0.02, 5.0));
    if (joint.is_prismatic()) shortest_slide = std::min(shortest_slide, joint.upper - joint.lower);
  }
  // At a stop the impact would drive the joint into it.
  const std::string margin = std::isfinite(shortest_slide)
                                 ? fmt::format("{:.2g}  # rad, and m of joints that slide",
                                               std::min(0.02, 0.05 * shortest_slide))
                                 : "2 deg";
  std::string contacts;
  for (const auto& [a, b] : encounter->allowed_contacts) {
    contacts += fmt::format("{}[{}, {}]", contacts.empty() ? "" : ", ", yaml_word(a), yaml_word(b));
  }
  const std::string often =
      encounter->contact_share == 1
          ? "every posture"
          : fmt::format("at least {:g} % of all postures", 100 * encounter->contact_share);
  if (encounter->contact_share < 1) {
    draft.notes.push_back(fmt::format(
        "allowed contacts: links closer than {:g} m in {}; their shapes are larger than they are",
        2 * kDraftClearance, often));
  }
  const bool has_meshes =
      std::any_of(robot.shapes.begin(), robot.shapes.end(), [](const CollisionShape& shape) {
        return std::holds_alternative<ConvexMesh>(shape.geometry);
      });
  const double distance = request.distance > 0 ? request.distance : draft_distance(robot);
  const double contact_time = distance / kClosingSpeed;
  const double half_window = std::min({5.0, 10 / request.spin, contact_time / 4});
  const DraftMotion motion = draft_motion(*encounter, target, request.spin);
  const Eigen::Quaterniond q =
      rotation_exp(-motion.omega * contact_time) * encounter->target.orientation;
  const Vector3d position = encounter->target.position - motion.velocity * contact_time;
  const double edge = std::get<Box>(target.shapes.front().geometry).size.x();

  draft.notes.push_back(
      fmt::format("target: a cube of {:.6g} kg, {:.3g} m, rotating at {:.3g} deg/s, contact after "
                  "about {:.3g} s",
                  target_mass, edge, request.spin, contact_time));
  draft.notes.push_back(
      "limits after the impact: base rate 1 deg/s, attitude change 20 deg within 10 s");
  draft.doubts = doubts_of(robot, *encounter, target, motion, distance);
  std::string controller_lines = "  controllers: [rns_damped, joint_damping, none]\n";
  if (robot.n() < kJointsToHoldBase) {
    controller_lines =
        "  # With few joints the arm runs into its stops where it moves to keep the base still.\n"
        "  controllers: [joint_damping, rns_damped, none]\n";
    const double push = (1 + kRestitution) * target_mass * kClosingSpeed;
    const double gain = damping_gain(robot, push);
    if (gain < PostImpactSpec{}.K_phi) {
      controller_lines += fmt::format(
          "  # Half of the torque limits at most.\n  joint_rate_gain: {:.2g} 1/s\n", gain);
    }
  }
  draft.text = fmt::format(
      R"(# Written by `stillbase new` for {0}: every number below is a default to be replaced.
format: stillbase.problem
version: 1
purpose: Capture a free client with the arm of {0}.
robot:
{1}  # Free of collision; from here the hand moves forwards along a free line.
  start: {{{2}}}
{3}target:
  name: client
  model: rigid_body
  mass: {4:.6g} kg
  inertia: {{ixx: {5:.6g}, iyy: {5:.6g}, izz: {5:.6g}}}
  shapes:
    - geometry: {{box: {{size: [{6:.6g}, {6:.6g}, {6:.6g}]}}}}
  features:
    - {{name: face, point: {7}, normal: [1, 0, 0]}}
  # Comes from {8:.4g} m away at {9:g} m/s; its face looks at the hand in the middle of the window.
  state:
    position: {10}
    orientation: {11}
    linear_velocity: {12}
    angular_velocity: {{axis: {24}, rate: {13:g} deg/s}}
impact:
  source: rigid_body
  restitution: {22:g}
  # Gears stand between rotor and link. A hundredth of the torque limit (kg m^2) is the size of rotor
  # inertia times gear ratio squared of harmonic drives; take the maker's numbers.
  joint_resistance: {{model: rotor_inertia, rotor_inertia: {{{14}}}}}
variables:
  joints: all
  base_position: free
  contact_time: {{lower: {15:.4g} s, upper: {16:.4g} s}}
objective: {{quantity: base_angular_momentum, measure: worst_case}}
hand:
  constraint: axis
  approach_axis: {17}
constraints:
{18}  closing_speed_min: 0.01 m/s
  clearance: {20:g} m
uncertainty:
  cone_half_angle: 5 deg
# Many solutions of the search touch something, or drive a joint into its stop after the impact.
search: {{max_candidates: {23}}}
approach:
  base: floating
  max_approaches: 16
  acceleration_limit: 0.2
  velocity_scale: {19:.3g}
  wait: {25:g} s
  clearance: {20:g} m
post_impact:
{21}  horizon: 10 s
  residual_base_rate_max: 1 deg/s
  attitude_change_max: 20 deg
)",
      fs::path(request.robot).filename().string(), robot_lines, start,
      contacts.empty() ? ""
                       : fmt::format("  # These are closer than {:g} m in {}.\n"
                                     "  allowed_contacts: [{}]\n",
                                     2 * kDraftClearance, often, contacts),
      target_mass, target.inertia(0, 0), edge, vector_text(target.features.front().point), distance,
      kClosingSpeed, vector_text(position), quaternion_text(q), vector_text(motion.velocity),
      request.spin, resistance, contact_time - half_window, contact_time + half_window,
      vector_text(encounter->axis), fmt::format("  joint_limit_margin: {}\n", margin),
      velocity_scale(robot), kDraftClearance, controller_lines, kRestitution, has_meshes ? 128 : 64,
      vector_text(motion.spin_axis), kWait);
  return draft;
}

}  // namespace stillbase::app
