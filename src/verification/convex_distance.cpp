#include "verification/convex_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillbase::verification {
namespace {

/// When the search for the distance of two shapes ends.
struct ConvexDistanceOptions {
  double gap = 1e-10;       ///< m, between the bounds
  double touching = 1e-12;  ///< m: closer than rounding of places some metres away
  int steps = 200;          ///< flat shapes take ten, rims of cylinders some more
  double flat = 1e-13;      ///< part of an edge that leaves the plane of others by rounding alone
};
constexpr ConvexDistanceOptions kConvex;

/// The point of a shape's core that lies furthest along d, in the shape's frame. The core of a
/// sphere is its centre, that of a capsule its axis; other shapes are their own.
struct FurthestPoint {
  const Vector3d& d;

  Vector3d operator()(const Sphere&) const { return Vector3d::Zero(); }
  Vector3d operator()(const Capsule& c) const { return {0, 0, std::copysign(c.length / 2, d.z())}; }
  Vector3d operator()(const Cylinder& c) const {
    const double across = std::hypot(d.x(), d.y());
    const double scale = across > 0 ? c.radius / across : 0;
    return {scale * d.x(), scale * d.y(), std::copysign(c.length / 2, d.z())};
  }
  Vector3d operator()(const Box& b) const {
    return {std::copysign(b.size.x() / 2, d.x()), std::copysign(b.size.y() / 2, d.y()),
            std::copysign(b.size.z() / 2, d.z())};
  }
  Vector3d operator()(const ConvexMesh& m) const {
    const Vector3d* furthest = &m.vertices.front();
    double most = d.dot(*furthest);
    for (const Vector3d& vertex : m.vertices) {
      const double along = d.dot(vertex);
      if (along > most) {
        most = along;
        furthest = &vertex;
      }
    }
    return *furthest;
  }
};

Vector3d furthest_point(const PlacedShape& shape, const Vector3d& direction) {
  const Vector3d d = shape.R.transpose() * direction;
  return shape.R * std::visit(FurthestPoint{d}, *shape.geometry) + shape.p;
}

/// By how much the shape is larger than its core.
double rounding_radius(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return sphere->radius;
  if (const auto* capsule = std::get_if<Capsule>(&geometry)) return capsule->radius;
  return 0;
}

/// Up to four points of A - B.
struct Simplex {
  std::array<Vector3d, 4> points;
  int count = 0;

  bool holds(const Vector3d& point) const {
    return std::find(points.begin(), points.begin() + count, point) != points.begin() + count;
  }
};

/// The point nearest to the origin in the plane (line, space) through some points.
struct NearestPoint {
  Vector3d point;
  bool is_inside = false;  ///< between those points
};

/// x = p0 + sum t_i e_i with e_i = p_i - p0 and x normal to every e_i: the normal equations in
/// orthonormal directions (Gram and Schmidt), which a flat simplex leaves well conditioned.
NearestPoint nearest_of_span(const std::array<const Vector3d*, 4>& p, int count) {
  const int edges = count - 1;
  std::array<Vector3d, 3> q;
  Matrix3d r = Matrix3d::Zero();
  for (int i = 0; i < edges; ++i) {
    const Vector3d e = *p[i + 1] - *p[0];
    q[i] = e;
    for (int pass = 0; pass < 2; ++pass) {
      for (int j = 0; j < i; ++j) {
        const double along = q[j].dot(q[i]);
        r(j, i) += along;
        q[i] -= along * q[j];
      }
    }
    r(i, i) = q[i].norm();
    if (!(r(i, i) > kConvex.flat * e.norm())) return {};
    q[i] /= r(i, i);
  }
  std::array<double, 3> t{};
  NearestPoint nearest{*p[0], false};
  for (int i = 0; i < edges; ++i) {
    t[i] = -q[i].dot(*p[0]);
    nearest.point += t[i] * q[i];
  }
  double sum = 0;
  bool inside = true;
  for (int i = edges - 1; i >= 0; --i) {
    for (int j = i + 1; j < edges; ++j) t[i] -= r(i, j) * t[j];
    t[i] /= r(i, i);
    sum += t[i];
    inside = inside && t[i] >= 0;
  }
  nearest.is_inside = inside && sum <= 1;
  return nearest;
}

/// Replaces the simplex by those of its points whose hull holds the point nearest to the origin,
/// which is returned: the best of all subsets.
Vector3d reduce(Simplex& simplex) {
  double least = kInfinity;
  Vector3d best = Vector3d::Zero();
  unsigned kept = 0;
  for (unsigned subset = 1; subset < 1U << simplex.count; ++subset) {
    std::array<const Vector3d*, 4> p{};
    int count = 0;
    for (int i = 0; i < simplex.count; ++i) {
      if ((subset >> i & 1U) != 0) p[count++] = &simplex.points[i];
    }
    const NearestPoint nearest = nearest_of_span(p, count);
    if (!nearest.is_inside) continue;
    const double norm = count == 4 ? 0 : nearest.point.norm();
    if (norm >= least) continue;
    least = norm;
    best = count == 4 ? Vector3d::Zero() : nearest.point;
    kept = subset;
  }
  int count = 0;
  for (int i = 0; i < simplex.count; ++i) {
    if ((kept >> i & 1U) != 0) simplex.points[count++] = simplex.points[i];
  }
  simplex.count = count;
  return best;
}

struct BallAround {
  Ball operator()(const Sphere& s) const { return {Vector3d::Zero(), s.radius}; }
  Ball operator()(const Capsule& c) const { return {Vector3d::Zero(), c.radius + c.length / 2}; }
  Ball operator()(const Cylinder& c) const {
    return {Vector3d::Zero(), std::hypot(c.radius, c.length / 2)};
  }
  Ball operator()(const Box& b) const { return {Vector3d::Zero(), b.size.norm() / 2}; }
  Ball operator()(const ConvexMesh& m) const {
    Ball ball;
    for (const Vector3d& v : m.vertices) ball.centre += v / static_cast<double>(m.vertices.size());
    for (const Vector3d& v : m.vertices)
      ball.radius = std::max(ball.radius, (v - ball.centre).norm());
    return ball;
  }
};

}  // namespace

Ball ball_around(const Geometry& geometry) { return std::visit(BallAround{}, geometry); }

DistanceBounds convex_distance(const PlacedShape& a, const PlacedShape& b, double enough) {
  const double radii = rounding_radius(*a.geometry) + rounding_radius(*b.geometry);
  Simplex simplex;
  Vector3d v = a.p - b.p;
  if (v.norm() < kConvex.touching) v = Vector3d::UnitX();
  DistanceBounds core{-kInfinity, kInfinity};
  for (int step = 0; step < kConvex.steps; ++step) {
    const Vector3d w = furthest_point(a, -v) - furthest_point(b, v);
    core.lower = std::max(core.lower, v.dot(w) / v.norm());
    if (core.lower - radii >= enough || core.upper - core.lower <= kConvex.gap) break;
    if (simplex.holds(w)) break;
    simplex.points[simplex.count++] = w;
    const Vector3d nearer = reduce(simplex);
    const double norm = nearer.norm();
    if (norm >= core.upper) break;
    core.upper = norm;
    v = nearer;
    if (norm < kConvex.touching) return {-radii - kConvex.touching, -radii - kConvex.touching};
  }
  return {core.lower - radii, std::max(core.lower, core.upper) - radii};
}

}  // namespace stillbase::verification
