#include "app/problem_draft.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/collision/contact_survey.hpp>
#include <stillbase/collision/scene.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "app/tool.hpp"
#include "app/words.hpp"
#include "robot/assembly.hpp"

namespace stillbase::app {

namespace {

constexpr double kClosingSpeed = 0.05;  // m/s, that of berthing
constexpr double kDensity = 200;        // kg/m^3, of satellites

/// The arm as the file has it: joints by the link that they carry.
class ArmTree {
 public:
  explicit ArmTree(const urdf::Tree& tree) : tree_(tree) {
    for (const urdf::TreeJoint& joint : tree.joints) above_[joint.child_name] = &joint;
  }

  /// Joints between root and link, the link's own first.
  std::vector<const urdf::TreeJoint*> way_to(const std::string& link) const {
    std::vector<const urdf::TreeJoint*> joints;
    for (auto at = above_.find(link); at != above_.end();
         at = above_.find(joints.back()->parent_name)) {
      joints.push_back(at->second);
    }
    return joints;
  }
  long moving_before(const std::string& link) const {
    const auto joints = way_to(link);
    return std::count_if(joints.begin(), joints.end(), [](auto* j) { return !j->is_fixed; });
  }
  long moving_after(const std::string& link) const {
    return std::count_if(tree_.joints.begin(), tree_.joints.end(), [&](const auto& joint) {
      return joint.parent_name == link && !joint.is_fixed;
    });
  }
  double mass_on_root() const {
    double mass = 0;
    for (const urdf::TreeLink& link : tree_.links) {
      if (link.inertial && moving_before(link.name) == 0) mass += link.inertial->mass;
    }
    return mass;
  }
  double mass() const {
    double sum = 0;
    for (const urdf::TreeLink& link : tree_.links) sum += link.inertial ? link.inertial->mass : 0;
    return sum;
  }

  /// The end behind the most joints that has the name of a tool; of a gripper the link that carries
  /// its fingers.
  std::string hand() const {
    const auto rank = [&](const urdf::TreeLink& link) {
      int name = 0;
      for (const char* part :
           {"tool0", "tcp", "hand", "grasp", "ee", "tool", "gripper", "flange"}) {
        ++name;
        if (link.name.find(part) != std::string::npos)
          return std::pair(moving_before(link.name), -name);
      }
      return std::pair(moving_before(link.name), -100);
    };
    const auto end = std::max_element(
        tree_.links.begin(), tree_.links.end(),
        [&](const urdf::TreeLink& a, const urdf::TreeLink& b) { return rank(a) < rank(b); });
    std::string hand = end->name;
    for (const urdf::TreeJoint* joint : way_to(end->name)) {
      if (!joint->is_fixed && moving_after(joint->parent_name) > 1) hand = joint->parent_name;
    }
    return hand;
  }

