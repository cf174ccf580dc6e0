#include "verification/worst_direction.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/core/rotation.hpp>

namespace stillbase::verification {
namespace {

/// A direction by its angle from n and its azimuth (unused in a wedge).
struct ConePoint {
  double angle = 0, azimuth = 0;
  double value = 0;
};

}  // namespace

Vector3d cone_direction(const Vector3d& n, const std::optional<Vector3d>& plane_normal,
                        double angle, double azimuth) {
  if (plane_normal) return rotation_exp(angle * *plane_normal) * n;
  const Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  return std::cos(angle) * n + std::sin(angle) * (std::cos(azimuth) * e1 + std::sin(azimuth) * e2);
}

WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples) {
  auto direction = [&](const ConePoint& p) {
    return cone_direction(n, plane_normal, p.angle, p.azimuth);
  };
  const double lowest_angle = plane_normal ? -half_angle : 0.0;
  auto at = [&](double angle, double azimuth) {
    ConePoint p{std::clamp(angle, lowest_angle, half_angle), azimuth, 0};
    p.value = value(direction(p));
    return p;
  };

  std::vector<ConePoint> grid{at(0, 0)};
  double angle_step = half_angle, azimuth_step = 0;
  if (half_angle > 0 && plane_normal) {
    const int count = std::max(samples, 3);
    angle_step = 2 * half_angle / (count - 1);
    for (int i = 0; i < count; ++i) grid.push_back(at(-half_angle + i * angle_step, 0));
  } else if (half_angle > 0) {
    // Six times as many azimuths as rings: the spacing on the rim is that between the rings.
    const int rings = std::max(2, static_cast<int>(std::sqrt(samples / 6.0)));
    angle_step = half_angle / rings;
    azimuth_step = 2 * kPi / (6 * rings);
    for (int i = 1; i <= rings; ++i) {
      for (int j = 0; j < 6 * rings; ++j) grid.push_back(at(i * angle_step, j * azimuth_step));
    }
  }

  // Compass search in (angle, azimuth) from the best samples: in these coordinates the rim is a
  // bound on one of them, and the search slides along it.
  const std::size_t kept = std::min<std::size_t>(8, grid.size());
  std::partial_sort(grid.begin(), grid.begin() + static_cast<std::ptrdiff_t>(kept), grid.end(),
                    [](const ConePoint& a, const ConePoint& b) { return a.value > b.value; });
  ConePoint best = grid.front();
  for (std::size_t i = 0; i < kept && half_angle > 0; ++i) {
    ConePoint p = grid[i];
    double scale = 1;
    while (scale > 1e-6) {
      ConePoint better = p;
      for (const double sign : {-1.0, 1.0}) {
        const ConePoint a = at(p.angle + sign * scale * angle_step, p.azimuth);
        if (a.value > better.value) better = a;
        if (azimuth_step == 0) continue;
        const ConePoint b = at(p.angle, p.azimuth + sign * scale * azimuth_step);
        if (b.value > better.value) better = b;
      }
      if (better.value > p.value) {
        p = better;
      } else {
        scale /= 2;
      }
    }
    if (p.value > best.value) best = p;
  }
  return {best.value, direction(best)};
}

}  // namespace stillbase::verification
