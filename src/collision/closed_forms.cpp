#include "collision/closed_forms.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace stillbase {

namespace {

double point_segment_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp(d.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

bool positive(double x) { return std::isfinite(x) && x > 0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0; }

}  // namespace

// The nearest points are either inside both segments (where the lines come closest) or one of them
// is an end; the smallest of the five cases is the distance, whatever the conditioning.
double segment_distance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                        const Vector3d& b1) {
  double distance =
      std::min(std::min(point_segment_distance(a0, b0, b1), point_segment_distance(a1, b0, b1)),
               std::min(point_segment_distance(b0, a0, a1), point_segment_distance(b1, a0, a1)));
  const Vector3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const double uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-14 * uu * vv) {
    const double s = (uv * vw - vv * uw) / determinant;
    const double t = (uu * vw - uv * uw) / determinant;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      distance = std::min(distance, (w + s * u - t * v).norm());
    }
  }
  return distance;
}

double round_distance(const RoundSegment& a, const RoundSegment& b) {
  return segment_distance(a.a, a.b, b.a, b.b) - a.radius - b.radius;
}

bool as_round_segment(const Geometry& geometry, RoundSegment& round) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    round = {Vector3d::Zero(), Vector3d::Zero(), sphere->radius};
    return true;
  }
  if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
    const Vector3d half = Vector3d(0, 0, capsule->length / 2);
    round = {-half, half, capsule->radius};
    return true;
  }
  return false;
}

double point_distance(const Geometry& geometry, const Vector3d& point) {
  RoundSegment round;
  if (as_round_segment(geometry, round)) {
    return std::max(point_segment_distance(point, round.a, round.b) - round.radius, 0.0);
  }
  if (const auto* box = std::get_if<Box>(&geometry)) {
    return (point.cwiseAbs() - box->size / 2).cwiseMax(0.0).norm();
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
    const double radial = std::max(point.head<2>().norm() - cylinder->radius, 0.0);
    const double axial = std::max(std::abs(point.z()) - cylinder->length / 2, 0.0);
    return std::hypot(radial, axial);
  }
  const auto& mesh = std::get<ConvexMesh>(geometry);
  double distance = 0;
  for (const std::vector<int>& face : mesh.faces) {
    const Vector3d& a = mesh.vertices[static_cast<std::size_t>(face[0])];
    const Vector3d& b = mesh.vertices[static_cast<std::size_t>(face[1])];
    const Vector3d& c = mesh.vertices[static_cast<std::size_t>(face[2])];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    distance = std::max(distance, normal.dot(point - a));
  }
  return distance;
}

BoundingSphere bounding_sphere(const Geometry& geometry) {
  RoundSegment round;
  if (as_round_segment(geometry, round)) {
    return {Vector3d::Zero(), round.b.norm() + round.radius};
  }
  if (const auto* box = std::get_if<Box>(&geometry)) {
    return {Vector3d::Zero(), box->size.norm() / 2};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
    return {Vector3d::Zero(), std::hypot(cylinder->radius, cylinder->length / 2)};
  }
  const auto& mesh = std::get<ConvexMesh>(geometry);
  Vector3d lower = mesh.vertices.front(), upper = lower;
  for (const Vector3d& v : mesh.vertices) {
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
  }
  BoundingSphere sphere{(lower + upper) / 2, 0};
  for (const Vector3d& v : mesh.vertices) {
    sphere.radius = std::max(sphere.radius, (v - sphere.centre).norm());
  }
  return sphere;
}

bool is_valid(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return positive(sphere->radius);
  if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
    return positive(capsule->radius) && not_negative(capsule->length);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
    return positive(cylinder->radius) && positive(cylinder->length);
  }
  if (const auto* box = std::get_if<Box>(&geometry)) {
    return positive(box->size.x()) && positive(box->size.y()) && positive(box->size.z());
  }
  const auto& mesh = std::get<ConvexMesh>(geometry);
  const int count = static_cast<int>(mesh.vertices.size());
  if (count < 4 || mesh.faces.size() < 4) return false;
  for (const Vector3d& v : mesh.vertices) {
    if (!v.allFinite()) return false;
  }
  for (const std::vector<int>& face : mesh.faces) {
    if (face.size() < 3) return false;
    for (const int i : face) {
      if (i < 0 || i >= count) return false;
    }
  }
  return true;
}

}  // namespace stillbase
