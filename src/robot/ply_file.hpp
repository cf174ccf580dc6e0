// PLY files. Assimp's reader of them follows broken headers out of its memory and without end.
#pragma once

#include <string_view>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Reads the vertices (x, y, z) and the faces (vertex_indices or vertex_index) of a PLY file, ascii
/// or binary, and skips the rest. Polygons become triangles.
/// @throws std::runtime_error what is wrong, with the line of an ascii file
Mesh read_ply(std::string_view text);

}  // namespace stillbase
