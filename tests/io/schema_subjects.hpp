// Every format that has a strict reader, with documents that between them use every key.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/state_file.hpp>
#include <stillbase/io/target_file.hpp>

#include "io/plan_samples.hpp"
#include "io/problem_reader.hpp"
#include "io/schema_support.hpp"
#include "support/temporary_folder.hpp"

namespace stillbase::io_test {

/// A format with its reader and documents that between them use every key.
struct Subject {
  std::string name;
  std::function<void(const std::string& text)> read;
  std::vector<json> documents;

  std::vector<Finding> findings(const json& document) const {
    try {
      read(document.dump());
    } catch (const InputError& error) {
      return error.findings();
    } catch (const FileError& error) {
      return {{"", 0, "no-file", error.what()}};
    }
    return {};
  }
};

inline void read_problem_here(const std::string& text) {
  io::ReadContext context{source_path("problems/x.yaml"), {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::read_problem_map(root, context, "", {.folder = source_path("problems")});
  context.throw_if_any();
}

constexpr const char* kPlanar = R"(
format: stillbase.problem
version: 1
name: planar
purpose: Alternatives that the shipped files do not use.
robot: {file: robots/planar_two_link_a.urdf, start: {joint_1: 10 deg, joint_2: 0}}
target: {file: targets/point_mass_100.yaml}
impact:
  source: point_mass
  direction: {angle: 170 deg}
  closing_speed: 1
  joint_resistance: {model: locked, locked: [joint_1]}
variables:
  joints: [joint_2]
  base_attitude: {freedom: axis, axis: [0, 0, 2], max: 10 deg}
  base_position: {freedom: box, lower: [0, 0, 0], upper: [1 m, 1, 0]}
  contact_time: 2 min
objective: {terms: [{quantity: base_momentum, size: 1 N s, length: 2 m}, {quantity: joint_rate_norm, size: 1}], measure: cvar}
hand: {constraint: position, position: [1, 0, 0]}
constraints: {joint_rate_max: {joint_1: 1, joint_2: 1 rad/s}, clearance: 1 mm}
uncertainty: {cone_half_angle: 5 deg, cone_plane: xy, joint_position: {joint_1: 1 deg, joint_2: 0}}
obstacles:
  - {name: a, orientation: {rpy: [0, 0, 90 deg]}, geometry: {capsule: {radius: 1 m, length: 1}}, position: [0, 50, 0]}
  - {name: b, orientation: {axis: [0, 0, 1], angle: 1}, geometry: {cylinder: {radius: 1, length: 1}}, position: [9, 50, 0]}
  - name: c
    position: [0, 0, 99]
    geometry:
      convex_mesh:
        vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
)";

constexpr const char* kTumbling = R"(
format: stillbase.problem
version: 1
purpose: A target with an uncertain estimate.
robot: {file: robots/planar_two_link_a.urdf, start: [0, 0], allowed_contacts: [[base, link_2]]}
target:
  name: client
  model: rigid_body
  mass: 50 kg
  inertia: {ixx: 3, iyy: 3 kg m^2, izz: 3}
  shapes: [{geometry: {box: {size: [1, 1, 1]}}}]
  features: [{name: a, point: [1, 0, 0], normal: [1, 0, 0]}, {name: b, point: [0, 1, 0], normal: [0, 1, 0]}]
  state:
    linear_velocity: [-1, 0, 0]
    angular_velocity: {axis: [0, 0, 1], rate: 1 deg/s}
    covariance: {position: 1 mm, orientation: [0.1, 0.1, 0.1], linear_velocity: 0, angular_velocity: 0, mass: 0.1, moments: 0.1}
impact:
  source: rigid_body
  joint_resistance: free
variables:
  base_attitude: {freedom: cone, axis: [0, 0, 1], max: 0.1}
  feature: a
objective: {quantity: attitude_turned, after: 5 s}
hand: {constraint: position}
constraints: {joint_rate_scale: 0.5}
uncertainty: {cone_half_angle: from_covariance, confidence: 0.9}
post_impact: {controllers: [none], residual_base_rate_max: 1, attitude_change_max: 1}
)";

/// @param between the target's section and the objective
inline std::string latch_text(const std::string& between) {
  return R"(
format: stillbase.problem
version: 1
purpose: A target that is latched.
robot: {file: robots/deos.urdf, hand: hand, start: [80 deg, 100 deg, -20 deg, -80 deg, 0, 115 deg, 0]}
target:
  file: targets/client_224.yaml
  state: {linear_velocity: [-0.015, 0, 0], covariance: {orientation: 0.1}}
impact: {source: rigid_body, contact: latch, joint_resistance: free}
variables:
  base_attitude: {freedom: free}
  contact_time: {lower: 55 s, upper: 65 s}
  feature: upper_edge
objective: base_angular_momentum
hand: {constraint: axis}
)" + between;
}
const std::string kMatched = latch_text(R"(
contact: {hand_velocity: {linear: [0, 1 mm/s, 0], angular: [0, 0, 0]}, arrival_rates: least_base_rate}
approach: {base: floating, station_free: true, abort: false, wait: 10 s}
post_impact:
  controllers: [rns_damped]
  wheels: {torque: [0.1, 0.1, 0.2], capacity: 4}
  grip: {force: 10, moment: 10}
  residual_base_rate_max: 1
  attitude_change_max: 1
)");
const std::string kResidual = latch_text(R"(
uncertainty: {residual_velocity: from_covariance, residual_deviations: 2, hand_tracking: {linear: 1 mm/s, angular: 0}}
post_impact:
  controllers: [rns_damped]
  wheels: {torque: 0.1, capacity: 4, preset: [0.1, 0, 0]}
  residual_base_rate_max: 1
  attitude_change_max: 1
)");

