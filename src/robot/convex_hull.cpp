#include "robot/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <stillbase/robot/physical_checks.hpp>

namespace stillbase {

namespace {

/// A plane with all points on its inner side: normal . x <= offset.
struct Plane {
  Vector3d normal;
  double offset;
};

/// A triangle of a convex hull: corners counter-clockwise seen from outside.
struct Triangle {
  std::vector<int> corners;
  Plane plane;
};

/// Points in a plane or on a line have no hull with a volume.
struct FlatPointsError : std::invalid_argument {
  FlatPointsError() : std::invalid_argument("the points lie in a plane") {}
};

/// What Qhull holds, and where its messages go: nowhere.
class QhullMemory {
 public:
  QhullMemory() { qh_zero(&qh_, messages_); }
  QhullMemory(const QhullMemory&) = delete;
  QhullMemory& operator=(const QhullMemory&) = delete;
  ~QhullMemory() {
    qh_freeqhull(&qh_, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(&qh_, &blocks, &bytes);
    if (messages_ != nullptr) std::fclose(messages_);
  }
  qhT* get() { return &qh_; }
  std::FILE* messages() { return messages_; }

 private:
  qhT qh_{};
  std::FILE* messages_ = std::fopen("/dev/null", "w");
};

/// The triangles of the convex hull. @throws FlatPointsError
std::vector<Triangle> hull_triangles(std::vector<Vector3d> points) {
  QhullMemory memory;
  qhT* const qh = memory.get();
  char command[] = "qhull Qt";
  if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), points.front().data(), False, command,
                   nullptr, memory.messages()) != qh_ERRnone) {
    throw FlatPointsError();
  }
  std::vector<Triangle> triangles;
  for (const facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr;
       facet = facet->next) {
    Triangle triangle;
    for (void** v = &facet->vertices->e[0].p; *v != nullptr; ++v) {
      triangle.corners.push_back(qh_pointid(qh, static_cast<const vertexT*>(*v)->point));
    }
    const coordT* const n = facet->normal;
    triangle.plane = {{n[0], n[1], n[2]}, -facet->offset};
    const Vector3d& a = points[static_cast<std::size_t>(triangle.corners[0])];
    const Vector3d& b = points[static_cast<std::size_t>(triangle.corners[1])];
    const Vector3d& c = points[static_cast<std::size_t>(triangle.corners[2])];
    if ((b - a).cross(c - a).dot(triangle.plane.normal) < 0) {
      std::swap(triangle.corners[1], triangle.corners[2]);
    }
    triangles.push_back(std::move(triangle));
  }
  return triangles;
}

/// The convex hull of points as a mesh of its own vertices.
ConvexMesh hull_mesh(const std::vector<Vector3d>& points, double& volume) {
  ConvexMesh mesh;
  std::vector<int> number(points.size(), -1);
  volume = 0;
  for (const Triangle& triangle : hull_triangles(points)) {
    std::vector<int> face;
    for (const int corner : triangle.corners) {
      int& index = number[static_cast<std::size_t>(corner)];
      if (index < 0) {
        index = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(points[static_cast<std::size_t>(corner)]);
      }
      face.push_back(index);
    }
    const Vector3d& a = mesh.vertices[static_cast<std::size_t>(face[0])];
    const Vector3d& b = mesh.vertices[static_cast<std::size_t>(face[1])];
    const Vector3d& c = mesh.vertices[static_cast<std::size_t>(face[2])];
    volume += a.dot(b.cross(c)) / 6;
    mesh.faces.push_back(std::move(face));
  }
  return mesh;
}

/// Where a set of points ends in a direction.
struct Support {
  std::size_t point;  ///< index
  double offset;      ///< of the touching plane
};

Support support_of(const std::vector<Vector3d>& points, const Vector3d& normal) {
  Support support{0, normal.dot(points.front())};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double value = normal.dot(points[i]);
    if (value > support.offset) support = {i, value};
  }
  return support;
}

