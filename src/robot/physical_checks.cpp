#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/robot/physical_checks.hpp>

namespace stillbase {

std::string inertia_fault(const Matrix3d& inertia, double rounding, bool may_be_thin) {
  if (!inertia.allFinite()) return "the inertia tensor is not finite";
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() >
      1e-12 * inertia.cwiseAbs().maxCoeff()) {
    return "the inertia tensor is not symmetric";
  }
  const Vector3d moments = principal_moments(inertia);
  const std::string principal = fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m^2",
                                            moments[0], moments[1], moments[2]);
  // Below 1e-12 of the largest a moment is rounding, not a number of the file.
  const double negligible = 1e-12 * std::abs(moments[2]);
  if (may_be_thin ? moments[0] < -negligible : moments[0] <= negligible) {
    return fmt::format("the inertia tensor is not positive definite: {}", principal);
  }
  const double sum = moments[0] + moments[1];
  if (moments[2] > sum * (1 + 1e-5) + std::min(rounding, 0.05 * moments[2])) {
    return fmt::format(
        "the inertia tensor breaks the triangle inequality ({:.6g} + {:.6g} < {:.6g}): {}",
        moments[0], moments[1], moments[2], principal);
  }
  return "";
}

std::string mass_fault(double mass) {
  if (std::isfinite(mass) && mass > 0) return "";
  return fmt::format("the mass is {:g} kg, must be greater than 0", mass);
}

std::string convex_mesh_fault(const ConvexMesh& mesh) {
  const int vertices = static_cast<int>(mesh.vertices.size());
  if (vertices < 4 || mesh.faces.size() < 4) {
    return "a convex mesh needs at least 4 vertices and 4 faces";
  }
  double size = 0;
  for (const Vector3d& v : mesh.vertices) size = std::max(size, (v - mesh.vertices[0]).norm());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::vector<int>& face = mesh.faces[f];
    if (face.size() < 3) return fmt::format("face {} has fewer than 3 corners", f);
    for (const int corner : face) {
      if (corner < 0 || corner >= vertices) {
        return fmt::format("face {} names vertex {}; there are {}", f, corner, vertices);
      }
    }
    const Vector3d& origin = mesh.vertices[face[0]];
    const Vector3d normal =
        (mesh.vertices[face[1]] - origin).cross(mesh.vertices[face[2]] - origin).normalized();
    for (const Vector3d& v : mesh.vertices) {
      if (!(normal.dot(v - origin) <= 1e-6 * size)) {
        return fmt::format(
            "a vertex lies outside of face {} (corners counter-clockwise seen from outside?)", f);
      }
    }
  }
  return "";
}

}  // namespace stillbase
