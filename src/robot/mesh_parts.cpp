#include "robot/mesh_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <stillbase/core/constants.hpp>

#include "robot/mesh_thinning.hpp"

namespace stillbase {

namespace {

/// Triangles of the copy that decides: a hull of its vertices takes half a millisecond.
constexpr std::size_t kTrianglesToDecide = 1000;
/// Parts with more than this of the volume of the mesh's own hull are not worth their number.
constexpr double kMostOfHull = 0.9;
/// Vertices as near to a plane as this lie in it, relative to the mesh's size.
constexpr double kInPlane = 1e-9;

/// normal . x = offset; outside is where it is larger.
struct CutPlane {
  Vector3d normal;
  double offset;
  double height(const Vector3d& x) const { return normal.dot(x) - offset; }
};

Vector3d corner(const Mesh& mesh, const std::array<int, 3>& triangle, std::size_t c) {
  return mesh.vertices[static_cast<std::size_t>(triangle[c])];
}

/// Twice the area, along the normal.
Vector3d area_vector(const Mesh& mesh, const std::array<int, 3>& triangle) {
  const Vector3d a = corner(mesh, triangle, 0);
  return (corner(mesh, triangle, 1) - a).cross(corner(mesh, triangle, 2) - a);
}

double size_of(const std::vector<Vector3d>& points) {
  Vector3d lower = points.front(), upper = lower;
  for (const Vector3d& point : points) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  return (upper - lower).norm();
}

/// One side of a cut, which grows by triangles.
class Side {
 public:
  explicit Side(const Mesh& whole) : whole_(whole), number_(whole.vertices.size(), -1) {}
  int vertex(int of_whole) {
    int& number = number_[static_cast<std::size_t>(of_whole)];
    if (number < 0) {
      number = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(whole_.vertices[static_cast<std::size_t>(of_whole)]);
    }
    return number;
  }
  /// The vertex where the plane cuts an edge.
  int vertex(const std::pair<int, int>& edge, const Vector3d& point) {
    const auto [known, is_new] = cuts_.try_emplace(edge, static_cast<int>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(point);
    return known->second;
  }
  /// A convex polygon, in its order.
  void add(const std::vector<int>& polygon) {
    for (std::size_t c = 2; c < polygon.size(); ++c) {
      mesh.triangles.push_back({polygon[0], polygon[c - 1], polygon[c]});
    }
  }

  Mesh mesh;

 private:
  const Mesh& whole_;
  std::vector<int> number_;
  std::map<std::pair<int, int>, int> cuts_;
};

Vector3d point_in_plane(const Mesh& mesh, const std::vector<double>& height,
                        const std::pair<int, int>& edge) {
  const auto a = static_cast<std::size_t>(edge.first), b = static_cast<std::size_t>(edge.second);
  const double along = height[a] / (height[a] - height[b]);
  return mesh.vertices[a] + along * (mesh.vertices[b] - mesh.vertices[a]);
}

/// The triangles of a mesh inside and outside of a plane; those that it cuts are divided. What lies
/// in the plane counts as inside.
std::pair<Mesh, Mesh> cut(const Mesh& mesh, const CutPlane& plane, double in_plane) {
  std::vector<double> height;
  height.reserve(mesh.vertices.size());
  for (const Vector3d& vertex : mesh.vertices) {
    const double h = plane.height(vertex);
    height.push_back(std::abs(h) <= in_plane ? 0 : h);
  }
  Side inside(mesh), outside(mesh);
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto h = [&](std::size_t c) { return height[static_cast<std::size_t>(triangle[c % 3])]; };
    const double highest = std::max({h(0), h(1), h(2)}), lowest = std::min({h(0), h(1), h(2)});
    std::vector<int> below, above;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = triangle[c], b = triangle[(c + 1) % 3];
      if (highest <= 0 || (lowest < 0 && h(c) <= 0)) below.push_back(inside.vertex(a));
      if (highest > 0 && h(c) >= 0) above.push_back(outside.vertex(a));
      if (h(c) * h(c + 1) < 0) {
        const std::pair<int, int> edge(std::min(a, b), std::max(a, b));
        const Vector3d point = point_in_plane(mesh, height, edge);
        below.push_back(inside.vertex(edge, point));
        above.push_back(outside.vertex(edge, point));
      }
    }
    inside.add(below);
    outside.add(above);
  }
  return {std::move(inside.mesh), std::move(outside.mesh)};
}

/// How deep a mesh lies in a convex polytope around it at the most, m; by points of its triangles,
/// since the vertices of a prism all lie on its hull.
double deepest(const Mesh& mesh, const ConvexMesh& hull) {
  constexpr int kDivisions = 4;  // of each edge
  std::vector<CutPlane> faces;
  for (const std::vector<int>& face : hull.faces) {
    const auto at = [&](std::size_t c) { return hull.vertices[static_cast<std::size_t>(face[c])]; };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized();
    if (!normal.isZero(0)) faces.push_back({normal, normal.dot(at(0))});
  }
  double most = 0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const Vector3d a = corner(mesh, triangle, 0);
    const Vector3d along = (corner(mesh, triangle, 1) - a) / kDivisions;
    const Vector3d across = (corner(mesh, triangle, 2) - a) / kDivisions;
    for (int i = 0; i <= kDivisions; ++i) {
      for (int j = 0; i + j <= kDivisions; ++j) {
        const Vector3d point = a + i * along + j * across;
        double depth = kInfinity;
        for (const CutPlane& face : faces) {
          depth = std::min(depth, -face.height(point));
          if (depth <= most) break;
        }
        most = std::max(most, depth);
      }
    }
  }
  return most;
}

