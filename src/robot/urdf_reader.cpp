#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cassert>
#include <mutex>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/robot/physical_checks.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/urdf_guard.hpp"
#include "robot/urdf_schema.hpp"

namespace stillbase {

namespace {

using urdf::Findings;
using urdf::Outline;
using urdf::quoted;

/// Keeps urdfdom's error messages instead of printing them.
class MessageCollector : public console_bridge::OutputHandler {
 public:
  explicit MessageCollector(Findings& findings) : findings_(findings) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
  }
  ~MessageCollector() override {
    console_bridge::setLogLevel(level_);
    console_bridge::useOutputHandler(previous_);
  }
  MessageCollector(const MessageCollector&) = delete;
  MessageCollector& operator=(const MessageCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) findings_.add(0, "urdf", text);
  }

 private:
  Findings& findings_;
  console_bridge::OutputHandler* previous_ = console_bridge::getOutputHandler();
  console_bridge::LogLevel level_ = console_bridge::getLogLevel();
};

// Any error that urdfdom logs refuses the robot: it often goes on with a default instead.
::urdf::ModelInterfaceSharedPtr parse(const std::string& text, Findings& findings) {
  static std::mutex mutex;  // console_bridge's handler is global
  ::urdf::ModelInterfaceSharedPtr model;
  {
    const std::scoped_lock lock(mutex);
    const MessageCollector collector(findings);
    model = ::urdf::parseURDF(text);
  }
  findings.raise();
  if (model == nullptr) findings.add(0, "urdf", "urdfdom refuses the file without a reason");
  findings.raise();
  return model;
}

Pose pose_of(const ::urdf::Pose& origin) {
  Pose pose;
  pose.position << origin.position.x, origin.position.y, origin.position.z;
  const ::urdf::Rotation& q = origin.rotation;
  pose.orientation = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
  return pose;
}

// Axes with z along the unit vector a: the shortest turn from z. For a below the xy plane it is
// taken from -z, after half a turn about x, so that nothing is divided by nearly zero.
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

Part part_of(const ::urdf::Inertial& inertial, const Pose& T_body_link) {
  const Pose T_body_inertial = T_body_link * pose_of(inertial.origin);
  Matrix3d I;
  I << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
  const Matrix3d R = T_body_inertial.orientation.toRotationMatrix();
  return {inertial.mass, T_body_inertial.position, R * I * R.transpose()};
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

Geometry geometry_of(const ::urdf::Collision& collision) {
  const auto& geometry = *collision.geometry;
  if (const auto* sphere = dynamic_cast<const ::urdf::Sphere*>(&geometry)) {
    return Sphere{sphere->radius};
  }
  if (const auto* box = dynamic_cast<const ::urdf::Box*>(&geometry)) {
    return Box{Vector3d(box->dim.x, box->dim.y, box->dim.z)};
  }
  const auto* cylinder = dynamic_cast<const ::urdf::Cylinder*>(&geometry);
  assert(cylinder != nullptr);  // the guard lets nothing else through
  static const std::string kSuffix = "_capsule";
  const std::string& name = collision.name;
  const bool is_capsule = name.size() >= kSuffix.size() &&
                          name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) == 0;
  if (is_capsule) return Capsule{cylinder->radius, cylinder->length};
  return Cylinder{cylinder->radius, cylinder->length};
}

/// Walks the tree depth-first in file order and fills the model.
class Builder {
 public:
  Builder(const Outline& outline, const ::urdf::ModelInterface& model)
      : outline_(outline), model_(model) {
    robot_.name = model.getName();
    robot_.links.resize(outline.links.size());
    parts_.resize(1);
    place(outline.root, kBase, Pose{});
    collect_shapes();
    merge_bodies();
    move_origin_to_base_centroid();
  }

  RobotModel take() { return std::move(robot_); }

