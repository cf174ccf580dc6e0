// What pages draw of a robot instead of its collision shapes, from the files that it came from.
#pragma once

#include <string>
#include <vector>

#include <stillbase/io/plan_file.hpp>

#include "io/json.hpp"

namespace stillbase::app {

/// A robot file that a drawing is made from.
struct RobotFile {
  std::string path;
  std::string prefix = {};                     ///< of its links' names in the model
  std::vector<std::string> package_path = {};  ///< folders of packages of meshes
};

/// The robot files of a problem file.
std::vector<RobotFile> robot_files(const CaptureProblem& problem, const std::string& problem_path);

/// Those of a plan, when they are where the plan says or beside it and what it was made from.
std::vector<RobotFile> robot_files(const PlanFile& file, const std::string& plan_path);

/// `visuals` of robot_scene(): the <visual> of the files' links. Null: there are none. What is left
/// out of them is said on stderr. Together the meshes have at most 10000 triangles: an eighth of a
/// megabyte, and 10 ms of a frame that a processor draws.
///
/// {meshes: [{closed, low, step, vertices, triangles}], shapes: [{body, link, pose, color, and
/// geometry, or mesh and scale}]}. Vertices are low + step * [i, j, k]; i, j, k and the corners of
/// the triangles are 16-bit numbers, lowest byte first, in base64. Both sides of a mesh that is not
/// `closed` are seen.
io::Json visuals_json(const RobotModel& robot, const std::vector<RobotFile>& files);

}  // namespace stillbase::app