/// Directions across which a mesh is cut: its axes, the normals of its largest faces, its principal
/// axes; none within 15 degrees of an earlier one, except across large faces.
std::vector<Vector3d> cut_directions(const Mesh& mesh) {
  constexpr double kAlike = 0.966, kSameFace = 0.9999;
  constexpr std::size_t kMostFaces = 64, kLargeFaces = 3;
  std::vector<Vector3d> directions{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  const auto add = [&](const Vector3d& direction, double alike) {
    const bool is_new =
        std::none_of(directions.begin(), directions.end(),
                     [&](const Vector3d& known) { return std::abs(known.dot(direction)) > alike; });
    if (is_new) directions.push_back(direction);
  };
  std::vector<std::pair<double, Vector3d>> faces;  // area and normal
  Vector3d mean = Vector3d::Zero();
  double area = 0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const Vector3d vector = area_vector(mesh, triangle);
    const Vector3d normal = vector.stableNormalized();
    if (normal.isZero(0)) continue;
    const auto known = std::find_if(faces.begin(), faces.end(), [&](const auto& face) {
      return std::abs(face.second.dot(normal)) > kSameFace;
    });
    if (known != faces.end()) {
      known->first += vector.norm();
    } else if (faces.size() < kMostFaces) {
      faces.emplace_back(vector.norm(), normal);
    }
    for (std::size_t c = 0; c < 3; ++c) mean += vector.norm() / 3 * corner(mesh, triangle, c);
    area += vector.norm();
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < std::min(faces.size(), kLargeFaces); ++i) {
    add(faces[i].second, kSameFace);
  }
  if (!(area > 0)) return directions;
  mean /= area;
  Matrix3d spread = Matrix3d::Zero();
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector3d arm = corner(mesh, triangle, c) - mean;
      spread += area_vector(mesh, triangle).norm() * arm * arm.transpose();
    }
  }
  const Matrix3d axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors();
  for (int k = 0; k < 3; ++k) add(axes.col(k), kAlike);
  return directions;
}

/// Where planes across a direction may cut: in large faces and at even divisions.
std::vector<double> cut_offsets(const Mesh& mesh, const Vector3d& direction) {
  constexpr int kDivisions = 6;
  constexpr std::size_t kFaces = 4;
  double low = kInfinity, high = -kInfinity;
  for (const Vector3d& vertex : mesh.vertices) {
    low = std::min(low, direction.dot(vertex));
    high = std::max(high, direction.dot(vertex));
  }
  const double extent = high - low;
  std::vector<std::pair<double, double>> faces;  // area and offset
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const Vector3d vector = area_vector(mesh, triangle);
    if (!(std::abs(vector.dot(direction)) > 0.999 * vector.norm())) continue;
    const double offset = direction.dot(corner(mesh, triangle, 0));
    if (offset - low < 0.01 * extent || high - offset < 0.01 * extent) continue;
    const auto known = std::find_if(faces.begin(), faces.end(), [&](const auto& face) {
      return std::abs(face.second - offset) < 0.01 * extent;
    });
    if (known != faces.end()) {
      known->first += vector.norm();
    } else {
      faces.emplace_back(vector.norm(), offset);
    }
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> offsets;
  for (std::size_t i = 0; i < std::min(faces.size(), kFaces); ++i) {
    offsets.push_back(faces[i].second);
  }
  for (int k = 1; k < kDivisions; ++k) offsets.push_back(low + extent * k / kDivisions);
  return offsets;
}

/// A cell of the copy that decides.
struct Piece {
  Mesh mesh;
  EnclosingHull hull;
  double depth;  ///< m
  int node;      ///< of the tree
};

/// A plane that divides, or a leaf: the cell belongs to a part.
struct Node {
  CutPlane plane{};
  int inside = -1, outside = -1;
  int part = -1;
};

