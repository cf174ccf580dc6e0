// A mesh of a file that gives every triangle three vertices of its own.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Grows by vertices and triangles. Of a mesh of many triangles the vertices that are equal become
/// one, which takes a sixth of the memory; those of others all stay apart.
class JoinedMesh {
 public:
  /// @param triangles about how many there will be
  explicit JoinedMesh(std::size_t triangles);

  /// The number of a vertex: of one that is equal, or a new one.
  int vertex(const Vector3d& vertex);
  /// @param triangle numbers of vertices
  /// @throws std::runtime_error more than kMaxMeshTriangles
  void add(const std::array<int, 3>& triangle);

  Mesh take() { return std::move(mesh_); }
  /// Through the table so far, which bounds the time.
  std::size_t steps() const { return steps_; }

 private:
  int append(const Vector3d& vertex);
  int& place_of(const Vector3d& vertex);
  void grow();

  Mesh mesh_;
  std::vector<int> table_;  ///< numbers of vertices by their hash; empty: all stay apart
  std::size_t asked_ = 0, steps_ = 0;
};

}  // namespace stillbase
