// A URDF text as a checked tree of links: what has no physical or formal meaning is refused here.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

#include "robot/urdf_element.hpp"

namespace stillbase::urdf {

struct TreeJoint {
  int line = 0;
  bool is_fixed = false;
  bool is_free = false;               ///< floating or planar
  Joint joint;                        ///< as the file states it; parent and pose are not set
  Pose origin;                        ///< in the parent link
  Vector3d axis = Vector3d::UnitX();  ///< any length > 0
  std::string parent_name, child_name;
  int parent = -1, child = -1;  ///< indices into Tree::links
};

struct Inertial {
  Pose origin;  ///< in the link
  double mass = 0;
  Matrix3d inertia = Matrix3d::Zero();
};

/// A mesh that a <collision> names.
struct MeshUse {
  int line = 0;
  Pose pose;  ///< in the link
  std::string file;
  Vector3d scale = Vector3d::Ones();
};

struct TreeLink {
  int line = 0;
  std::string name;
  std::optional<Inertial> inertial;
  std::vector<std::pair<Pose, Geometry>> shapes;  ///< in the link
  std::vector<MeshUse> meshes;
  int parent_joint = -1;          ///< index into Tree::joints; -1 for the root
  std::vector<int> child_joints;  ///< in file order
};

/// The tree of a file, in file order.
struct Tree {
  std::string name;
  std::vector<TreeLink> links;
  std::vector<TreeJoint> joints;
  int root = -1;
};

/// @throws InputError with every finding of the same stage
Tree read_tree(std::string_view text, Findings& findings);

TreeLink read_link(Element& element);
TreeJoint read_joint(Element& element);
/// The pose of the <origin> of a parent: fixed axes roll, pitch, yaw.
Pose read_origin(Element& parent);

}  // namespace stillbase::urdf
