// Meshes with fewer triangles, to be looked at.
#pragma once

#include <vector>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// A mesh of at most `most` triangles: vertices in one cell of a cubic grid become one, at their
/// mean, and triangles that lose a corner go. The grid is the finest that leaves so few; where all
/// may stay it has 65535 cells along the longest side, which joins the equal corners of STL files.
/// Vertices that no triangle uses go, too.
/// @pre the vertices are finite, the indices those of vertices
Mesh thinned(const Mesh& mesh, std::size_t most);

/// Thins meshes until they have `most` triangles together: the small ones keep all, the others the
/// same number.
void thin_together(std::vector<Mesh>& meshes, std::size_t most);

}  // namespace stillbase
