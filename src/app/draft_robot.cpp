#include "app/draft_robot.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "app/draft_arm.hpp"
#include "app/draft_words.hpp"
#include "app/tool.hpp"
#include "app/words.hpp"
#include "robot/assembly.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

constexpr double kLeastBaseMass = 10;  // kg; larger ones are out of reach for hobby arms

/// Locks what does not carry the hand and gives limits to what has none.
void choose_joints(const urdf::Tree& tree, const ArmTree& arm, const std::string& hand,
                   RobotAssembly& assembly, DraftRobot& robot) {
  std::vector<std::string>& notes = robot.notes;
  std::vector<std::string> carrying;
  for (const urdf::TreeJoint* joint : arm.way_to(hand)) {
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
      (carries ? stiff : locked) += fmt::format("    {}: {:.17g}\n", yaml_word(name), position);
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
      limits += fmt::format("    {}: {{{}}}\n", yaml_word(name), words);
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

}  // namespace

DraftRobot draft_robot(const DraftRequest& request, const DraftMount& mount,
                       const std::string& tip) {
  urdf::MeshFolders folders{request.robot, request.package_path};
  for (std::string& folder : urdf::ros_package_path())
    folders.packages.push_back(std::move(folder));
  const std::string file_text = read_text_file(request.robot, kMaxUrdfBytes);
  const fs::path problem_folder = fs::absolute(request.problem).parent_path();
  const auto from_problem = [&](const std::string& path) {
    return fs::absolute(path).lexically_normal().lexically_proximate(problem_folder).string();
  };
  const std::string file = yaml_word(from_problem(request.robot));

  urdf::Findings findings(request.robot);
  const urdf::Tree tree = urdf::read_tree(file_text, findings);
  findings.raise();
  const ArmTree arm(tree);
  DraftRobot robot;
  std::vector<std::string>& notes = robot.notes;
  const std::string hand_link = request.hand.empty() ? arm.hand() : request.hand;
  if (!arm.has_link(hand_link)) {
    throw CommandLineError(fmt::format("--hand {}: {} has no such link", hand_link, request.robot));
  }
  robot.hand = tip.empty() ? hand_link : tip;
  robot.tips = arm.tips_beyond(hand_link);
  if (request.hand.empty())
    notes.push_back("hand link: " + robot.hand + " (--hand chooses another)");

  const double moving = arm.mass() - arm.mass_on_root();
  robot.is_put_together = request.base_mass > 0 || arm.mass_on_root() < moving;
  RobotAssembly assembly;
  if (robot.is_put_together) {
    const double base_mass = request.base_mass > 0
                                 ? request.base_mass
                                 : rounded_mass(std::max(kLeastBaseMass, 10 * arm.mass()));
    const Vector3d base_size =
        request.base_size.minCoeff() > 0
            ? request.base_size
            : Vector3d(Vector3d::Constant(rounded_to(std::cbrt(base_mass / kDensity), 0.05)));
    robot.base_size = base_size;
    BaseBody base;
    base.mass = base_mass;
    base.inertia = homogeneous_inertia(base_mass, Box{base_size});
    base.shapes.emplace_back(Pose{}, Box{base_size});
    MountedArm mounted;
    mounted.hand = robot.hand;
    mounted.hand_frame = Pose{};
    mounted.mount = mount.pose(base_size);
    if (arm.has_link(kBaseLink)) mounted.prefix = "arm_";
    assembly.add_base("draft", base);
    assembly.add_arm(file_text, folders, mounted);
    robot.base_lines = fmt::format(
        "  # A homogeneous box; the arm {} its +z face.\n"
        "  base: {{mass: {:.6g} kg, shape: {{box: {{size: {}}}}}}}\n"
        "  arms:\n    - {{file: {}, {}mount: {{position: {}{}}}, hand: {}",
        mount.is_lying ? "lies at the edge of" : "stands on", base_mass, vector_text(base_size),
        file, mounted.prefix.empty() ? "" : fmt::format("prefix: {}, ", mounted.prefix),
        vector_text(mounted.mount.position),
        mount.is_lying
            ? fmt::format(", orientation: {}", quaternion_text(mounted.mount.orientation))
            : "",
        yaml_word(robot.hand));
    if (mount.is_lying) {
      notes.push_back(fmt::format(
          "mount: the arm lies {:.3g} m above the base's +z face, its z axis along -x: standing on "
          "the face its hand never points away from the base",
          mount.lift));
    }
    notes.push_back(
        fmt::format("base: {:.6g} kg, {} m, homogeneous", base_mass, vector_text(base_size)));
  } else {
    assembly.add_robot(file_text, folders, file);
    robot.base_lines = fmt::format("  file: {}\n  hand: {}\n", file, yaml_word(robot.hand));
    notes.push_back(fmt::format("base: the file's own, {:.6g} kg", arm.mass_on_root()));
  }
  if (!request.package_path.empty()) {
    std::vector<std::string> paths;
    for (const std::string& folder : request.package_path)
      paths.push_back(yaml_word(from_problem(folder)));
    robot.joint_lines = fmt::format("  package_path: [{}]\n", fmt::join(paths, ", "));
  }
  const auto& remarks = assembly.remarks();
  if (std::any_of(remarks.begin(), remarks.end(),
                  [](const Finding& remark) { return remark.rule == "mesh"; })) {
    notes.push_back(
        "some meshes are not there: clearance does not cover their links, which `check` lists "
        "(--package-path says where to look)");
  }
  choose_joints(tree, arm, hand_link, assembly, robot);
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

}  // namespace stillbase::app
