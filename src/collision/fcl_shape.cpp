#include "collision/fcl_shape.hpp"

#include <algorithm>
#include <cassert>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "collision/closed_forms.hpp"
#include "collision/convex_gap.hpp"

namespace stillbase {

class FclShape {
 public:
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;
  std::optional<Vector3d> half;  ///< half edges of a box, m
  Geometry shape;
};

namespace {

struct Convert {
  using Result = std::shared_ptr<const fcl::CollisionGeometryd>;
  Result operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Result operator()(const Capsule& c) const {
    return std::make_shared<fcl::Capsuled>(c.radius, c.length);
  }
  Result operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Result operator()(const Box& b) const { return std::make_shared<fcl::Boxd>(b.size); }
  // fcl::Convex wants the faces as one list: count, indices, count, indices, ...
  Result operator()(const ConvexMesh& m) const {
    auto vertices = std::make_shared<std::vector<Vector3d>>(m.vertices);
    auto faces = std::make_shared<std::vector<int>>();
    for (const std::vector<int>& face : m.faces) {
      faces->push_back(static_cast<int>(face.size()));
      faces->insert(faces->end(), face.begin(), face.end());
    }
    return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(m.faces.size()), faces);
  }
};

fcl::Transform3d transform(const Matrix3d& R, const Vector3d& p) {
  fcl::Transform3d T;
  T.linear() = R;
  T.translation() = p;
  T.makeAffine();
  return T;
}

// Unsigned on purpose: the signed distance of this release stops the process for some poses.
// 1e-9: with the default of 1e-6 box against box is off by millimetres.
fcl::DistanceResultd query(const FclShape& a, const Matrix3d& R_a, const Vector3d& p_a,
                           const FclShape& b, const Matrix3d& R_b, const Vector3d& p_b) {
  assert(R_a.allFinite() && p_a.allFinite() && R_b.allFinite() && p_b.allFinite());
  const fcl::DistanceRequestd request(true, false, 0.0, 0.0, 1e-9, fcl::GST_LIBCCD);
  fcl::DistanceResultd result;
  fcl::distance(a.geometry.get(), transform(R_a, p_a), b.geometry.get(), transform(R_b, p_b),
                request, result);
  return result;
}

}  // namespace

std::shared_ptr<const FclShape> make_fcl_shape(const Geometry& geometry) {
  auto shape = std::make_shared<FclShape>();
  shape->geometry = std::visit(Convert{}, geometry);
  shape->shape = geometry;
  if (const auto* box = std::get_if<Box>(&geometry)) shape->half = box->size / 2;
  return shape;
}

double fcl_distance(const FclShape& a, const Matrix3d& R_a, const Vector3d& p_a, const FclShape& b,
                    const Matrix3d& R_b, const Vector3d& p_b) {
  constexpr double kError = 1e-6;  // m
  const fcl::DistanceResultd result = query(a, R_a, p_a, b, R_b, p_b);
  const double found = std::max(result.min_distance, 0.0);
  if (!(found > 0)) return found;
  const PlacedGeometry shape_a{a.shape, R_a, p_a}, shape_b{b.shape, R_b, p_b};
  const Vector3d apart = result.nearest_points[0] - result.nearest_points[1];
  const double length = apart.norm();
  const Vector3d from = length > kError ? Vector3d(apart / length) : Vector3d::UnitX();
  if (found <= gap_along(shape_a, shape_b, from) + kError) return found;
  if (!a.half || !b.half) return std::min(found, std::max(convex_gap(shape_a, shape_b, from), 0.0));
  const PlacedBox box_a{*a.half, R_a, p_a}, box_b{*b.half, R_b, p_b};
  const double gap = widest_gap(box_a, box_b);
  if (found <= gap + kError) return found;
  const double exact = gap > 0 ? separate_box_distance(box_a, box_b) : 0;
  return found <= exact + kError ? found : exact;
}

std::optional<PointPair> fcl_nearest_points(const FclShape& a, const Matrix3d& R_a,
                                            const Vector3d& p_a, const FclShape& b,
                                            const Matrix3d& R_b, const Vector3d& p_b) {
  const fcl::DistanceResultd result = query(a, R_a, p_a, b, R_b, p_b);
  if (!(result.min_distance > 0)) return std::nullopt;
  return PointPair{result.nearest_points[0], result.nearest_points[1]};
}

}  // namespace stillbase
