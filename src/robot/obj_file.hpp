// Wavefront OBJ files.
#pragma once

#include <string_view>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Reads the vertices (v) and the faces (f) of an OBJ file, polygons as triangles; all else is left
/// out: names, normals, materials, lines, colours of vertices, curves. A negative number in a face
/// counts back from the last vertex before it. Vertices that no face names are none of the mesh.
/// @throws std::runtime_error what is wrong, with its line
Mesh read_obj(std::string_view text);

}  // namespace stillbase
