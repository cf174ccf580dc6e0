#include "collision/closed_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include <stillbase/core/constants.hpp>

namespace stillbase {

namespace {

/// Square of the distance of p from the segment from a to a + d.
double point_segment_square(const Vector3d& p, const Vector3d& a, const Vector3d& d) {
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp(d.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * d).squaredNorm();
}

/// One function per kind of shape.
template <class... F>
struct Cases : F... {
  using F::operator()...;
};
template <class... F>
Cases(F...) -> Cases<F...>;

}  // namespace

// The nearest points are either inside both segments (where the lines come closest) or one of them
// is an end; the smallest of the five cases is the distance, whatever the conditioning.
double segment_distance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                        const Vector3d& b1) {
  const Vector3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
  double square =
      std::min(std::min(point_segment_square(a0, b0, v), point_segment_square(a1, b0, v)),
               std::min(point_segment_square(b0, a0, u), point_segment_square(b1, a0, u)));
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const double uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-14 * uu * vv) {
    const double s = (uv * vw - vv * uw) / determinant;
    const double t = (uu * vw - uv * uw) / determinant;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      square = std::min(square, (w + s * u - t * v).squaredNorm());
    }
  }
  return std::sqrt(square);
}

double round_distance(const RoundSegment& a, const RoundSegment& b) {
  return segment_distance(a.a, a.b, b.a, b.b) - a.radius - b.radius;
}

// The square of the distance from the box is convex along the segment, and a parabola between the
// places where the segment enters or leaves a slab of the box. These places close in on the
// parabola that has the minimum.
double round_box_distance(const RoundSegment& round, const PlacedBox& box) {
  const Vector3d a = box.R.transpose() * (round.a - box.p);
  const Vector3d d = box.R.transpose() * (round.b - round.a);
  const auto apart = [&](double t) -> Vector3d {
    const Vector3d x = a + t * d;
    return x - x.cwiseMax(-box.half).cwiseMin(box.half);
  };
  const auto slope = [&](double t) { return apart(t).dot(d); };
  double low = 0, high = 1;
  double slope_low = slope(low), slope_high = slope(high);
  if (slope_low >= 0) return apart(low).norm() - round.radius;
  if (slope_high <= 0) return apart(high).norm() - round.radius;
  for (int i = 0; i < 3; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double t = (side * box.half[i] - a[i]) / d[i];
      if (!(t > low && t < high)) continue;
      const double here = slope(t);
      (here > 0 ? high : low) = t;
      (here > 0 ? slope_high : slope_low) = here;
    }
  }
  const double t = low + (high - low) * slope_low / (slope_low - slope_high);
  return apart(t).norm() - round.radius;
}

double widest_gap(const PlacedBox& a, const PlacedBox& b) {
  const Vector3d apart = b.p - a.p;
  double widest = -kInfinity;
  const auto try_axis = [&](const Vector3d& axis) {
    const double length = axis.norm();
    if (length < 1e-9) return;  // parallel edges: their normals are among the faces'
    const double halves = a.half.dot((a.R.transpose() * axis).cwiseAbs()) +
                          b.half.dot((b.R.transpose() * axis).cwiseAbs());
    widest = std::max(widest, (std::abs(axis.dot(apart)) - halves) / length);
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(a.R.col(i));
    try_axis(b.R.col(i));
    for (int j = 0; j < 3; ++j) try_axis(a.R.col(i).cross(b.R.col(j)));
  }
  return widest;
}

double separate_box_distance(const PlacedBox& a, const PlacedBox& b) {
  using Corners = std::array<Vector3d, 8>;
  const auto corners_of = [](const PlacedBox& box) {
    Corners corners;
    for (unsigned i = 0; i < 8; ++i) {
      const Vector3d sign((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
      corners[i] = box.p + box.R * sign.cwiseProduct(box.half);
    }
    return corners;
  };
  const auto to_corners = [](const PlacedBox& box, const Corners& corners) {
    double least = kInfinity;
    for (const Vector3d& corner : corners) {
      const Vector3d in_box = box.R.transpose() * (corner - box.p);
      least = std::min(least, (in_box.cwiseAbs() - box.half).cwiseMax(0).norm());
    }
    return least;
  };
  const Corners of_a = corners_of(a), of_b = corners_of(b);
  double least = std::min(to_corners(a, of_b), to_corners(b, of_a));
  const auto each_edge = [](const auto& use) {
    for (unsigned i = 0; i < 8; ++i) {
      for (const unsigned bit : {1U, 2U, 4U}) {
        if ((i & bit) == 0) use(i, i | bit);
      }
    }
  };
  each_edge([&](unsigned i, unsigned j) {
    each_edge([&](unsigned k, unsigned l) {
      least = std::min(least, segment_distance(of_a[i], of_a[j], of_b[k], of_b[l]));
    });
  });
  return least;
}

std::optional<RoundSegment> round_segment(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    return RoundSegment{Vector3d::Zero(), Vector3d::Zero(), sphere->radius};
  }
  if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
    const Vector3d half(0, 0, capsule->length / 2);
    return RoundSegment{-half, half, capsule->radius};
  }
  return std::nullopt;
}

