// URDF text -> tree of links -> RobotModel.
#include <stillbase/robot/urdf_reader.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "robot/geometric_model.hpp"
#include "robot/mesh_shapes.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase {

namespace {

using namespace urdf;

// Angles such as 1.5707963267948966 mean axes that are those of the parent in another order; sines,
// cosines and quaternions leave some 1e-16 beside them, less than such an angle can state.
Matrix3d without_rounding(const Matrix3d& R) {
  constexpr double kRounding = 1e-15;
  const Matrix3d rounded = R.array().round() + 0.0;  // not -0
  return (R - rounded).cwiseAbs().maxCoeff() < kRounding ? rounded : R;
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

Part part_of(const Inertial& inertial, const Pose& T_body_link) {
  const Pose T_body_inertial = T_body_link * inertial.origin;
  const Matrix3d R = T_body_inertial.orientation.toRotationMatrix();
  return {inertial.mass, T_body_inertial.position, R * inertial.inertia * R.transpose()};
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

/// Walks the tree depth-first in file order and fills the model.
class Builder {
 public:
  explicit Builder(const Tree& tree) : tree_(tree), parts_(1) {
    robot_.name = tree.name;
    robot_.links.resize(tree.links.size());
    place(tree.root, kBase, Pose{});
    for (std::size_t i = 0; i < tree.links.size(); ++i) {
      const LinkFrame& link = robot_.links[i];
      for (const auto& [pose, geometry] : tree.links[i].shapes) {
        robot_.shapes.push_back({link.body, link.name, link.pose * pose, geometry});
      }
      for (const MeshUse& mesh : tree.links[i].meshes) {
        for (const ConvexMesh& hull : mesh.hulls) {
          robot_.shapes.push_back({link.body, link.name, link.pose * mesh.pose, hull});
        }
      }
    }
    merge_bodies();
    couple_joints();
    move_origin_to_base_centroid();
  }

  RobotModel take() { return std::move(robot_); }

 private:
  void place(int index, int body, const Pose& pose) {
    const TreeLink& link = tree_.links[index];
    const std::string parent =
        link.parent_joint < 0 ? "" : tree_.links[tree_.joints[link.parent_joint].parent].name;
    robot_.links[index] = {link.name, body, pose, parent};
    if (link.inertial) parts_[body + 1].push_back(part_of(*link.inertial, pose));
    for (const int j : link.child_joints) {
      const TreeJoint& joint = tree_.joints[j];
      const Pose T_body_joint = pose * joint.origin;
      if (joint.is_fixed) {
        place(joint.child, body, T_body_joint);
      } else {
        add_joint(joint, body, T_body_joint);
      }
    }
  }

  void add_joint(const TreeJoint& source, int parent, const Pose& T_parent_joint) {
    const Matrix3d R_align = axes_with_z_along(source.axis.stableNormalized());
    const int body = robot_.n();
    robot_.joints.push_back(source.joint);
    sources_.push_back(&source);
    Joint& joint = robot_.joints.back();
    joint.parent = parent;
    joint.R = without_rounding(T_parent_joint.orientation.toRotationMatrix() * R_align);
    joint.p = T_parent_joint.position;
    robot_.bodies.emplace_back();
    robot_.bodies.back().name = source.child_name;
    parts_.emplace_back();
    place(source.child, body, Pose{Vector3d::Zero(), Eigen::Quaterniond(R_align.transpose())});
  }

  void merge_bodies() {
    robot_.base.name = tree_.links[tree_.root].name;
    for (const LinkFrame& link : robot_.links) {
      Body& body = link.body == kBase ? robot_.base : robot_.bodies[link.body];
      if (link.name != body.name) body.merged_links.push_back(link.name);
    }
    merge(parts_[0], robot_.base);
    for (int k = 0; k < robot_.num_bodies(); ++k) merge(parts_[k + 1], robot_.bodies[k]);
  }

  // Joints that follow others leave the list of joints; the tree keeps them all. The friction of a
  // joint counts at its master: viscous by the square of the ratio, Coulomb by the ratio.
  void couple_joints() {
    const auto follows = [](const TreeJoint* source) { return source->mimic.has_value(); };
    if (std::none_of(sources_.begin(), sources_.end(), follows)) return;
    robot_.coupled_tree = std::move(robot_.joints);
    robot_.joints.clear();
    std::map<std::string, int> number;
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      if (follows(sources_[k])) continue;
      number[robot_.coupled_tree[k].name] = robot_.n();
      robot_.joints.push_back(robot_.coupled_tree[k]);
    }
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      const Joint& joint = robot_.coupled_tree[k];
      if (!follows(sources_[k])) {
        robot_.couplings.push_back({number.at(joint.name), 1, 0});
        continue;
      }
      const Mimic& mimic = *sources_[k]->mimic;
      const int master = number.at(mimic.master);
      robot_.couplings.push_back({master, mimic.ratio, mimic.offset});
      Joint& moved = robot_.joints[static_cast<std::size_t>(master)];
      moved.viscous_friction += mimic.ratio * mimic.ratio * joint.viscous_friction;
      moved.coulomb_friction += std::abs(mimic.ratio) * joint.coulomb_friction;
    }
  }

  // So far the base's quantities are in the frame of the root link; B has its origin at the
  // centroid of the base body.
  void move_origin_to_base_centroid() {
    const Vector3d shift = robot_.base.centroid;
    robot_.base.centroid.setZero();
    for (auto* joints : {&robot_.joints, &robot_.coupled_tree}) {
      for (Joint& joint : *joints) {
        if (joint.parent == kBase) joint.p -= shift;
      }
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
  std::vector<const TreeJoint*> sources_;  // of the joints, as they were added
  std::vector<std::vector<Part>> parts_;   // [0]: base, [k + 1]: body k
};

/// What resists the joint that moves a body, of the body alone: kg m^2 or kg.
double inertia_about(const Joint& joint, const Body& body) {
  const double own = joint.is_prismatic()
                         ? body.mass
                         : body.inertia(2, 2) + body.mass * body.centroid.head<2>().squaredNorm();
  return own + joint.reflected_inertia();
}

/// A tensor with a moment of zero is that of a point mass or of a rod without thickness. With it
/// the matrices stay positive definite as long as every joint has an inertia to move.
/// @param joint that moves the body; null: the base
/// @return why it cannot be read; empty when it can
std::string thinness_fault(const Body& body, const Joint* joint) {
  if (joint == nullptr) return "";
  const double size = body.inertia.trace() + body.mass * body.centroid.squaredNorm();
  if (inertia_about(*joint, body) > 1e-12 * size) return "";
  return fmt::format("no inertia about its joint {}; give it a tensor, or lock the joint",
                     in_quotes(joint->name));
}

/// @param joint that moves the body; null: the base
/// @param rounding of the moments of inertia, kg m^2
void check_inertia(const Body& body, const std::string& name, int line, const Joint* joint,
                   bool may_be_thin, double rounding, Findings& findings) {
  const std::string wrong = inertia_fault(body.inertia);
  if (wrong.empty()) return;
  if (inertia_fault(body.inertia, rounding).empty()) {
    findings.remark(line, "inertia",
                    "the inertia tensor breaks the triangle inequality by no more than the digits "
                    "of the file leave open",
                    body.name);
  } else if (!may_be_thin || !inertia_fault(body.inertia, rounding, true).empty()) {
    findings.add(line, "inertia", name + ": " + wrong);
  } else if (const std::string fault = thinness_fault(body, joint); !fault.empty()) {
    findings.add(line, "inertia", name + ": " + fault);
  } else {
    findings.remark(line, "inertia",
                    "a principal moment of inertia is 0: a point mass or a rod without thickness",
                    body.name);
  }
}

/// @param joint that moves the body; null: the base
/// @param rounding of the moments of inertia, kg m^2
void check_body(const Body& body, int line, const Joint* joint, bool may_lack_mass, double rounding,
                Findings& findings) {
  std::string name = "body " + in_quotes(body.name);
  if (!body.merged_links.empty()) {
    name += fmt::format(" (with {} merged links)", body.merged_links.size());
  }
  if (may_lack_mass && body.mass >= 0 && body.inertia.isZero(0)) {
    findings.remark(line, "mass",
                    fmt::format("{}: no {}: an arm that has yet to be mounted on a base", name,
                                body.mass == 0 ? "mass" : "inertia"));
  } else if (const std::string fault = mass_fault(body.mass); !fault.empty()) {
    const std::string what_to_do =
        joint == nullptr ? "" : "; give it one, or lock its joint " + in_quotes(joint->name);
    findings.add(line, "mass", name + ": " + fault + what_to_do);
  } else {
    check_inertia(body, name, line, joint, joint != nullptr || may_lack_mass, rounding, findings);
  }
}

/// The sum alone counts in a body, but a part of it that cannot be is a mistake all the same.
void check_merged(const TreeLink& link, const std::string& body, Findings& findings) {
  const std::string fault = inertia_fault(link.inertial->inertia, link.inertial->rounding, true);
  if (fault.empty()) return;
  findings.remark(link.line, "inertia",
                  "a link that is merged into another one has a tensor that no body can have",
                  fmt::format("{} (merged into {}): {}", link.name, body, fault));
}

void check_physics(const RobotModel& robot, const Tree& tree, bool may_lack_base,
                   Findings& findings) {
  std::vector<double> roundings(robot.bodies.size() + 1, 0);  // of the base first
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const auto& inertial = tree.links[i].inertial;
    if (!inertial) continue;
    const auto number = static_cast<std::size_t>(robot.links[i].body + 1);
    roundings[number] += inertial->rounding;
    const std::string& body = number == 0 ? robot.base.name : robot.bodies[number - 1].name;
    if (tree.links[i].name != body) check_merged(tree.links[i], body, findings);
  }
  const auto check = [&](const Body& body, std::size_t number, const Joint* joint,
                         bool may_lack_mass) {
    const auto link =
        std::find_if(tree.links.begin(), tree.links.end(),
                     [&](const TreeLink& candidate) { return candidate.name == body.name; });
    check_body(body, link->line, joint, may_lack_mass, roundings[number], findings);
  };
  check(robot.base, 0, nullptr, may_lack_base);
  const bool has_masses = std::any_of(robot.bodies.begin(), robot.bodies.end(),
                                      [](const Body& body) { return body.mass != 0; });
  if (!has_masses && robot.bodies.size() > 1) {
    findings.add(
        0, "mass",
        "no link that a joint moves has a mass: the file states the kinematics alone; give "
        "its links an <inertial> with mass and inertia");
    return;
  }
  for (std::size_t k = 0; k < robot.bodies.size(); ++k) {
    check(robot.bodies[k], k + 1, &robot.tree()[k], false);
  }
}

/// Of several leaves the one behind the most movable joints, the first of those.
std::string farthest_leaf(const RobotModel& robot, const std::vector<std::string>& leaves) {
  const auto joints_before = [&](const std::string& leaf) {
    int count = 0;
    for (int k = find_link(robot, leaf)->body; k != kBase; k = robot.tree()[k].parent) ++count;
    return count;
  };
  return *std::max_element(leaves.begin(), leaves.end(),
                           [&](const std::string& a, const std::string& b) {
                             return joints_before(a) < joints_before(b);
                           });
}

std::string choose_hand(const RobotModel& robot, const std::string& hand, bool may_lack_hand,
                        Findings& findings) {
  if (!hand.empty()) {
    if (find_link(robot, hand) == nullptr) {
      std::string names;
      for (const LinkFrame& link : robot.links) names += " " + link.name;
      findings.add(0, "hand-unknown",
                   fmt::format("there is no link {}; links:{}", in_quotes(hand), names));
    }
    return hand;
  }
  const std::vector<std::string> leaves = leaf_links(robot);
  if (leaves.size() == 1) return leaves.front();
  const std::string chosen = farthest_leaf(robot, leaves);
  const std::string names = fmt::format("{}", fmt::join(leaves, " "));
  if (may_lack_hand) {
    findings.remark(0, "hand-missing",
                    fmt::format("no hand link is named: {} is taken, of the links without "
                                "children: {}",
                                in_quotes(chosen), names));
  } else {
    findings.add(0, "hand-missing", "name the hand link; links without children: " + names);
  }
  return chosen;
}

/// The kernel's matrices hold no more. Joints that are locked do not count.
void check_number_of_joints(const Tree& tree, Findings& findings) {
  int movable = 0, line = 0;
  for (const TreeJoint& joint : tree.joints) {
    if (!joint.is_fixed && ++movable == kMaxJoints + 1) line = joint.line;
  }
  if (movable <= kMaxJoints) return;
  findings.add(
      line, "too-many-joints",
      fmt::format("{} movable joints, at most {}: in a problem, `robot.locked` holds those "
                  "that need not move",
                  movable, kMaxJoints));
  findings.raise();
}

RobotModel model_of(const Tree& tree, const std::string& hand, const UrdfOptions& options,
                    Findings& findings) {
  check_number_of_joints(tree, findings);
  RobotModel robot = Builder(tree).take();
  check_physics(robot, tree, options.may_lack_base, findings);
  const std::string hand_link = choose_hand(robot, hand, options.may_lack_hand, findings);
  findings.raise();
  robot.remarks = findings.remarks();
  return with_hand(std::move(robot), hand_link);
}

}  // namespace

RobotModel read_urdf(std::string_view text, const std::string& source, const std::string& hand,
                     const UrdfOptions& options) {
  Findings findings(source);
  const Tree tree = read_tree(text, findings);
  for (const TreeLink& link : tree.links) {
    for (const MeshUse& mesh : link.meshes) {
      if (!mesh.hulls.empty()) continue;
      findings.remark(mesh.line, "mesh",
                      "meshes that are not there: clearance does not cover these links",
                      fmt::format("{} ({})", link.name, mesh.file));
    }
  }
  return model_of(tree, hand, options, findings);
}

RobotModel read_geometric_model(std::string_view text) {
  Findings findings("");
  const Tree tree = read_tree(text, findings);
  RobotModel robot = Builder(tree).take();
  const std::string hand = leaf_links(robot).front();
  return with_hand(std::move(robot), hand);
}

RobotModel read_robot(const std::string& path, const std::string& hand,
                      const UrdfOptions& options) {
  Findings findings(path);
  Tree tree = read_tree(read_text_file(path, kMaxUrdfBytes), findings);
  MeshFolders folders{path, options.package_path};
  for (std::string& folder : ros_package_path()) folders.packages.push_back(std::move(folder));
  enclose_meshes(tree, folders, options.collision, findings);
  return model_of(tree, hand, options, findings);
}

}  // namespace stillbase