/// Points that lie at the ends along the axes and diagonals of the box.
std::vector<std::size_t> end_points(const std::vector<Vector3d>& points) {
  std::vector<std::size_t> chosen;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int sides = std::abs(x) + std::abs(y) + std::abs(z);
        if (sides != 1 && sides != 3) continue;
        const std::size_t i = support_of(points, Vector3d(x, y, z)).point;
        if (std::find(chosen.begin(), chosen.end(), i) == chosen.end()) chosen.push_back(i);
      }
    }
  }
  return chosen;
}

/// Of many points those that are farthest from the middle, one for each of the cells in which rays
/// from there leave a cube. Enough to choose corners from.
std::vector<Vector3d> outer_points(const std::vector<Vector3d>& points) {
  constexpr std::size_t kFew = 20000;
  constexpr int kCells = 32;  // along an edge: 6144 cells, a hundred for each corner of a hull
  if (points.size() <= kFew) return points;
  std::vector<const Vector3d*> farthest(std::size_t{6} * kCells * kCells, nullptr);
  for (const Vector3d& point : points) {
    Eigen::Index axis = 0;
    const double along = point.cwiseAbs().maxCoeff(&axis);
    if (!(along > 0)) continue;
    const auto cell = [&](Eigen::Index i) {
      return std::clamp(static_cast<int>((point[i] / along + 1) / 2 * kCells), 0, kCells - 1);
    };
    const int side = 2 * static_cast<int>(axis) + (point[axis] > 0 ? 1 : 0);
    const int index = (side * kCells + cell((axis + 1) % 3)) * kCells + cell((axis + 2) % 3);
    const Vector3d*& kept = farthest[static_cast<std::size_t>(index)];
    if (kept == nullptr || point.squaredNorm() > kept->squaredNorm()) kept = &point;
  }
  std::vector<Vector3d> outer;
  for (const Vector3d* point : farthest) {
    if (point != nullptr) outer.push_back(*point);
  }
  return outer;
}

/// The farthest that a corner moves when a polytope is made larger by a factor, m.
double excess(const std::vector<Vector3d>& corners, const Vector3d& centre, const Vector3d& half,
              double scale) {
  double most = 0;
  for (const Vector3d& corner : corners) {
    most = std::max(most, (corner - centre).cwiseProduct(half).norm());
  }
  return (scale - 1) * most;
}

/// A polytope of few of the points, made larger about its centre until it holds them all. Worked
/// in the coordinates of the box, so that long bodies are not made longer than they are thick.
/// @throws FlatPointsError
EnclosingHull enlarged_hull(const std::vector<Vector3d>& points, const Vector3d& middle,
                            const Vector3d& half, const HullOptions& options) {
  std::vector<Vector3d> unit;
  unit.reserve(points.size());
  for (const Vector3d& point : points) unit.push_back((point - middle).cwiseQuotient(half));
  const std::vector<Vector3d> outer = outer_points(unit);
  std::vector<std::size_t> chosen = end_points(outer);
  std::vector<Vector3d> corners;
  Vector3d centre = Vector3d::Zero();
  for (const std::size_t i : chosen) {
    corners.push_back(outer[i]);
    centre += outer[i] / static_cast<double>(chosen.size());
  }
  std::map<std::vector<int>, Support> supports;  // of the triangles so far, by their corners
  const double size = 2 * half.norm();
  for (;;) {
    double scale = 1;
    std::size_t next = chosen.front();
    for (const Triangle& triangle : hull_triangles(corners)) {
      const auto [support, is_new] = supports.try_emplace(triangle.corners);
      if (is_new) support->second = support_of(outer, triangle.plane.normal);
      const double inside = triangle.plane.normal.dot(centre);
      const double ratio = (support->second.offset - inside) / (triangle.plane.offset - inside);
      if (!(ratio > scale)) continue;
      scale = ratio;
      next = support->second.point;
    }
    const bool is_known = std::find(chosen.begin(), chosen.end(), next) != chosen.end();
    if (is_known || excess(corners, centre, half, scale) <= options.distance * size ||
        static_cast<int>(chosen.size()) >= options.max_vertices) {
      break;
    }
    chosen.push_back(next);
    corners.push_back(outer[next]);
  }
  double scale = 1;
  for (const Triangle& triangle : hull_triangles(corners)) {
    const double inside = triangle.plane.normal.dot(centre);
    scale = std::max(scale, (support_of(unit, triangle.plane.normal).offset - inside) /
                                (triangle.plane.offset - inside));
  }
  const double distance = excess(corners, centre, half, scale);
  for (Vector3d& corner : corners) {
    corner = centre + scale * (1 + 1e-9) * (corner - centre);
    corner = middle + corner.cwiseProduct(half);
  }
  EnclosingHull hull;
  hull.mesh = hull_mesh(corners, hull.volume);
  hull.distance = distance;
  return hull;
}

