// Meshes of files: STL, OBJ, COLLADA, glTF, PLY.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Largest mesh file and largest number of its triangles.
inline constexpr std::size_t kMaxMeshBytes = 256u << 20;
inline constexpr std::size_t kMaxMeshTriangles = 4'000'000;

/// A mesh file took more time or memory than any should. what() says how much.
struct MeshLimitError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Mesh {
  std::vector<Vector3d> vertices;             ///< m
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
};

/// Why a file of shapes is not read although nothing is wrong with it: its format, or Git LFS has
/// put a pointer in its place. Empty: read_mesh() reads it, or says what is wrong.
std::string why_unread(const std::string& path);

/// Reads a mesh. The unit of a COLLADA file is applied, its up axis is not: robot files are written
/// for readers that leave it out.
/// @throws std::runtime_error what is wrong with the file, without its name; MeshLimitError
Mesh read_mesh(const std::string& path);

/// The same of a file's text that is read without Assimp.
/// @param ending .stl, .obj or .ply
Mesh read_mesh_text(std::string_view text, const std::string& ending);

/// Volume that closed triangles enclose, m^3; 0 when they leave gaps.
double enclosed_volume(const Mesh& mesh);

}  // namespace stillbase
