// URDF text -> checked XML -> tree of links -> RobotModel.
//
// The text is parsed by TinyXML 2, which bounds the nesting and knows the line of every element and
// attribute, and held against a table of the URDF elements that we read (urdf_schema.cpp). After
// that every number in it is known to be finite and the joints are known to form a tree.
#include <stillbase/robot/urdf_reader.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "robot/urdf_tree.hpp"

namespace stillbase {

namespace {

using namespace urdf;

/// The pose of <origin> in an element; fixed axes roll, pitch, yaw.
Pose origin_of(const XMLElement& element) {
  const XMLElement* origin = element.FirstChildElement("origin");
  Vector3d c, s;
  for (int i = 0; i < 3; ++i) {
    const double half = vector(origin, "rpy")[i] / 2;
    c[i] = std::cos(half);
    s[i] = std::sin(half);
  }
  const double x = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
  const double y = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
  const double z = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
  const double w = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
  const double norm = std::sqrt(x * x + y * y + z * z + w * w);
  return {vector(origin, "xyz"),
          Eigen::Quaterniond(w / norm, x / norm, y / norm, z / norm).normalized()};
}

// Axes with z along the unit vector a: the shortest rotation from z. For a below the xy plane it
// is taken from -z, after half a turn about x, so that nothing is divided by nearly zero.
Matrix3d axes_with_z_along(const Vector3d& a) {
  const double side = a.z() < 0 ? -1 : 1;
  const Vector3d from(0, 0, side);
  const Matrix3d V = skew<double>(from.cross(a));
  const Matrix3d turn = Matrix3d::Identity() + V + V * V / (1 + std::abs(a.z()));
  return turn * Vector3d(1, side, side).asDiagonal();
}

/// What one link brings to its body, in body axes.
struct Part {
  double mass;
  Vector3d centroid;
  Matrix3d inertia;  // about the part's own centroid
};

Part part_of(const XMLElement& inertial, const Pose& T_body_link) {
  const Pose T_body_inertial = T_body_link * origin_of(inertial);
  const XMLElement* inertia = inertial.FirstChildElement("inertia");
  const auto entry = [&](const char* name) { return number(inertia, name); };
  Matrix3d I;
  I << entry("ixx"), entry("ixy"), entry("ixz"), entry("ixy"), entry("iyy"), entry("iyz"),
      entry("ixz"), entry("iyz"), entry("izz");
  const Matrix3d R = T_body_inertial.orientation.toRotationMatrix();
  return {number(inertial.FirstChildElement("mass"), "value"), T_body_inertial.position,
          R * I * R.transpose()};
}

// Sum of masses, mean of centroids, parallel-axis theorem.
void merge(const std::vector<Part>& parts, Body& body) {
  for (const Part& part : parts) {
    body.mass += part.mass;
    body.centroid += part.mass * part.centroid;
  }
  if (!(body.mass > 0)) return;  // refused later, by name
  body.centroid /= body.mass;
  for (const Part& part : parts) {
    const Matrix3d D = skew<double>(part.centroid - body.centroid);
    body.inertia += part.inertia - part.mass * D * D;
  }
  body.inertia = 0.5 * (body.inertia + body.inertia.transpose()).eval();
}

/// A cylinder whose <collision> has a name that ends in "_capsule" is a capsule.
Geometry geometry_of(const XMLElement& collision) {
  constexpr std::string_view kSuffix = "_capsule";
  const XMLElement* shape = collision.FirstChildElement("geometry")->FirstChildElement();
  const std::string_view type = shape->Name();
  const double radius = number(shape, "radius"), length = number(shape, "length");
  if (type == "sphere") return Sphere{radius};
  if (type == "box") return Box{vector(shape, "size")};
  const char* attribute = collision.Attribute("name");
  const std::string_view name = attribute != nullptr ? attribute : "";
  if (name.ends_with(kSuffix)) return Capsule{radius, length};
  return Cylinder{radius, length};
}

/// Walks the tree depth-first in file order and fills the model.
class Builder {
 public:
  Builder(const Tree& tree, const std::string& name) : tree_(tree), parts_(1) {
    robot_.name = name;
    robot_.links.resize(tree.links.size());
    place(tree.root, kBase, Pose{});
    for (std::size_t i = 0; i < tree.links.size(); ++i) add_shapes(tree.links[i], robot_.links[i]);
    merge_bodies();
    move_origin_to_base_centroid();
  }

  RobotModel take() { return std::move(robot_); }

 private:
  void place(int index, int body, const Pose& pose) {
    const TreeLink& link = tree_.links[index];
    const std::string parent =
        link.parent_joint < 0 ? "" : tree_.links[tree_.joints[link.parent_joint].parent].name;
    robot_.links[index] = {link.name, body, pose, parent};
    if (const XMLElement* inertial = link.element->FirstChildElement("inertial")) {
      parts_[body + 1].push_back(part_of(*inertial, pose));
    }
    for (const int j : link.child_joints) {
      const TreeJoint& joint = tree_.joints[j];
      const Pose T_body_joint = pose * origin_of(*joint.element);
      if (std::string_view(joint.element->Attribute("type")) == "fixed") {
        place(joint.child, body, T_body_joint);
      } else {
        add_joint(joint, body, T_body_joint);
      }
    }
  }

