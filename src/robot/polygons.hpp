// Polygons of mesh files as triangles.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Divides the polygons of a mesh into triangles that lie in them: a convex one into a fan from its
/// first corner, another one by cutting off its ears. Where a polygon has none, since it crosses
/// itself, the rest of it becomes a fan.
class PolygonDivider {
 public:
  /// @param mesh whose triangles grow
  explicit PolygonDivider(Mesh& mesh) : mesh_(mesh) {}

  /// @param corners in their order, numbers of vertices that are there; fewer than three enclose
  /// nothing
  /// @throws std::runtime_error more than kMaxMeshTriangles
  void add(const std::vector<int>& corners);

 private:
  struct Corner {
    int vertex;
    double x, y;  ///< in the plane along axes that the polygon is seen in, counter-clockwise
  };

  void add(int a, int b, int c);
  void add_fan(const std::vector<Corner>& polygon);
  void cut_ears(std::vector<Corner> polygon);
  bool is_ear(const std::vector<Corner>& polygon, std::size_t i);
  static double turn(const Corner& a, const Corner& b, const Corner& c);

  Mesh& mesh_;
  std::size_t steps_ = 0;  ///< of looking for corners in ears, in all polygons
};

}  // namespace stillbase
