// A robot model as a tree of links and joints, written as URDF.
#include <set>

#include <stillbase/core/error.hpp>
#include <stillbase/export/export.hpp>

#include "robot/urdf_tree.hpp"

namespace stillbase {

namespace {

const Body& body_of(const RobotModel& robot, int body) {
  return body == kBase ? robot.base : robot.bodies[static_cast<std::size_t>(body)];
}

/// Frame of the link that carries the mass of a body, in the body frame.
const Pose& frame_of_mass(const RobotModel& robot, int body) {
  return find_link(robot, body_of(robot, body).name)->pose;
}

/// Bodies that no link of a file stands for, of a robot put together in a program, get a link.
void add_missing_links(RobotModel& robot) {
  for (int body = robot.num_bodies() - 1; body >= kBase; --body) {
    const std::string& name = body_of(robot, body).name;
    if (find_link(robot, name) != nullptr) continue;
    robot.links.insert(robot.links.begin(), {name, body, {}, ""});
  }
}

/// @throws InputError for a mesh
urdf::TreeLink tree_link(const RobotModel& robot, const LinkFrame& link) {
  urdf::TreeLink out;
  out.name = link.name;
  const Pose T_link_body = link.pose.inverse();
  const Body& body = body_of(robot, link.body);
  if (link.name == body.name) {
    const Matrix3d R = T_link_body.orientation.toRotationMatrix();
    Pose centroid;
    centroid.position = T_link_body * body.centroid;
    out.inertial = urdf::Inertial{centroid, body.mass, R * body.inertia * R.transpose()};
  }
  for (const CollisionShape& shape : robot.shapes) {
    if (shape.link != link.name) continue;
    if (std::holds_alternative<ConvexMesh>(shape.geometry)) {
      throw InputError({{"", 0, "mesh",
                         "a collision shape of the link '" + shape.link +
                             "' is a mesh, which URDF keeps in a file of its own"}});
    }
    out.shapes.emplace_back(T_link_body * shape.pose, shape.geometry);
  }
  return out;
}

/// The joint that moves body k. Its own frame has its axis as z; the link frame stands as its file
/// has it.
urdf::TreeJoint tree_joint(const RobotModel& robot, int k) {
  urdf::TreeJoint out;
  out.joint = robot.tree()[static_cast<std::size_t>(k)];
  const Pose& T_body_link = frame_of_mass(robot, k);
  const Pose T_parent_joint{out.joint.p, Eigen::Quaterniond(out.joint.R.matrix())};
  out.origin = frame_of_mass(robot, out.joint.parent).inverse() * T_parent_joint * T_body_link;
  out.axis = T_body_link.orientation.conjugate() * Vector3d::UnitZ();
  out.parent_name = body_of(robot, out.joint.parent).name;
  out.child_name = body_of(robot, k).name;
  if (robot.is_coupled()) {
    const Coupling& coupling = robot.couplings[static_cast<std::size_t>(k)];
    const std::string& leader = robot.joints[static_cast<std::size_t>(coupling.joint)].name;
    if (leader != out.joint.name) out.mimic = urdf::Mimic{leader, coupling.ratio, coupling.offset};
  }
  return out;
}

/// Joins a further link of a body to the one that carries its mass.
urdf::TreeJoint fixed_joint(const RobotModel& robot, const LinkFrame& link, std::string name) {
  urdf::TreeJoint out;
  out.is_fixed = true;
  out.joint.name = std::move(name);
  out.origin = frame_of_mass(robot, link.body).inverse() * link.pose;
  out.parent_name = body_of(robot, link.body).name;
  out.child_name = link.name;
  return out;
}

}  // namespace

std::string robot_urdf(const RobotModel& model) {
  RobotModel robot = model;
  add_missing_links(robot);
  urdf::Tree tree;
  tree.name = robot.name;
  std::set<std::string> joint_names;
  for (const LinkFrame& link : robot.links) tree.links.push_back(tree_link(robot, link));
  for (int k = 0; k < robot.num_bodies(); ++k) {
    tree.joints.push_back(tree_joint(robot, k));
    joint_names.insert(tree.joints.back().joint.name);
  }
  for (const LinkFrame& link : robot.links) {
    if (link.name == body_of(robot, link.body).name) continue;
    std::string name = link.name + "_fixed";
    while (!joint_names.insert(name).second) name += '_';
    tree.joints.push_back(fixed_joint(robot, link, std::move(name)));
  }
  return urdf::urdf_text(tree);
}

}  // namespace stillbase