/// Divides the copy of a mesh and joins what was divided for nothing.
class Division {
 public:
  Division(const Mesh& mesh, const PartsOptions& options)
      : options_(options), size_(size_of(mesh.vertices)), directions_(cut_directions(mesh)) {
    nodes_.emplace_back();
    pieces_.push_back(piece_of(mesh, 0));
    volume_ = pieces_.front().hull.volume;
    divide();
    join();
  }
  const std::vector<Node>& nodes() const { return nodes_; }
  int num_parts() const { return num_parts_; }

 private:
  static Piece piece_of(Mesh mesh, int node) {
    EnclosingHull hull = exact_hull(mesh.vertices);
    const double depth = deepest(mesh, hull.mesh);
    return {std::move(mesh), std::move(hull), depth, node};
  }

  /// The cut that leaves the least volume in the hulls of both sides.
  std::optional<CutPlane> best_cut(const Piece& piece) const {
    constexpr double kWorthOfHalving = 0.02;  // of the volume: decides among nearly equal cuts
    std::optional<CutPlane> best;
    double least = kInfinity;
    for (const Vector3d& direction : directions_) {
      for (const double offset : cut_offsets(piece.mesh, direction)) {
        const CutPlane plane{direction, offset};
        const auto [inside, outside] = cut(piece.mesh, plane, kInPlane * size_);
        if (!has_size(inside) || !has_size(outside)) continue;
        const double a = exact_hull(inside.vertices).volume;
        const double b = exact_hull(outside.vertices).volume;
        const double cost = a + b + kWorthOfHalving * std::abs(a - b);
        if (cost < least * (1 - 1e-9)) {
          least = cost;
          best = plane;
        }
      }
    }
    return best;
  }

  bool has_size(const Mesh& mesh) const {
    return !mesh.triangles.empty() && size_of(mesh.vertices) > 1e-6 * size_;
  }

  void divide() {
    const auto most = 2 * static_cast<std::size_t>(options_.max_parts);
    while (pieces_.size() < most) {
      const auto deepest_one =
          std::max_element(pieces_.begin(), pieces_.end(),
                           [](const Piece& a, const Piece& b) { return a.depth < b.depth; });
      if (deepest_one->depth <= options_.depth * size_) return;
      const auto plane = best_cut(*deepest_one);
      if (!plane) {
        deepest_one->depth = 0;  // it cannot be divided
        continue;
      }
      auto [inside, outside] = cut(deepest_one->mesh, *plane, kInPlane * size_);
      const auto parent = static_cast<std::size_t>(deepest_one->node);
      nodes_[parent].plane = *plane;
      nodes_[parent].inside = static_cast<int>(nodes_.size());
      nodes_[parent].outside = static_cast<int>(nodes_.size()) + 1;
      *deepest_one = piece_of(std::move(inside), nodes_[parent].inside);
      pieces_.push_back(piece_of(std::move(outside), nodes_[parent].outside));
      nodes_.resize(nodes_.size() + 2);
    }
  }

  /// What of the copy becomes one part.
  struct Part {
    std::vector<Vector3d> vertices;
    double volume;
    std::vector<int> nodes;
  };

  static Part joined(const Part& a, const Part& b) {
    Part part = a;
    part.vertices.insert(part.vertices.end(), b.vertices.begin(), b.vertices.end());
    part.nodes.insert(part.nodes.end(), b.nodes.begin(), b.nodes.end());
    const EnclosingHull hull = exact_hull(part.vertices);
    part.vertices = hull.mesh.vertices;
    part.volume = hull.volume;
    return part;
  }

  void join() {
    std::vector<Part> parts;
    for (const Piece& piece : pieces_) {
      parts.push_back({piece.hull.mesh.vertices, piece.hull.volume, {piece.node}});
    }
    std::map<std::pair<std::size_t, std::size_t>, Part> unions;  // of parts a < b
    while (parts.size() > 1) {
      auto cheapest = unions.end();
      double least = kInfinity;
      for (std::size_t b = 1; b < parts.size(); ++b) {
        for (std::size_t a = 0; a < b; ++a) {
          auto pair = unions.find({a, b});
          if (pair == unions.end()) {
            pair = unions.emplace(std::pair(a, b), joined(parts[a], parts[b])).first;
          }
          const double cost = pair->second.volume - parts[a].volume - parts[b].volume;
          if (cost < least) {
            least = cost;
            cheapest = pair;
          }
        }
      }
      const bool are_too_many = static_cast<int>(parts.size()) > options_.max_parts;
      if (!are_too_many && least > options_.worth * volume_) break;
      const auto [a, b] = cheapest->first;
      parts[a] = std::move(cheapest->second);
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(b));
      renumber(unions, a, b);
    }
    num_parts_ = static_cast<int>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (const int node : parts[i].nodes) {
        nodes_[static_cast<std::size_t>(node)].part = static_cast<int>(i);
      }
    }
  }

  /// Parts a and b became one at a; those after b moved up.
  static void renumber(std::map<std::pair<std::size_t, std::size_t>, Part>& unions, std::size_t a,
                       std::size_t b) {
    std::map<std::pair<std::size_t, std::size_t>, Part> left;
    for (auto& [pair, part] : unions) {
      auto [first, second] = pair;
      if (first == a || second == a || first == b || second == b) continue;
      if (first > b) --first;
      if (second > b) --second;
      left.emplace(std::pair(first, second), std::move(part));
    }
    unions = std::move(left);
  }

  PartsOptions options_;
  double size_;
  std::vector<Vector3d> directions_;
  std::vector<Piece> pieces_;
  std::vector<Node> nodes_;
  double volume_ = 0;
  int num_parts_ = 0;
};

