// A URDF text as a checked tree of links: what has no physical or formal meaning is refused here.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

#include "robot/urdf_findings.hpp"

namespace stillbase::urdf {

/// Numbers of a file are at most this in size: what is larger is a mistake or an attack, and sums,
/// products and squares of smaller ones along a chain of fixed links stay finite.
inline constexpr double kLargestNumber = 1e60;

/// position = ratio * position of the master + offset.
struct Mimic {
  std::string master;
  double ratio = 1, offset = 0;
};

struct TreeJoint {
  int line = 0;
  bool is_fixed = false;
  bool is_free = false;               ///< floating or planar
  Joint joint;                        ///< as the file states it; parent and pose are not set
  Pose origin;                        ///< in the parent link
  Vector3d axis = Vector3d::UnitX();  ///< any length > 0
  std::optional<Mimic> mimic;         ///< of a joint that is free to move; never of another mimic
  std::string parent_name, child_name;
  int parent = -1, child = -1;  ///< indices into Tree::links
};

struct Inertial {
  Pose origin;  ///< in the link
  double mass = 0;
  Matrix3d inertia = Matrix3d::Zero();
  double rounding = 0;  ///< of the moments, kg m^2: what the digits of the file leave open
};

/// A mesh that a <collision> names.
struct MeshUse {
  int line = 0;
  Pose pose;         ///< in the link
  std::string file;  ///< as written
  Vector3d scale = Vector3d::Ones();
  std::vector<ConvexMesh> hulls;  ///< what stands for it, in its frame after scaling
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

/// The tree of a text. Couplings of couplings are followed to their master.
/// @throws InputError with every finding of the same stage
Tree read_tree(std::string_view text, Findings& findings);

/// Joint j keeps this position: it becomes a fixed joint, and with it every joint that follows it.
void lock(Tree& tree, std::size_t j, double position);

/// The tree as a URDF text, by the names of links and joints (indices and lines are not needed).
/// A bound of a joint that is infinite is written as kLargestNumber.
std::string urdf_text(const Tree& tree);

}  // namespace stillbase::urdf
