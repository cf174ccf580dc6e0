// What is drawn of a robot instead of its collision shapes: the <visual> of its links.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/mesh_file.hpp"
#include "robot/mesh_shapes.hpp"

namespace stillbase::urdf {

/// No point of what is drawn is further than this from the frame of its link, m.
inline constexpr double kFarthestDrawn = 1e4;

struct VisualShape {
  std::string link;                  ///< of the file
  Pose pose;                         ///< in the link
  std::optional<Vector3d> color;     ///< red, green, blue from 0 to 1
  std::optional<Geometry> geometry;  ///< empty: a mesh
  std::size_t mesh = 0;              ///< index into Visuals::meshes
  Vector3d scale = Vector3d::Ones();
};

struct Visuals {
  std::vector<VisualShape> shapes;
  std::vector<Mesh> meshes;  ///< m before `scale`; each file once, thinned
};

/// Reads the shapes that a robot file has for drawings, and the meshes that it names.
///
/// Nothing here is refused, since no physics depends on it: what is not there, cannot be read or is
/// too large is left out with a remark. Mesh files are read up to kMaxMeshBytes together.
/// @param text of a file that read_robot() takes
/// @param most triangles of each mesh
Visuals read_visual_shapes(std::string_view text, const MeshFolders& folders, std::size_t most,
                           Findings& findings);

}  // namespace stillbase::urdf