const std::string kStatedResidual = latch_text(R"(
uncertainty:
  residual_frame: inertial
  residual_velocity:
    - [1e-6, 0, 0, 0, 0, 0]
    - [0, 1e-6, 0, 0, 0, 0]
    - [0, 0, 1e-6, 0, 0, 0]
    - [0, 0, 0, 1e-8, 0, 0]
    - [0, 0, 0, 0, 1e-8, 0]
    - [0, 0, 0, 0, 0, 1e-8]
)");

constexpr const char* kParts = R"(
format: stillbase.problem
version: 1
purpose: A robot put together from parts.
robot:
  base:
    mass: 200
    inertia: {ixx: 30, iyy: 30, izz: 30}
    shape: {box: {size: [1, 1, 1]}}
    shapes: [{position: [0, 1, 0], geometry: {sphere: {radius: 0.1}}}]
    position: [0, 0, 1]
  arms:
    - file: arms/seven_joint_arm.urdf
      prefix: r_
      mount: {position: [0, 0, 0.5]}
      hand: grasp
      hand_frame: {position: [0, 0, 0.1]}
  package_path: [arms]
  collision: decompose
  locked: {finger_1: 0.02}
  limits: {joint_4: {rate: 0.1, torque: 12}}
  rotors: {joint_4: {inertia: 1e-4, gear_ratio: 100}}
  start: [0, 0, 0, -1, 0, 1, 0]
impact: {source: given, direction: [0, 0, -1]}
objective: base_angular_velocity
)";

inline Subject problem_subject() {
  Subject subject{"problem",
                  read_problem_here,
                  {yaml(kPlanar), yaml(kTumbling), yaml(kMatched), yaml(kResidual),
                   yaml(kStatedResidual), yaml(kParts)}};
  for (const char* name :
       {"planar_two_link_c2_a", "planar_two_link_post_impact_a", "iiwa_cone", "deos_features"}) {
    const std::string path = source_path(std::string("problems/") + name + ".yaml");
    json stated = yaml(file_text(path));
    subject.documents.push_back(stated);
    // The copy that plans hold states every field.
    subject.documents.push_back(json::parse(problem_to_json(read_problem(path))));
  }
  CaptureProblem servo = read_problem(source_path("problems/spart_3dof_point.yaml"));
  servo.resistance = {};
  servo.resistance.model = ResistanceModel::Servo;
  servo.resistance.stiffness = servo.resistance.damping = JointVectord::Ones(servo.robot.n());
  servo.resistance.contact_duration = 1;
  subject.documents.push_back(json::parse(problem_to_json(servo)));
  return subject;
}

