#include "robot/polygons.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "robot/mesh_text.hpp"

namespace stillbase {

namespace {

/// Half a second: a polygon of n corners takes n^2 steps, an unusual one n^3.
constexpr std::size_t kMostEarSteps = 100'000'000;

}  // namespace

void PolygonDivider::add(const std::vector<int>& corners) {
  if (corners.size() == 3) return add(corners[0], corners[1], corners[2]);
  if (corners.size() < 3) return;
  const auto vertex = [&](std::size_t i) -> const Vector3d& {
    return mesh_.vertices[static_cast<std::size_t>(corners[i])];
  };
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    normal += (vertex(i - 1) - vertex(0)).cross(vertex(i) - vertex(0));
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const bool is_seen_from_behind = normal[axis] < 0;
  std::vector<Corner> polygon;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double x = vertex(i)[(axis + 1) % 3], y = vertex(i)[(axis + 2) % 3];
    polygon.push_back(is_seen_from_behind ? Corner{corners[i], y, x} : Corner{corners[i], x, y});
  }
  bool is_convex = true;
  for (std::size_t i = 0; i < polygon.size() && is_convex; ++i) {
    const std::size_t n = polygon.size();
    is_convex = !(turn(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) < 0);
  }
  if (is_convex) {
    add_fan(polygon);
  } else {
    cut_ears(std::move(polygon));
  }
}

void PolygonDivider::add(int a, int b, int c) {
  mesh_.triangles.push_back({a, b, c});
  check_triangle_count(mesh_.triangles.size());
}

void PolygonDivider::add_fan(const std::vector<Corner>& polygon) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    add(polygon[0].vertex, polygon[i - 1].vertex, polygon[i].vertex);
  }
}

/// Each ear is looked for behind the one before.
void PolygonDivider::cut_ears(std::vector<Corner> polygon) {
  std::size_t i = 0;
  for (std::size_t tried = 0; polygon.size() > 3 && tried < polygon.size();) {
    if (steps_ > kMostEarSteps) break;
    i %= polygon.size();
    if (!is_ear(polygon, i)) {
      ++i;
      ++tried;
      continue;
    }
    const std::size_t n = polygon.size();
    add(polygon[(i + n - 1) % n].vertex, polygon[i].vertex, polygon[(i + 1) % n].vertex);
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
    tried = 0;
  }
  add_fan(polygon);
}

/// Whether the triangle of a corner and its neighbours lies in the polygon.
bool PolygonDivider::is_ear(const std::vector<Corner>& polygon, std::size_t i) {
  const std::size_t n = polygon.size(), before = (i + n - 1) % n, after = (i + 1) % n;
  const Corner &a = polygon[before], &b = polygon[i], &c = polygon[after];
  const double here = turn(a, b, c);
  if (!(here > 0)) return here == 0;  // on a straight edge: a triangle without area
  steps_ += n;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == before || k == i || k == after) continue;
    const Corner& p = polygon[k];
    // Outlines with a slit to a hole visit corners twice.
    if (p.vertex == a.vertex || p.vertex == b.vertex || p.vertex == c.vertex) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

double PolygonDivider::turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

}  // namespace stillbase
