#include "app/problem_draft.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "app/draft_arm.hpp"
#include "app/draft_encounter.hpp"
#include "app/tool.hpp"
#include "app/words.hpp"
#include "robot/assembly.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

constexpr double kClosingSpeed = 0.05;  // m/s, that of berthing
constexpr double kDensity = 200;        // kg/m^3, of satellites

double rounded(double x, double step) { return std::max(step, std::round(x / step) * step); }

/// To two digits.
double rounded_mass(double x) { return rounded(x, std::pow(10, std::floor(std::log10(x)) - 1)); }

std::string list(const Vector3d& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
}

/// A name or path in YAML: in quotes where it would not be read as a text without.
std::string word(const std::string& text) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '.' || c == '-' || c >= 128;
  };
  const bool begins_well = !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) ||
                                             text[0] == '_' || text[0] == '/' || text[0] == '.');
  if (begins_well && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

/// A box with one feature on its +x face, off the middle.
TargetBody box_target(double mass) {
  TargetBody target;
  const double edge = rounded(std::cbrt(mass / kDensity), 0.05);
  target.name = "client";
  target.mass = mass;
  target.inertia = homogeneous_inertia(mass, Box{Vector3d::Constant(edge)});
  target.shapes.push_back({Pose{}, Box{Vector3d::Constant(edge)}});
  target.features.push_back(
      {"face", Vector3d(edge / 2, rounded(edge / 8, 0.01), 0), Vector3d::UnitX()});
  return target;
}

std::string joint_value(const Joint& joint, double value) {
  return joint.is_prismatic() ? fmt::format("{:.4f} m", value)
                              : fmt::format("{:.2f} deg", value * kDegrees);
}

/// The robot of a first problem and how the problem states it.
struct DraftRobot {
  RobotModel model;
  std::string base_lines;        ///< the file, or base and mount without the hand's frame
  std::string hand;              ///< link of the file
  std::string joint_lines;       ///< package_path, locked, limits
  bool is_put_together = false;  ///< from a base and the file
};

/// Locks what does not carry the hand and gives limits to what has none.
void choose_joints(const urdf::Tree& tree, const ArmTree& arm, RobotAssembly& assembly,
                   DraftRobot& robot, std::vector<std::string>& notes) {
  std::vector<std::string> carrying;
  for (const urdf::TreeJoint* joint : arm.way_to(robot.hand)) {
    if (!joint->is_fixed)
      carrying.push_back(joint->mimic ? joint->mimic->master : joint->joint.name);
  }
  std::string locked, stiff, limits;
  for (const urdf::TreeJoint& joint : tree.joints) {
    if (joint.is_fixed || joint.is_free || joint.mimic) continue;
    const std::string& name = joint.joint.name;
    const bool slides = joint.joint.is_prismatic();
    const bool carries = std::find(carrying.begin(), carrying.end(), name) != carrying.end();
    const double least_range = slides ? 0.01 : 10 / kDegrees;  // margins need a part of it
    if (!carries || joint.joint.upper - joint.joint.lower < least_range) {
      const double position = std::clamp(0.0, joint.joint.lower, joint.joint.upper);
      assembly.lock(name, position);
      (carries ? stiff : locked) += fmt::format("    {}: {:.17g}\n", word(name), position);
      continue;
    }
    JointLimits stated;
    std::string words;
    if (!(joint.joint.max_velocity > 0)) {
      stated.rate = slides ? 0.1 : 30 / kDegrees;
      words = slides ? "rate: 0.1 m/s" : "rate: 30 deg/s";
    }
    if (!(joint.joint.max_effort > 0)) {
      (slides ? stated.force : stated.torque) = slides ? 100 : 50;
      words +=
          (words.empty() ? "" : ", ") + std::string(slides ? "force: 100 N" : "torque: 50 N m");
    }
    if (!words.empty()) {
      assembly.limit(name, stated);
      limits += fmt::format("    {}: {{{}}}\n", word(name), words);
    }
  }
  if (!stiff.empty()) {
    notes.push_back("joints with nearly no range keep their position");
    locked += "    # These have nearly no range.\n" + stiff;
  }
  if (!locked.empty()) {
    robot.joint_lines += "  # Joints that do not carry the hand: rad or m.\n  locked:\n" + locked;
  }
  if (!limits.empty()) {
    robot.joint_lines += "  # The file gives none; these are guesses.\n  limits:\n" + limits;
    notes.push_back("limits of rate or torque that the file does not give are guesses");
  }
}

/// @throws InputError, AssemblyError, CommandLineError
DraftRobot draft_robot(const DraftRequest& request, std::vector<std::string>& notes) {
  urdf::MeshFolders folders{request.robot, request.package_path};
  for (std::string& folder : urdf::ros_package_path())
    folders.packages.push_back(std::move(folder));
  const std::string file_text = read_text_file(request.robot, kMaxUrdfBytes);
  const fs::path problem_folder = fs::absolute(request.problem).parent_path();
  const auto from_problem = [&](const std::string& path) {
    return fs::absolute(path).lexically_normal().lexically_proximate(problem_folder).string();
  };
  const std::string file = word(from_problem(request.robot));

  urdf::Findings findings(request.robot);
  const urdf::Tree tree = urdf::read_tree(file_text, findings);
  findings.raise();
  const ArmTree arm(tree);
  DraftRobot robot;
  robot.hand = request.hand.empty() ? arm.hand() : request.hand;
  if (!arm.has_link(robot.hand)) {
    throw CommandLineError(
        fmt::format("--hand {}: {} has no such link", robot.hand, request.robot));
  }
  if (request.hand.empty())
    notes.push_back("hand link: " + robot.hand + " (--hand chooses another)");

  const double moving = arm.mass() - arm.mass_on_root();
  robot.is_put_together = request.base_mass > 0 || arm.mass_on_root() < moving;
  RobotAssembly assembly;
  if (robot.is_put_together) {
    const double base_mass =
        request.base_mass > 0 ? request.base_mass : rounded_mass(std::max(50.0, 10 * arm.mass()));
    const Vector3d base_size =
        request.base_size.minCoeff() > 0
            ? request.base_size
            : Vector3d(Vector3d::Constant(rounded(std::cbrt(base_mass / kDensity), 0.05)));
    BaseBody base;
    base.mass = base_mass;
    base.inertia = homogeneous_inertia(base_mass, Box{base_size});
    base.shapes.emplace_back(Pose{}, Box{base_size});
    MountedArm mounted;
    mounted.hand = robot.hand;
    mounted.hand_frame = Pose{};
    mounted.mount.position.z() = base_size.z() / 2;
    if (arm.has_link(kBaseLink)) mounted.prefix = "arm_";
    assembly.add_base("draft", base);
    assembly.add_arm(file_text, folders, mounted);
    robot.base_lines = fmt::format(
        "  # A homogeneous box; the arm stands on its +z face.\n"
        "  base: {{mass: {:.6g} kg, shape: {{box: {{size: {}}}}}}}\n"
        "  arms:\n    - {{file: {}, {}mount: {{position: {}}}, hand: {}",
        base_mass, list(base_size), file,
        mounted.prefix.empty() ? "" : fmt::format("prefix: {}, ", mounted.prefix),
        list(mounted.mount.position), word(robot.hand));
    notes.push_back(fmt::format("base: {:.6g} kg, {} m, homogeneous", base_mass, list(base_size)));
  } else {
    assembly.add_robot(file_text, folders, file);
    robot.base_lines = fmt::format("  file: {}\n  hand: {}\n", file, word(robot.hand));
    notes.push_back(fmt::format("base: the file's own, {:.6g} kg", arm.mass_on_root()));
  }
  if (!request.package_path.empty()) {
    std::vector<std::string> paths;
    for (const std::string& folder : request.package_path)
      paths.push_back(word(from_problem(folder)));
    robot.joint_lines = fmt::format("  package_path: [{}]\n", fmt::join(paths, ", "));
  }
  const auto& remarks = assembly.remarks();
  if (std::any_of(remarks.begin(), remarks.end(),
                  [](const Finding& remark) { return remark.rule == "mesh"; })) {
    notes.push_back(
        "some meshes are not there: clearance does not cover their links, which `check` lists "
        "(--package-path says where to look)");
  }
  choose_joints(tree, arm, assembly, robot, notes);
  const std::string hand = robot.is_put_together ? assembly.hand() : robot.hand;
  try {
    robot.model = read_urdf(assembly.text(), request.robot, hand);
  } catch (const InputError& error) {  // its lines are those of the text that was put together
    std::vector<Finding> found = error.findings();
    for (Finding& finding : found) finding.line = 0;
    throw InputError(found);
  }
  if (robot.model.n() == 0) throw CommandLineError("no joint moves the hand " + robot.hand);
  return robot;
}

}  // namespace