double point_distance(const Geometry& geometry, const Vector3d& point) {
  const auto to_capsule = [&](double radius, double length) {
    const Vector3d half(0, 0, length / 2);
    return std::max(std::sqrt(point_segment_square(point, -half, 2 * half)) - radius, 0.0);
  };
  return std::visit(
      Cases{[&](const Sphere& s) { return to_capsule(s.radius, 0); },
            [&](const Capsule& c) { return to_capsule(c.radius, c.length); },
            [&](const Cylinder& c) {
              return std::hypot(std::max(point.head<2>().norm() - c.radius, 0.0),
                                std::max(std::abs(point.z()) - c.length / 2, 0.0));
            },
            [&](const Box& b) { return (point.cwiseAbs() - b.size / 2).cwiseMax(0.0).norm(); },
            [&](const ConvexMesh& mesh) {
              double distance = 0;
              for (const std::vector<int>& face : mesh.faces) {
                const Vector3d& a = mesh.vertices[face[0]];
                const Vector3d& b = mesh.vertices[face[1]];
                const Vector3d& c = mesh.vertices[face[2]];
                const Vector3d normal = (b - a).cross(c - a).normalized();
                distance = std::max(distance, normal.dot(point - a));
              }
              return distance;
            }},
      geometry);
}

BoundingSphere bounding_sphere(const Geometry& geometry) {
  const Vector3d origin = Vector3d::Zero();
  return std::visit(Cases{[&](const Sphere& s) {
                            return BoundingSphere{origin, s.radius};
                          },
                          [&](const Capsule& c) {
                            return BoundingSphere{origin, c.length / 2 + c.radius};
                          },
                          [&](const Cylinder& c) {
                            return BoundingSphere{origin, std::hypot(c.radius, c.length / 2)};
                          },
                          [&](const Box& b) {
                            return BoundingSphere{origin, b.size.norm() / 2};
                          },
                          [&](const ConvexMesh& mesh) {
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
                          }},
                    geometry);
}

BoundingBox bounding_box(const Geometry& geometry) {
  const auto about_origin = [](double x, double y, double z) {
    return BoundingBox{Vector3d::Zero(), {x, y, z}};
  };
  return std::visit(
      Cases{[&](const Sphere& s) { return about_origin(s.radius, s.radius, s.radius); },
            [&](const Capsule& c) {
              return about_origin(c.radius, c.radius, c.length / 2 + c.radius);
            },
            [&](const Cylinder& c) { return about_origin(c.radius, c.radius, c.length / 2); },
            [&](const Box& b) {
              return BoundingBox{Vector3d::Zero(), b.size / 2};
            },
            [&](const ConvexMesh& mesh) {
              Vector3d lower = mesh.vertices.front(), upper = lower;
              for (const Vector3d& v : mesh.vertices) {
                lower = lower.cwiseMin(v);
                upper = upper.cwiseMax(v);
              }
              return BoundingBox{(lower + upper) / 2, (upper - lower) / 2};
            }},
      geometry);
}

double box_gap(const PlacedBox& a, const PlacedBox& b) {
  const Matrix3d turn = a.R.transpose() * b.R, sizes = turn.cwiseAbs();
  const Vector3d apart = b.p - a.p;
  const Vector3d along_a = a.R.transpose() * apart, along_b = b.R.transpose() * apart;
  const Vector3d gap_a = along_a.cwiseAbs() - a.half - sizes * b.half;
  const Vector3d gap_b = along_b.cwiseAbs() - b.half - sizes.transpose() * a.half;
  return std::sqrt(std::max(gap_a.cwiseMax(0.0).squaredNorm(), gap_b.cwiseMax(0.0).squaredNorm()));
}

bool is_valid(const Geometry& geometry) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  return std::visit(
      Cases{[&](const Sphere& s) { return positive(s.radius); },
            [&](const Capsule& c) {
              return positive(c.radius) && (positive(c.length) || c.length == 0);
            },
            [&](const Cylinder& c) { return positive(c.radius) && positive(c.length); },
            [&](const Box& b) { return b.size.allFinite() && b.size.minCoeff() > 0; },
            [&](const ConvexMesh& mesh) {
              const int count = static_cast<int>(mesh.vertices.size());
              return count >= 4 && mesh.faces.size() >= 4 &&
                     std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                 [](const Vector3d& v) { return v.allFinite(); }) &&
                     std::all_of(mesh.faces.begin(), mesh.faces.end(),
                                 [&](const std::vector<int>& face) {
                                   return face.size() >= 3 &&
                                          std::all_of(face.begin(), face.end(),
                                                      [&](int i) { return i >= 0 && i < count; });
                                 });
            }},
      geometry);
}

}  // namespace stillbase
