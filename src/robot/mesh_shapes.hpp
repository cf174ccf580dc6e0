// The collision meshes of a tree as convex hulls.
#pragma once

#include <string>
#include <vector>

#include "robot/urdf_tree.hpp"

namespace stillbase::urdf {

/// Where the meshes of a robot file are looked for.
struct MeshFolders {
  std::string robot_file;             ///< path of the robot file
  std::vector<std::string> packages;  ///< folders that hold packages, in this order
};

/// Folders of ROS_PACKAGE_PATH.
std::vector<std::string> ros_package_path();

/// Reads the meshes of all <collision> that have no hull yet and puts hulls around them.
///
/// A mesh that is not there is a remark, one that cannot be read or lies outside of the robot's
/// package a finding, both at its line. A file of several uses is read once.
/// @return whether there is any hull
bool enclose_meshes(Tree& tree, const MeshFolders& folders, Findings& findings);

}  // namespace stillbase::urdf