 private:
  void place(int link, int body, const Pose& pose) {
    const urdf::OutlineLink& outline = outline_.links[link];
    const std::string parent =
        outline.parent_joint < 0
            ? ""
            : outline_.links[outline_.joints[outline.parent_joint].parent].name;
    robot_.links[link] = {outline.name, body, pose, parent};
    if (const auto& inertial = model_.getLink(outline.name)->inertial) {
      parts_[body + 1].push_back(part_of(*inertial, pose));
    }
    for (const int j : outline.child_joints) {
      const auto& source = *model_.getJoint(outline_.joints[j].name);
      const Pose T_body_joint = pose * pose_of(source.parent_to_joint_origin_transform);
      const int child = outline_.joints[j].child;
      if (source.type == ::urdf::Joint::FIXED) {
        place(child, body, T_body_joint);
      } else {
        add_joint(source, child, body, T_body_joint);
      }
    }
  }

  void add_joint(const ::urdf::Joint& source, int child, int parent, const Pose& T_parent_joint) {
    Joint joint;
    joint.name = source.name;
    joint.type = source.type == ::urdf::Joint::PRISMATIC    ? JointType::Prismatic
                 : source.type == ::urdf::Joint::CONTINUOUS ? JointType::Continuous
                                                            : JointType::Revolute;
    joint.parent = parent;
    const Vector3d axis(source.axis.x, source.axis.y, source.axis.z);
    const Matrix3d R_align = axes_with_z_along(axis.stableNormalized());
    joint.R = T_parent_joint.orientation.toRotationMatrix() * R_align;
    joint.p = T_parent_joint.position;
    if (source.limits) {
      if (joint.type != JointType::Continuous) {
        joint.lower = source.limits->lower;
        joint.upper = source.limits->upper;
      }
      joint.max_velocity = source.limits->velocity;
      joint.max_effort = source.limits->effort;
    }
    if (source.dynamics) {
      joint.viscous_friction = source.dynamics->damping;
      joint.coulomb_friction = source.dynamics->friction;
    }
    const int body = robot_.n();
    robot_.joints.push_back(std::move(joint));
    robot_.bodies.emplace_back();
    robot_.bodies.back().name = outline_.links[child].name;
    parts_.emplace_back();
    place(child, body, Pose{Vector3d::Zero(), Eigen::Quaterniond(R_align.transpose())});
  }

  void collect_shapes() {
    for (const LinkFrame& link : robot_.links) {
      for (const auto& collision : model_.getLink(link.name)->collision_array) {
        robot_.shapes.push_back({link.body, link.name, link.pose * pose_of(collision->origin),
                                 geometry_of(*collision)});
      }
    }
  }

  void merge_bodies() {
    robot_.base.name = outline_.links[outline_.root].name;
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

  const Outline& outline_;
  const ::urdf::ModelInterface& model_;
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

void check_physics(const RobotModel& robot, const Outline& outline, Findings& findings) {
  const auto line_of = [&](const std::string& link) {
    const auto found = std::find_if(outline.links.begin(), outline.links.end(),
                                    [&](const urdf::OutlineLink& l) { return l.name == link; });
    return found->line;
  };
  check_body(robot.base, line_of(robot.base.name), findings);
  for (const Body& body : robot.bodies) check_body(body, line_of(body.name), findings);
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
  const Outline outline = urdf::guard(text, source);
  Findings findings(source);
  const ::urdf::ModelInterfaceSharedPtr model = parse(std::string(text), findings);
  for (const auto& link : outline.links) {
    if (!model->getLink(link.name)) findings.add(link.line, "urdf", "urdfdom lost the link");
  }
  for (const auto& joint : outline.joints) {
    if (!model->getJoint(joint.name)) findings.add(joint.line, "urdf", "urdfdom lost the joint");
  }
  findings.raise();

  RobotModel robot = Builder(outline, *model).take();
  check_physics(robot, outline, findings);
  const std::string hand_link = choose_hand(robot, hand, findings);
  findings.raise();
  return with_hand(std::move(robot), hand_link);
}

RobotModel read_robot(const std::string& path, const std::string& hand) {
  return read_urdf(read_text_file(path, kMaxUrdfBytes), path, hand);
}

}  // namespace stillbase
