// The collision meshes of a tree as convex hulls.
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <stillbase/robot/assembled_robot.hpp>

#include "robot/mesh_file.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase::urdf {

/// No vertex of a collision mesh is farther from its origin along an axis, m. Single precision,
/// which most mesh files hold, tells points apart to 1 mm there; no spacecraft is larger.
inline constexpr double kFarthestVertex = 1e4;
/// The longest edge of the box around a collision mesh is no shorter, m.
inline constexpr double kSmallestMesh = 1e-6;

/// Where the meshes of a robot file are looked for.
struct MeshFolders {
  std::string robot_file;             ///< path of the robot file
  std::vector<std::string> packages;  ///< folders that hold packages, in this order
};

/// A mesh that lies where the file may not point to. what() says why.
struct PathError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The file of a mesh, by the name in a robot file: package://, file:// or a path.
/// @return empty: it is not there
/// @throws PathError there is one, outside of the robot's package, or links that go in circles
std::filesystem::path find_mesh(const std::string& name, const MeshFolders& folders);

/// Folders of ROS_PACKAGE_PATH.
std::vector<std::string> ros_package_path();

/// Puts folders before those of ROS_PACKAGE_PATH in the environment of this process and of those
/// that it starts; not while other threads read the environment.
/// @param folders without colons, relative to the current folder
void put_before_ros_package_path(const std::vector<std::string>& folders);

/// Reads the mesh files of one robot. When one has reached a limit of read_mesh(), no other is
/// read: a robot of many such files would take as many times as long.
class MeshReader {
 public:
  /// @throws std::runtime_error as read_mesh(), or an earlier file has reached a limit
  Mesh read(const std::string& path);

 private:
  bool has_met_limit_ = false;
};

/// Meshes of one robot, each file read once.
class MeshFiles {
 public:
  /// @throws std::runtime_error what MeshReader says of the file, each time
  const Mesh& read(const std::string& path);

 private:
  struct File {
    Mesh mesh;
    std::string fault;  ///< empty: it is read
  };
  MeshReader reader_;
  std::map<std::string, File> files_;
};

/// Reads the meshes of all <collision> that have no hull yet and puts hulls around them, or around
/// the parts of concave ones.
///
/// A mesh that is not there is a remark, one that cannot be read or lies outside of the robot's
/// package a finding, both at its line. A file of several uses is read once.
/// @return whether there is any hull
bool enclose_meshes(Tree& tree, const MeshFolders& folders, CollisionMeshes collision,
                    Findings& findings);

}  // namespace stillbase::urdf