  void add_joint(const TreeJoint& source, int parent, const Pose& T_parent_joint) {
    const XMLElement& element = *source.element;
    const std::string_view type = element.Attribute("type");
    Joint joint;
    joint.name = source.name;
    joint.type = type == "prismatic"    ? JointType::Prismatic
                 : type == "continuous" ? JointType::Continuous
                                        : JointType::Revolute;
    joint.parent = parent;
    const Vector3d axis = vector(element.FirstChildElement("axis"), "xyz", Vector3d::UnitX());
    const Matrix3d R_align = axes_with_z_along(axis.stableNormalized());
    joint.R = T_parent_joint.orientation.toRotationMatrix() * R_align;
    joint.p = T_parent_joint.position;
    const XMLElement* limit = element.FirstChildElement("limit");
    if (joint.type != JointType::Continuous) {
      joint.lower = number(limit, "lower");
      joint.upper = number(limit, "upper");
    }
    joint.max_velocity = number(limit, "velocity", joint.max_velocity);
    joint.max_effort = number(limit, "effort", joint.max_effort);
    const XMLElement* dynamics = element.FirstChildElement("dynamics");
    joint.viscous_friction = number(dynamics, "damping");
    joint.coulomb_friction = number(dynamics, "friction");
    const int body = robot_.n();
    robot_.joints.push_back(std::move(joint));
    robot_.bodies.emplace_back();
    robot_.bodies.back().name = tree_.links[source.child].name;
    parts_.emplace_back();
    place(source.child, body, Pose{Vector3d::Zero(), Eigen::Quaterniond(R_align.transpose())});
  }

  void add_shapes(const TreeLink& source, const LinkFrame& link) {
    for (const XMLElement* collision : children(*source.element, "collision")) {
      robot_.shapes.push_back(
          {link.body, link.name, link.pose * origin_of(*collision), geometry_of(*collision)});
    }
  }

  void merge_bodies() {
    robot_.base.name = tree_.links[tree_.root].name;
    for (const LinkFrame& link : robot_.links) {
      Body& body = link.body == kBase ? robot_.base : robot_.bodies[link.body];
      if (link.name != body.name) body.merged_links.push_back(link.name);
    }
    merge(parts_[0], robot_.base);
    for (int k = 0; k < robot_.n(); ++k) merge(parts_[k + 1], robot_.bodies[k]);
  }

  // So far the base's quantities are in the frame of the root link; B has its origin at the
  // centroid of the base body.
  void move_origin_to_base_centroid() {
    const Vector3d shift = robot_.base.centroid;
    robot_.base.centroid.setZero();
    for (Joint& joint : robot_.joints) {
      if (joint.parent == kBase) joint.p -= shift;
    }
    for (LinkFrame& link : robot_.links) {
      if (link.body == kBase) link.pose.position -= shift;
    }
    for (CollisionShape& shape : robot_.shapes) {
      if (shape.body == kBase) shape.pose.position -= shift;
    }
  }

  const Tree& tree_;
  RobotModel robot_;
  std::vector<std::vector<Part>> parts_;  // [0]: base, [k + 1]: body k
};

void check_body(const Body& body, int line, Findings& findings) {
  std::string name = "body " + quoted(body.name);
  if (!body.merged_links.empty()) {
    name += fmt::format(" (with {} merged links)", body.merged_links.size());
  }
  if (const std::string fault = mass_fault(body.mass); !fault.empty()) {
    findings.add(line, "mass", name + ": " + fault);
  } else if (const std::string wrong = inertia_fault(body.inertia); !wrong.empty()) {
    findings.add(line, "inertia", name + ": " + wrong);
  }
}

void check_physics(const RobotModel& robot, const Tree& tree, Findings& findings) {
  const auto check = [&](const Body& body) {
    const auto link =
        std::find_if(tree.links.begin(), tree.links.end(),
                     [&](const TreeLink& candidate) { return candidate.name == body.name; });
    check_body(body, link->element->GetLineNum(), findings);
  };
  check(robot.base);
  for (const Body& body : robot.bodies) check(body);
}

std::string choose_hand(const RobotModel& robot, const std::string& hand, Findings& findings) {
  if (!hand.empty()) {
    if (find_link(robot, hand) == nullptr) {
      std::string names;
      for (const LinkFrame& link : robot.links) names += " " + link.name;
      findings.add(0, "hand-unknown",
                   fmt::format("there is no link {}; links:{}", quoted(hand), names));
    }
    return hand;
  }
  const std::vector<std::string> leaves = leaf_links(robot);
  if (leaves.size() != 1) {
    std::string names;
    for (const std::string& leaf : leaves) names += " " + leaf;
    findings.add(0, "hand-missing", "name the hand link; links without children:" + names);
  }
  return leaves.front();
}

}  // namespace

RobotModel read_urdf(std::string_view text, const std::string& source, const std::string& hand) {
  Findings findings(source);
  tinyxml2::XMLDocument document;
  const Tree tree = read_tree(text, document, findings);
  RobotModel robot = Builder(tree, document.RootElement()->Attribute("name")).take();
  check_physics(robot, tree, findings);
  const std::string hand_link = choose_hand(robot, hand, findings);
  findings.raise();
  return with_hand(std::move(robot), hand_link);
}

RobotModel read_robot(const std::string& path, const std::string& hand) {
  return read_urdf(read_text_file(path, kMaxUrdfBytes), path, hand);
}

}  // namespace stillbase
