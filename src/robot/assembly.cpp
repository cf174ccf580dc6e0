#include "robot/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/core/file.hpp>

namespace stillbase {

namespace {

struct UnitInertia {
  static Matrix3d diagonal(double x, double y, double z) { return Vector3d(x, y, z).asDiagonal(); }
  Matrix3d operator()(const Sphere& s) const {
    const double i = 0.4 * s.radius * s.radius;
    return diagonal(i, i, i);
  }
  Matrix3d operator()(const Cylinder& c) const {
    const double across = (3 * c.radius * c.radius + c.length * c.length) / 12;
    return diagonal(across, across, c.radius * c.radius / 2);
  }
  // A cylinder and two half spheres whose centroids are 3/8 of the radius outside of its ends.
  Matrix3d operator()(const Capsule& c) const {
    const double r = c.radius, l = c.length;
    const double cylinder = l / (l + 4 * r / 3), caps = 1 - cylinder;
    const double across =
        cylinder * (3 * r * r + l * l) / 12 + caps * (0.4 * r * r + l * l / 4 + 3 * l * r / 8);
    return diagonal(across, across, cylinder * r * r / 2 + caps * 0.4 * r * r);
  }
  Matrix3d operator()(const Box& b) const {
    const Vector3d q = b.size.cwiseAbs2() / 12;
    return diagonal(q.y() + q.z(), q.x() + q.z(), q.x() + q.y());
  }
  Matrix3d operator()(const ConvexMesh&) const {
    throw std::invalid_argument("the inertia of a mesh must be stated");
  }
};

urdf::Inertial inertial_of(const BaseBody& base) { return {Pose{}, base.mass, base.inertia}; }

}  // namespace

Matrix3d homogeneous_inertia(double mass, const Geometry& geometry) {
  return mass * std::visit(UnitInertia{}, geometry);
}

urdf::Tree RobotAssembly::read(std::string_view text, const urdf::MeshFolders& folders,
                               const std::string& name) {
  urdf::Findings findings(folders.robot_file);
  urdf::Tree tree = urdf::read_tree(text, findings);
  if (first_bad_byte(text) != std::string_view::npos) is_changed_ = true;  // plans are UTF-8
  if (urdf::enclose_meshes(tree, folders, collision_, findings)) is_changed_ = true;
  findings.raise();
  for (Finding& remark : findings.remarks()) {
    remark.file = name;  // the same wherever the problem lies
    remarks_.push_back(std::move(remark));
  }
  return tree;
}

void RobotAssembly::add_robot(std::string_view text, const urdf::MeshFolders& folders,
                              const std::string& name) {
  tree_ = read(text, folders, name);
  file_text_ = text;
}

void RobotAssembly::load_root(const BaseBody& base) {
  urdf::TreeLink& root = tree_.links[static_cast<std::size_t>(tree_.root)];
  if (root.inertial && root.inertial->mass > 0) {
    throw AssemblyError(
        "contradiction",
        fmt::format("the root link '{}' of the file has a mass of its own, {:g} kg; "
                    "leave one of them out, or mount the file with robot.arms",
                    root.name, root.inertial->mass));
  }
  root.inertial = inertial_of(base);
  root.shapes.insert(root.shapes.end(), base.shapes.begin(), base.shapes.end());
  is_changed_ = true;
}

void RobotAssembly::add_base(const std::string& name, const BaseBody& base) {
  tree_.name = name;
  tree_.root = 0;
  urdf::TreeLink root;
  root.name = kBaseLink;
  root.inertial = inertial_of(base);
  root.shapes = base.shapes;
  tree_.links.push_back(std::move(root));
  is_changed_ = true;
}

void RobotAssembly::add_arm(std::string_view text, const urdf::MeshFolders& folders,
                            const MountedArm& arm) {
  urdf::Tree part = read(text, folders, arm.file);
  std::set<std::string> links, joints;
  for (const urdf::TreeLink& link : tree_.links) links.insert(link.name);
  for (const urdf::TreeJoint& joint : tree_.joints) joints.insert(joint.joint.name);
  const auto rename = [&](std::string& name) { name = arm.prefix + name; };
  const auto take = [&](std::set<std::string>& names, const char* kind, std::string& name) {
    rename(name);
    if (names.insert(name).second) return;
    throw AssemblyError(
        "duplicate-name",
        fmt::format("there would be two {}s '{}'; give this arm another `prefix`", kind, name));
  };
  if (!arm.hand.empty() &&
      std::none_of(part.links.begin(), part.links.end(),
                   [&](const urdf::TreeLink& link) { return link.name == arm.hand; })) {
    std::vector<std::string> names;
    for (const urdf::TreeLink& link : part.links) names.push_back(link.name);
    throw AssemblyError("hand-unknown", fmt::format("there is no link '{}'; links: {}", arm.hand,
                                                    fmt::join(names, " ")));
  }
  for (urdf::TreeLink& link : part.links) take(links, "link", link.name);
  for (urdf::TreeJoint& joint : part.joints) {
    take(joints, "joint", joint.joint.name);
    rename(joint.parent_name);
    rename(joint.child_name);
    if (joint.mimic) rename(joint.mimic->master);
  }
  const auto free_name = [&](const std::set<std::string>& names, std::string name) {
    while (names.count(arm.prefix + name) > 0) name += "_";
    return name;
  };
  const auto fix = [&](const std::string& name, const std::string& parent, const std::string& child,
                       const Pose& origin) {
    urdf::TreeJoint joint;
    joint.is_fixed = true;
    joint.joint.name = free_name(joints, name);
    joint.parent_name = parent;
    joint.child_name = child;
    joint.origin = origin;
    part.joints.push_back(std::move(joint));
    take(joints, "joint", part.joints.back().joint.name);
  };
  fix("mount", kBaseLink, part.links[static_cast<std::size_t>(part.root)].name, arm.mount);
  if (!arm.hand.empty() && arm.hand_frame) {
    urdf::TreeLink frame;
    frame.name = free_name(links, "hand_frame");
    part.links.push_back(std::move(frame));
    take(links, "link", part.links.back().name);
    fix("hand_frame", arm.prefix + arm.hand, part.links.back().name, *arm.hand_frame);
  }
  if (hand_.empty() && !arm.hand.empty()) {
    hand_ = arm.hand_frame ? part.links.back().name : arm.prefix + arm.hand;
  }
  prefixes_.push_back(arm.prefix);
  std::move(part.links.begin(), part.links.end(), std::back_inserter(tree_.links));
  std::move(part.joints.begin(), part.joints.end(), std::back_inserter(tree_.joints));
}

std::string RobotAssembly::joint_named(const std::string& name) const {
  std::vector<std::string> found, names;
  for (const urdf::TreeJoint& joint : tree_.joints) {
    if (joint.joint.name == name) return name;
    const bool has_prefix =
        std::any_of(prefixes_.begin(), prefixes_.end(),
                    [&](const std::string& prefix) { return joint.joint.name == prefix + name; });
    if (has_prefix) found.push_back(joint.joint.name);
    if (!joint.is_fixed) names.push_back(joint.joint.name);
  }
  if (found.size() == 1) return found.front();
  if (found.empty()) {
    throw AssemblyError("unknown-name",
                        fmt::format("there is no such joint; joints: {}", fmt::join(names, " ")));
  }
  throw AssemblyError("unknown-name",
                      fmt::format("several arms have it: {}", fmt::join(found, " ")));
}

std::vector<std::string> RobotAssembly::links_named(const std::string& name) const {
  std::vector<std::string> found;
  for (const urdf::TreeLink& link : tree_.links) {
    const bool has_prefix = std::any_of(
        prefixes_.begin(), prefixes_.end(),
        [&](const std::string& prefix) { return !prefix.empty() && link.name == prefix + name; });
    if (link.name == name || has_prefix) found.push_back(link.name);
  }
  return found;
}

urdf::TreeJoint& RobotAssembly::find(const std::string& name) {
  const std::string full = joint_named(name);
  return *std::find_if(tree_.joints.begin(), tree_.joints.end(),
                       [&](const urdf::TreeJoint& j) { return j.joint.name == full; });
}

void RobotAssembly::lock(const std::string& name, double position) {
  const urdf::TreeJoint& joint = find(name);
  if (joint.is_fixed) throw AssemblyError("not-used", "is a fixed joint");
  if (joint.mimic) {
    throw AssemblyError("not-used",
                        fmt::format("follows {}: lock that one instead", joint.mimic->master));
  }
  if (!(position >= joint.joint.lower && position <= joint.joint.upper)) {
    throw AssemblyError("outside-limits",
                        fmt::format("{} {} is outside the joint's limits [{}, {}]", position,
                                    joint.joint.is_prismatic() ? "m" : "rad", joint.joint.lower,
                                    joint.joint.upper));
  }
  urdf::lock(tree_, static_cast<std::size_t>(&joint - tree_.joints.data()), position);
  is_changed_ = true;
}

void RobotAssembly::limit(const std::string& name, const JointLimits& limits) {
  urdf::TreeJoint& source = find(name);
  if (source.is_fixed) throw AssemblyError("not-used", "is a fixed joint");
  if (source.mimic) {
    throw AssemblyError("not-used",
                        fmt::format("follows {}: limit that one instead", source.mimic->master));
  }
  Joint& joint = source.joint;
  if (joint.type == JointType::Continuous && (limits.lower || limits.upper)) {
    if (!limits.lower || !limits.upper) {
      throw AssemblyError("missing-key", "a continuous joint takes both lower and upper, or none");
    }
    joint.type = JointType::Revolute;
  }
  joint.lower = limits.lower.value_or(joint.lower);
  joint.upper = limits.upper.value_or(joint.upper);
  if (!(joint.lower <= joint.upper)) {
    throw AssemblyError("out-of-range",
                        fmt::format("lower {} is above upper {}", joint.lower, joint.upper));
  }
  joint.max_velocity = limits.rate.value_or(joint.max_velocity);
  if (joint.is_prismatic() ? limits.torque.has_value() : limits.force.has_value()) {
    throw AssemblyError("not-used", joint.is_prismatic() ? "a prismatic joint has a `force`"
                                                         : "a revolute joint has a `torque`");
  }
  joint.max_effort = limits.torque.value_or(limits.force.value_or(joint.max_effort));
  is_changed_ = true;
}

void RobotAssembly::drive(const std::string& name, const JointRotor& rotor) {
  urdf::TreeJoint& source = find(name);
  if (source.is_fixed) throw AssemblyError("not-used", "is a fixed joint");
  source.joint.rotor_inertia = rotor.inertia;
  source.joint.gear_ratio = rotor.gear_ratio;
  is_changed_ = true;
}

}  // namespace stillbase
