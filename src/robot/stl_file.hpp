// STL files.
#pragma once

#include <string_view>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Reads the triangles of an STL file, ascii or binary, of all its solids. Their normals are left
/// out: the order of the corners says where outside is. A file is binary when its length is what
/// its header states, whatever it begins with.
/// @throws std::runtime_error what is wrong, with the line of an ascii file
Mesh read_stl(std::string_view text);

}  // namespace stillbase