Draft draft_problem(const DraftRequest& request) {
  Draft draft;
  DraftRobot draft_of;
  try {
    draft_of = draft_robot(request, draft.notes);
  } catch (const AssemblyError& error) {
    throw InputError({{request.robot, 0, error.rule(), error.what()}});
  }
  RobotModel& robot = draft_of.model;
  const double target_mass =
      request.target_mass > 0 ? request.target_mass : rounded_mass(0.1 * robot.total_mass());
  const TargetBody target = box_target(target_mass);
  const auto encounter = find_encounter(robot, target, draft_of.is_put_together);
  if (!encounter) {
    throw CommandLineError(
        "no posture was found in which the hand reaches the target's face without a collision; "
        "name another --hand, a smaller --target-mass or a smaller --base-size, or write the "
        "problem by hand");
  }
  std::string robot_lines = draft_of.base_lines;
  if (draft_of.is_put_together) {
    if (encounter->standoff > 0) {
      const Vector3d place = encounter->standoff * encounter->axis;
      robot_lines += fmt::format(", hand_frame: {{position: {}}}", list(place));
      draft.notes.push_back(
          fmt::format("the hand's frame is {:.3g} m beyond {}, where the shapes of its body end{}",
                      encounter->standoff, draft_of.hand,
                      encounter->is_further ? ", and further: nearer no posture is free" : ""));
    }
    robot_lines += "}\n";
  }
  robot_lines += draft_of.joint_lines;

  std::string start, resistance;
  double fastest = 0;
  bool slides = false;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const char* const comma = k > 0 ? ", " : "";
    start += comma + word(joint.name) + ": " + joint_value(joint, encounter->start[k]);
    // Rotor inertia times gear ratio squared: published values of harmonic drives lie near this.
    const double effort = std::isfinite(joint.max_effort) ? joint.max_effort : 50;
    resistance +=
        fmt::format("{}{}: {:.3g}", comma, word(joint.name), std::clamp(0.01 * effort, 0.02, 5.0));
    slides = slides || joint.is_prismatic();
    if (std::isfinite(joint.max_velocity)) fastest = std::max(fastest, joint.max_velocity);
  }
  std::string contacts;
  for (const auto& [a, b] : encounter->allowed_contacts) {
    contacts += fmt::format("{}[{}, {}]", contacts.empty() ? "" : ", ", word(a), word(b));
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
  const double contact_time = request.distance / kClosingSpeed;
  const double half_window = std::min({5.0, 10 / request.spin, contact_time / 4});
  const Vector3d spin_axis = Vector3d(1, 2, 2) / 3;
  const Vector3d omega = request.spin / kDegrees * spin_axis;
  const Vector3d velocity = -kClosingSpeed * encounter->direction;
  const Eigen::Quaterniond q = rotation_exp(-omega * contact_time) * encounter->target.orientation;
  const Vector3d position = encounter->target.position - velocity * contact_time;
  const double edge = std::get<Box>(target.shapes.front().geometry).size.x();

  draft.notes.push_back(
      fmt::format("target: a cube of {:.6g} kg, {:.3g} m, rotating at {:.3g} deg/s, contact after "
                  "about {:.3g} s",
                  target_mass, edge, request.spin, contact_time));
  draft.notes.push_back(
      "limits after the impact: base rate 1 deg/s, attitude change 20 deg within 10 s");
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
    orientation: {{w: {11:.17g}, x: {12:.17g}, y: {13:.17g}, z: {14:.17g}}}
    linear_velocity: {15}
    angular_velocity: {{axis: [1, 2, 2], rate: {16:g} deg/s}}
impact:
  source: rigid_body
  restitution: 0.1
  # Gears stand between rotor and link. A hundredth of the torque limit (kg m^2) is the size of rotor
  # inertia times gear ratio squared of harmonic drives; take the maker's numbers.
  joint_resistance: {{model: rotor_inertia, rotor_inertia: {{{17}}}}}
variables:
  joints: all
  base_position: free
  contact_time: {{lower: {18:.4g} s, upper: {19:.4g} s}}
objective: {{quantity: base_angular_momentum, measure: worst_case}}
hand:
  constraint: axis
  approach_axis: {20}
constraints:
{21}  closing_speed_min: 0.01 m/s
  clearance: {23:g} m
uncertainty:
  cone_half_angle: 5 deg
approach:
  base: floating
  acceleration_limit: 0.2
  velocity_scale: {22:.3g}
  wait: 2 s
  clearance: {23:g} m
post_impact:
  controllers: [rns_damped, joint_damping, none]
  horizon: 10 s
  residual_base_rate_max: 1 deg/s
  attitude_change_max: 20 deg
)",
      fs::path(request.robot).filename().string(), robot_lines, start,
      contacts.empty() ? ""
                       : fmt::format("  # These are closer than {:g} m in {}.\n"
                                     "  allowed_contacts: [{}]\n",
                                     2 * kDraftClearance, often, contacts),
      target_mass, target.inertia(0, 0), edge, list(target.features.front().point),
      request.distance, kClosingSpeed, list(position), q.w(), q.x(), q.y(), q.z(), list(velocity),
      request.spin, resistance, contact_time - half_window, contact_time + half_window,
      list(encounter->axis), slides ? "" : "  joint_limit_margin: 2 deg\n",
      fastest > 0 ? std::clamp(0.3 / fastest, 1e-3, 1.0) : 1.0, kDraftClearance);
  return draft;
}

}  // namespace stillbase::app