struct BoxOfPoints {
  Vector3d middle, half;  ///< half: of its edges
  double size;            ///< its diagonal
};

/// @throws std::invalid_argument there are no points, or all are the same
BoxOfPoints box_of(const std::vector<Vector3d>& points) {
  if (points.empty()) throw std::invalid_argument("there are no points");
  Vector3d lower = points.front(), upper = points.front();
  for (const Vector3d& point : points) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  const double size = (upper - lower).norm();
  if (!(size > 0) || !std::isfinite(size)) {
    throw std::invalid_argument("all points are the same, or they are not finite");
  }
  return {(lower + upper) / 2, (upper - lower) / 2, size};
}

constexpr double kThickness = 1e-4;  ///< of points in a plane, relative to their size

/// The hull of the points, or a polytope around it where that has too many vertices.
EnclosingHull polytope(const std::vector<Vector3d>& points, const BoxOfPoints& box,
                       const HullOptions& options) {
  // Beyond this number the hull of all points is not worth its time: nearly all of them may be
  // vertices of it.
  constexpr std::size_t kMostForAll = 20000;
  try {
    EnclosingHull hull;
    if (points.size() <= kMostForAll) {
      hull.mesh = hull_mesh(points, hull.volume);
      if (static_cast<int>(hull.mesh.vertices.size()) <= options.max_vertices) return hull;
    }
    return enlarged_hull(points, box.middle, box.half, options);
  } catch (const FlatPointsError&) {
    const double thickness = kThickness * box.size;
    std::vector<Vector3d> thick;
    thick.reserve(6 * points.size());
    for (const Vector3d& point : points) {
      for (int axis = 0; axis < 3; ++axis) {
        thick.push_back(point + thickness * Vector3d::Unit(axis));
        thick.push_back(point - thickness * Vector3d::Unit(axis));
      }
    }
    EnclosingHull hull = enlarged_hull(thick, box.middle, box.half.array() + thickness, options);
    hull.distance += thickness;
    return hull;
  }
}

}  // namespace

EnclosingHull enclosing_hull(const std::vector<Vector3d>& points, const HullOptions& options) {
  const BoxOfPoints box = box_of(points);
  EnclosingHull hull = polytope(points, box, options);
  if (convex_mesh_fault(hull.mesh).empty()) return hull;
  // Points whose distances differ by many powers of ten have a hull with faces so narrow that
  // rounding decides where they look. A polytope of few far points has none.
  try {
    hull = enlarged_hull(points, box.middle, box.half.cwiseMax(kThickness * box.size), options);
    if (convex_mesh_fault(hull.mesh).empty()) return hull;
  } catch (const FlatPointsError&) {  // so does the box
  }
  std::vector<Vector3d> corners;
  const Vector3d half = (1 + 1e-9) * box.half.cwiseMax(kThickness * box.size);
  for (int i = 0; i < 8; ++i) {
    const auto side = [&](int axis) { return (i >> axis) % 2 == 0 ? -half[axis] : half[axis]; };
    corners.push_back(box.middle + Vector3d(side(0), side(1), side(2)));
  }
  hull.mesh = hull_mesh(corners, hull.volume);
  hull.distance = 2 * half.norm();
  return hull;
}

EnclosingHull exact_hull(const std::vector<Vector3d>& points) {
  return polytope(points, box_of(points), {.max_vertices = std::numeric_limits<int>::max()});
}

}  // namespace stillbase
