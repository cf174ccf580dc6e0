// A spacecraft put together from a base body and arms of files, as one URDF text.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/robot/assembled_robot.hpp>

#include "robot/mesh_shapes.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase {

/// A part does not fit. what() says why and what to do, without the key that states it.
class AssemblyError : public std::runtime_error {
 public:
  AssemblyError(std::string rule, const std::string& message)
      : std::runtime_error(message), rule_(std::move(rule)) {}
  const std::string& rule() const { return rule_; }

 private:
  std::string rule_;
};

/// Grows by parts: first all files, then what is said of their joints, then text().
class RobotAssembly {
 public:
  /// @param collision what stands for the meshes of all files
  explicit RobotAssembly(CollisionMeshes collision = CollisionMeshes::Hull)
      : collision_(collision) {}

  /// A robot file as the whole robot.
  /// @param name of the file for remarks, as the user stated it
  /// @throws InputError findings of the file
  void add_robot(std::string_view text, const urdf::MeshFolders& folders, const std::string& name);
  /// The body that arms are mounted on: the root link kBaseLink.
  void add_base(const std::string& name, const BaseBody& base);
  /// An arm whose root link is fixed to the base.
  /// @throws InputError findings of the file
  /// @throws AssemblyError names that are taken, no such hand link
  void add_arm(std::string_view text, const urdf::MeshFolders& folders, const MountedArm& arm);
  /// Mass, inertia and shapes of the root link of add_robot(), which has no mass of its own.
  /// @throws AssemblyError it has
  void load_root(const BaseBody& base);

  const urdf::Tree& tree() const { return tree_; }
  const std::vector<urdf::TreeJoint>& joints() const { return tree_.joints; }
  /// The full name of a joint: itself, or with the prefix of the only arm that has it.
  /// @throws AssemblyError there is none, or several arms have it
  std::string joint_named(const std::string& name) const;

  /// A joint keeps its position, and so do those that follow it: links merge into their parents.
  /// @throws AssemblyError no such joint, fixed already, follows another one, outside its limits
  void lock(const std::string& joint, double position);
  /// @throws AssemblyError no such joint, limits that contradict each other
  void limit(const std::string& joint, const JointLimits& limits);
  /// The drive of a joint, instead of the file's.
  /// @throws AssemblyError no such joint, fixed
  void drive(const std::string& joint, const JointRotor& rotor);

  /// The full names of a link of an SRDF file: itself, or with the prefix of each arm that has it.
  std::vector<std::string> links_named(const std::string& name) const;

  /// Whether anything differs from the file of add_robot(): parts, locks, limits, hulls.
  bool is_changed() const { return is_changed_; }
  /// The text of add_robot() where nothing differs from it.
  std::string text() const { return is_changed_ ? urdf::urdf_text(tree_) : file_text_; }
  /// The hand of the first arm that names one; empty: none does.
  const std::string& hand() const { return hand_; }
  /// Of all files, with the names that they were added under.
  const std::vector<Finding>& remarks() const { return remarks_; }

 private:
  urdf::Tree read(std::string_view text, const urdf::MeshFolders& folders, const std::string& name);
  urdf::TreeJoint& find(const std::string& name);

  CollisionMeshes collision_;
  urdf::Tree tree_;
  std::vector<std::string> prefixes_;
  std::string file_text_, hand_;
  std::vector<Finding> remarks_;
  bool is_changed_ = false;
};

}  // namespace stillbase