 private:
  const urdf::Tree& tree_;
  std::map<std::string, const urdf::TreeJoint*> above_;
};

double rounded(double x, double step) { return std::max(step, std::round(x / step) * step); }

/// To two digits.
double rounded_mass(double x) { return rounded(x, std::pow(10, std::floor(std::log10(x)) - 1)); }

std::string list(const Vector3d& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
}

/// The axis of the hand's frame that points on from the arm.
Vector3d approach_axis(const RobotModel& robot, const Kinematics<double>& kinematics) {
  Vector3d out = kinematics.r_bh;
  if (robot.hand_body != kBase) {
    out -= kinematics.o[robot.hand_body];
    if (out.norm() < 0.01) out = kinematics.z(robot.hand_body);
  }
  const Vector3d in_hand = kinematics.R_hand.transpose() * out;
  Eigen::Index axis = 0;
  in_hand.cwiseAbs().maxCoeff(&axis);
  return in_hand[axis] < 0 ? Vector3d(-Vector3d::Unit(axis)) : Vector3d(Vector3d::Unit(axis));
}

JointVectord middle_posture(const RobotModel& robot, Random& random, double part) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const double bound = joint.is_prismatic() ? 1 : kPi;
    const double lower = std::max(joint.lower, -bound), upper = std::min(joint.upper, bound);
    const double middle = (lower + upper) / 2, half = std::max(0.0, (upper - lower) / 2);
    phi[k] = middle + part * half * random.uniform(-1, 1);
  }
  return phi;
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

/// Where the robot starts, and how the target lies when it is met.
struct Encounter {
  JointVectord start;
  Vector3d axis = Vector3d::UnitZ();       ///< of the hand's frame
  Pose target;                             ///< at the contact, in B
  Vector3d direction = Vector3d::UnitX();  ///< in which the hand points then, in B
};

bool is_line_free(const RobotModel& robot, const CollisionScene& scene, const JointVectord& from,
                  const JointVectord& to) {
  constexpr int kSteps = 24;
  for (int i = 0; i <= kSteps; ++i) {
    const JointVectord phi = from + (to - from) * (static_cast<double>(i) / kSteps);
    if (scene.first_hit(compute_kinematics<double>(robot, phi), Pose{}, nullptr, 0.01))
      return false;
  }
  return true;
}

Encounter find_encounter(const RobotModel& robot, const TargetBody& target,
                         const SceneParts& own_parts) {
  constexpr int kPostures = 4000;
  Random random(1);
  SceneParts with_target = own_parts;
  with_target.target = target;
  with_target.feature = target.features.front();
  with_target.contact_allowance = 0.15;
  const CollisionScene own(robot, own_parts), both(robot, with_target);
  Encounter found;
  JointVectord best;
  double best_score = 0;
  std::vector<std::pair<JointVectord, Vector3d>> free;  // postures and places of the hand
  for (int i = 0; i < kPostures; ++i) {
    const JointVectord phi = middle_posture(robot, random, 0.8);
    const auto kinematics = compute_kinematics<double>(robot, phi);
    if (own.first_hit(kinematics, Pose{}, nullptr, 0.02)) continue;
    free.emplace_back(phi, kinematics.r_bh);
    const Vector3d axis = approach_axis(robot, kinematics);
    const Vector3d direction = kinematics.R_hand * axis;
    // The target comes from outside, and not across the base.
    const double outwards = direction.dot(kinematics.r_bh.normalized());
    const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
    const Matrix3d JJ = jacobian.J_phi.topRows<3>() * jacobian.J_phi.topRows<3>().transpose();
    const double score = outwards * std::sqrt(std::sqrt(std::max(JJ.determinant(), 0.0)));
    if (outwards < 0.3 || score <= best_score) continue;
    Pose pose;
    pose.orientation = rotation_between(Vector3d::UnitX(), -direction);
    pose.position = kinematics.r_bh - pose.orientation * target.features.front().point;
    if (both.first_hit(kinematics, Pose{}, &pose, 0.02)) continue;
    best = phi;
    best_score = score;
    found.axis = axis;
    found.target = pose;
    found.direction = direction;
  }
  if (best.size() == 0) {
    throw CommandLineError(
        "no posture was found that is free of collision and points outwards; "
        "write the problem by hand, or name another --hand");
  }
  // The nearest posture from which the hand moves forwards along a free line.
  const Vector3d place = compute_kinematics<double>(robot, best).r_bh;
  found.start = best;
  double least = kInfinity;
  for (const auto& [phi, hand] : free) {
    const double distance = (phi - best).norm();
    if ((place - hand).dot(found.direction) < 0.1 || distance >= least) continue;
    if (!is_line_free(robot, own, phi, best)) continue;
    least = distance;
    found.start = phi;
  }
  return found;
}

std::string joint_value(const Joint& joint, double value) {
  return joint.is_prismatic() ? fmt::format("{:.4f} m", value)
                              : fmt::format("{:.2f} deg", value * kDegrees);
}

}  // namespace