/// How often triangles wind around a point: 1 inside of closed ones, 0 outside. The solid angles of
/// the triangles, by van Oosterom and Strackee.
double winding_number(const Mesh& mesh, const Vector3d& point) {
  double angle = 0;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const Vector3d a = corner(mesh, triangle, 0) - point;
    const Vector3d b = corner(mesh, triangle, 1) - point;
    const Vector3d c = corner(mesh, triangle, 2) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * kPi);
}

/// A plane on the way to a cell, and whether the cell lies outside of it.
struct Wall {
  CutPlane plane;
  bool is_outside;
};

/// The corners of a cell that lie inside of the mesh. Those alone may be missing in the hull of
/// what the triangles leave in it.
void add_inner_corners(const std::vector<Wall>& walls, const Mesh& mesh, double in_plane,
                       std::vector<Vector3d>& points) {
  for (std::size_t i = 2; i < walls.size(); ++i) {
    for (std::size_t j = 1; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        Matrix3d normals;
        normals << walls[i].plane.normal.transpose(), walls[j].plane.normal.transpose(),
            walls[k].plane.normal.transpose();
        if (std::abs(normals.determinant()) < 1e-6) continue;
        const Vector3d offsets(walls[i].plane.offset, walls[j].plane.offset, walls[k].plane.offset);
        const Vector3d point = normals.partialPivLu().solve(offsets);
        const bool is_corner = std::all_of(walls.begin(), walls.end(), [&](const Wall& wall) {
          const double height = wall.plane.height(point);
          return (wall.is_outside ? -height : height) <= in_plane;
        });
        if (is_corner && std::abs(winding_number(mesh, point)) > 0.25) points.push_back(point);
      }
    }
  }
}

/// Shares a mesh out to the parts of a division.
class Sharing {
 public:
  Sharing(const Division& division, const Mesh& decided)
      : division_(division),
        decided_(decided),
        in_plane_(kInPlane * size_of(decided.vertices)),
        points_(static_cast<std::size_t>(division.num_parts())) {}

  void share(const Mesh& mesh, int node) {
    const Node& here = division_.nodes()[static_cast<std::size_t>(node)];
    if (here.part >= 0) {
      std::vector<Vector3d>& points = points_[static_cast<std::size_t>(here.part)];
      points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end());
      add_inner_corners(walls_, decided_, in_plane_, points);
      return;
    }
    const auto [inside, outside] = cut(mesh, here.plane, in_plane_);
    walls_.push_back({here.plane, false});
    share(inside, here.inside);
    walls_.back().is_outside = true;
    share(outside, here.outside);
    walls_.pop_back();
  }

  const std::vector<std::vector<Vector3d>>& points() const { return points_; }

 private:
  const Division& division_;
  const Mesh& decided_;
  double in_plane_;
  std::vector<Wall> walls_;
  std::vector<std::vector<Vector3d>> points_;  // by part
};

}  // namespace

std::vector<EnclosingHull> convex_parts(const Mesh& mesh, const PartsOptions& options) {
  const EnclosingHull whole = enclosing_hull(mesh.vertices);
  const Mesh decided = thinned(mesh, kTrianglesToDecide);
  if (decided.triangles.empty()) return {whole};
  const Division division(decided, options);
  if (division.num_parts() == 1) return {whole};
  Sharing sharing(division, decided);
  sharing.share(mesh, 0);
  std::vector<EnclosingHull> parts;
  double volume = 0;
  for (const std::vector<Vector3d>& points : sharing.points()) {
    if (points.empty() || !(size_of(points) > 0)) continue;
    parts.push_back(enclosing_hull(points, options.hull));
    volume += parts.back().volume;
  }
  if (!(volume < kMostOfHull * whole.volume)) return {whole};
  return parts;
}

}  // namespace stillbase