inline Subject plan_subject() {
  Subject subject{"plan", [](const std::string& text) { read_plan(text, "plan.json"); }, {}};
  const std::vector<InputFile> inputs{{"problem", "a.yaml", sha256_hex("")}};
  const auto add = [&](const Plan& plan) {
    subject.documents.push_back(
        json::parse(plan_to_json(plan, {{"stillbase", "0.1.0"}}, "", inputs)));
  };
  add(random_plan());
  Plan locked = random_plan();
  locked.problem.resistance = locked.impact.resistance = {};
  locked.problem.resistance.model = locked.impact.resistance.model = ResistanceModel::Locked;
  locked.problem.resistance.locked = locked.impact.resistance.locked = {true, false};
  locked.problem.objective.clear();
  for (const auto& [word, quantity] : io::objective_names()) {
    const bool turns = quantity == ObjectiveQuantity::AttitudeTurned;
    locked.problem.objective.push_back({quantity, 2, 3, turns ? 1.0 : 0.0});
    locked.objective.terms[std::string(word)] = 1;
  }
  locked.problem.variables.base_attitude = AttitudeFreedom::Axis;
  for (auto* boxes : {&locked.certificate.proof.solutions, &locked.certificate.proof.undecided}) {
    for (JointBox& box : *boxes) box.base_angle = Ends{-0.1, 0.1};
  }
  locked.warnings = {{"narrow-cone", "the cone is narrow"}};
  MotionBefore& before = locked.impact.before.emplace();
  before.phidot = JointVectord::Constant(2, 0.1);
  ResidualSummary& residual = locked.objective.residual.emplace();
  residual.covariance.setIdentity();
  residual.deviations = 3;
  AbortPath& abort = locked.approach.abort.emplace();
  abort.times = {1, 2};
  abort.joint_positions = abort.joint_velocities = {JointVectord::Zero(2), JointVectord::Zero(2)};
  abort.base_poses.resize(2);
  locked.problem.robot.remarks = {{"robots/r.urdf", 3, "not-used", "<gazebo>: for a simulator"}};
  add(locked);
  Plan choice = random_plan("problems/deos_features.yaml");
  choice.problem.resistance = choice.impact.resistance =
      read_problem(source_path("problems/deos_features.yaml")).resistance;
  choice.configuration.feature = choice.nominal_optimum->configuration.feature = "lower_edge";
  for (auto* boxes : {&choice.certificate.proof.solutions, &choice.certificate.proof.undecided}) {
    for (JointBox& box : *boxes) box.contact_time = Ends{59, 60};
  }
  for (Candidate& candidate : choice.candidates) {
    candidate.configuration.feature = "upper_edge";
    candidate.turns = {{"joint_1", -1, 0}};
  }
  for (SolutionFamily& family : choice.families) {
    for (Configuration& point : family.points) point.feature = "upper_edge";
  }
  add(choice);
  return subject;
}

inline Subject suite_subject() {
  json suite = yaml(file_text(source_path("bench/suite.yaml")));
  suite["families"].erase(1);
  for (json& family : suite["families"]) {
    family["problem"] = source_path("bench/" + family["problem"].get<std::string>());
    family["free_attitude"] = "10 deg";
    family["free_contact_time"] = 1;
    family["cone_half_angle"] = "10 deg";
    family["case"] = "C2";
  }
  while (suite["families"].size() > 1) suite["families"].erase(1);
  const auto read = [](const std::string& text) {
    read_suite(TemporaryFolder().write("suite.yaml", text));
  };
  return {"suite", read, {suite}};
}

inline std::vector<Subject> subjects() {
  const RobotModel robot = read_problem(source_path("problems/planar_two_link_c2_a.yaml")).robot;
  std::vector<Subject> all{problem_subject(), plan_subject(), suite_subject()};
  all.push_back({"target",
                 [](const std::string& text) { read_target_text(text, "target.yaml"); },
                 {yaml(file_text(source_path("problems/targets/client_50.yaml"))),
                  yaml(file_text(source_path("problems/targets/point_mass_100.yaml")))}});
  all.push_back({"campaign",
                 [](const std::string& text) { read_campaign_spec(text, "campaign.yaml"); },
                 {{{"format", "stillbase.campaign"},
                   {"version", 1},
                   {"plans", {"a.json"}},
                   {"problems", {"a.yaml"}},
                   {"seeds", {1, 2}},
                   {"trials", 7},
                   {"trials_per_case", 2}}}});
  all.push_back({"state",
                 [robot](const std::string& text) { read_state(text, "state.json", robot); },
                 {yaml("joint_positions: {joint_1: 10 deg, joint_2: 1}\n"
                       "joint_velocities: [1, 1 rad/s]"),
                  yaml("joint_positions: [10 deg, 1]\njoint_velocities: {joint_1: 1, joint_2: 2}\n"
                       "base_velocity: {linear: [1, 2, 3], angular: [1, 2, 3]}\n"
                       "impulse: {force: [1, 2, 3], moment: [1, 2, 3 N m s]}")}});
  return all;
}

}  // namespace stillbase::io_test