Draft draft_problem(const DraftRequest& request) {
  namespace fs = std::filesystem;
  Draft draft;
  urdf::MeshFolders folders{request.robot, request.package_path};
  for (std::string& folder : urdf::ros_package_path())
    folders.packages.push_back(std::move(folder));
  const std::string file_text = read_text_file(request.robot, kMaxUrdfBytes);
  const fs::path problem_folder = fs::absolute(request.problem).parent_path();
  const std::string file = fs::absolute(request.robot).lexically_proximate(problem_folder).string();

  RobotAssembly probe;
  probe.add_robot(file_text, folders, file);
  const ArmTree arm(probe.tree());
  const std::string hand = request.hand.empty() ? arm.hand() : request.hand;
  if (std::none_of(probe.tree().links.begin(), probe.tree().links.end(),
                   [&](const urdf::TreeLink& link) { return link.name == hand; })) {
    throw CommandLineError(fmt::format("--hand {}: {} has no such link", hand, request.robot));
  }
  if (request.hand.empty())
    draft.notes.push_back("hand link: " + hand + " (--hand chooses another)");

  const double moving = arm.mass() - arm.mass_on_root();
  const bool has_base = request.base_mass == 0 && arm.mass_on_root() >= moving;
  const double base_mass =
      request.base_mass > 0 ? request.base_mass : rounded_mass(std::max(50.0, 10 * arm.mass()));
  const Vector3d base_size =
      request.base_size.minCoeff() > 0
          ? request.base_size
          : Vector3d(Vector3d::Constant(rounded(std::cbrt(base_mass / kDensity), 0.05)));

  RobotAssembly assembly;
  std::string robot_lines;
  if (has_base) {
    assembly.add_robot(file_text, folders, file);
    robot_lines = fmt::format("  file: {}\n  hand: {}\n", file, hand);
    draft.notes.push_back(fmt::format("base: the file's own, {:.6g} kg", arm.mass_on_root()));
  } else {
    BaseBody base;
    base.mass = base_mass;
    base.inertia = homogeneous_inertia(base_mass, Box{base_size});
    base.shapes.emplace_back(Pose{}, Box{base_size});
    MountedArm mounted;
    mounted.hand = hand;
    mounted.mount.position.z() = base_size.z() / 2;
    assembly.add_base("draft", base);
    assembly.add_arm(file_text, folders, mounted);
    robot_lines = fmt::format(
        "  # A homogeneous box; the arm stands on its +z face.\n"
        "  base: {{mass: {:.6g} kg, shape: {{box: {{size: {}}}}}}}\n"
        "  arms:\n    - {{file: {}, mount: {{position: {}}}, hand: {}}}\n",
        base_mass, list(base_size), file, list(mounted.mount.position), hand);
    draft.notes.push_back(
        fmt::format("base: {:.6g} kg, {} m, homogeneous", base_mass, list(base_size)));
  }

  // What does not carry the hand keeps its place.
  std::vector<std::string> carrying;
  for (const urdf::TreeJoint* joint : arm.way_to(hand)) {
    if (!joint->is_fixed)
      carrying.push_back(joint->mimic ? joint->mimic->master : joint->joint.name);
  }
  std::string locked, limits;
  for (const urdf::TreeJoint& joint : probe.joints()) {
    if (joint.is_fixed || joint.mimic) continue;
    const std::string& name = joint.joint.name;
    if (std::find(carrying.begin(), carrying.end(), name) == carrying.end()) {
      const double position = std::clamp(0.0, joint.joint.lower, joint.joint.upper);
      assembly.lock(name, position);
      locked += fmt::format("    {}: {:.9g}\n", name, position);
      continue;
    }
    JointLimits stated;
    std::string words;
    const bool slides = joint.joint.is_prismatic();
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
      limits += fmt::format("    {}: {{{}}}\n", name, words);
    }
  }
  if (!locked.empty()) {
    robot_lines += "  # Joints that do not carry the hand: rad or m.\n  locked:\n" + locked;
  }
  if (!limits.empty()) {
    robot_lines += "  # The file gives none; these are guesses.\n  limits:\n" + limits;
    draft.notes.push_back("limits of rate or torque that the file does not give are guesses");
  }

  const RobotModel robot =
      read_urdf(assembly.text(), request.robot, has_base ? hand : assembly.hand());
  if (robot.n() == 0) throw CommandLineError("no joint moves the hand " + hand);
  const double target_mass =
      request.target_mass > 0 ? request.target_mass : rounded_mass(0.1 * robot.total_mass());
  const TargetBody target = box_target(target_mass);
  SceneParts parts;
  parts.allowed_contacts = survey_contacts(robot, {.postures_for_never = 200}).always;
  const Encounter encounter = find_encounter(robot, target, parts);

  std::string start, resistance;
  double fastest = 0;
  bool slides = false;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const char* const comma = k > 0 ? ", " : "";
    start += comma + joint.name + ": " + joint_value(joint, encounter.start[k]);
    // Rotor inertia times gear ratio squared: published values of harmonic drives lie near this.
    const double effort = std::isfinite(joint.max_effort) ? joint.max_effort : 50;
    resistance +=
        fmt::format("{}{}: {:.3g}", comma, joint.name, std::clamp(0.01 * effort, 0.02, 5.0));
    slides = slides || joint.is_prismatic();
    if (std::isfinite(joint.max_velocity)) fastest = std::max(fastest, joint.max_velocity);
  }
  std::string contacts;
  for (const auto& [a, b] : parts.allowed_contacts) {
    contacts += fmt::format("{}[{}, {}]", contacts.empty() ? "" : ", ", a, b);
  }
  const double contact_time = request.distance / kClosingSpeed;
  const double half_window = std::min({5.0, 10 / request.spin, contact_time / 4});
  const Vector3d spin_axis = Vector3d(1, 2, 2) / 3;
  const Vector3d omega = request.spin / kDegrees * spin_axis;
  const Vector3d velocity = -kClosingSpeed * encounter.direction;
  const Eigen::Quaterniond q = rotation_exp(-omega * contact_time) * encounter.target.orientation;
  const Vector3d position = encounter.target.position - velocity * contact_time;
  const double edge = std::get<Box>(target.shapes.front().geometry).size.x();

  draft.notes.push_back(fmt::format(
      "target: a cube of {:.6g} kg, {:.3g} m, rotating at {:.3g} deg/s, met after about {:.3g} s",
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
  clearance: 0.01 m
uncertainty:
  cone_half_angle: 5 deg
approach:
  base: floating
  acceleration_limit: 0.2
  velocity_scale: {22:.3g}
  wait: 2 s
  clearance: 0.01 m
post_impact:
  controllers: [rns_damped, joint_damping, none]
  horizon: 10 s
  residual_base_rate_max: 1 deg/s
  attitude_change_max: 20 deg
)",
      fs::path(request.robot).filename().string(), robot_lines, start,
      contacts.empty()
          ? ""
          : fmt::format("  # These touch in every posture.\n  allowed_contacts: [{}]\n", contacts),
      target_mass, target.inertia(0, 0), edge, list(target.features.front().point),
      request.distance, kClosingSpeed, list(position), q.w(), q.x(), q.y(), q.z(), list(velocity),
      request.spin, resistance, contact_time - half_window, contact_time + half_window,
      list(encounter.axis), slides ? "" : "  joint_limit_margin: 2 deg\n",
      fastest > 0 ? std::clamp(0.3 / fastest, 1e-3, 1.0) : 1.0);
  return draft;
}

}  // namespace stillbase::app
