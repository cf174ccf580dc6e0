#include "verification/worst_direction.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/core/rotation.hpp>

namespace stillbase::verification {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

// Coordinates of a direction: angle from n, and azimuth (unused in a wedge).
struct Point {
  double angle = 0, azimuth = 0;
  double value = 0;
};

}  // namespace

WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples) {
  const Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  auto direction = [&](const Point& p) -> Vector3d {
    if (plane_normal) return rotation_exp(p.angle * *plane_normal) * n;
    return std::cos(p.angle) * n +
           std::sin(p.angle) * (std::cos(p.azimuth) * e1 + std::sin(p.azimuth) * e2);
  };
  const double lowest_angle = plane_normal ? -half_angle : 0.0;
  auto at = [&](double angle, double azimuth) {
    Point p{std::clamp(angle, lowest_angle, half_angle), azimuth, 0};
    p.value = value(direction(p));
    return p;
  };

  std::vector<Point> grid{at(0, 0)};
  double angle_step = half_angle, azimuth_step = 0;
  if (half_angle > 0 && plane_normal) {
    const int count = std::max(samples, 3);
    angle_step = 2 * half_angle / (count - 1);
    for (int i = 0; i < count; ++i) grid.push_back(at(-half_angle + i * angle_step, 0));
  } else if (half_angle > 0) {
    // Six times as many azimuths as rings: the spacing on the rim is that between the rings.
    const int rings = std::max(2, static_cast<int>(std::sqrt(samples / 6.0)));
    angle_step = half_angle / rings;
    azimuth_step = kTwoPi / (6 * rings);
    for (int i = 1; i <= rings; ++i) {
      for (int j = 0; j < 6 * rings; ++j) grid.push_back(at(i * angle_step, j * azimuth_step));
    }
  }

  // Compass search in (angle, azimuth) from the best samples: in these coordinates the rim is a
  // bound on one of them, and the search slides along it.
  const std::size_t kept = std::min<std::size_t>(8, grid.size());
  std::partial_sort(grid.begin(), grid.begin() + static_cast<std::ptrdiff_t>(kept), grid.end(),
                    [](const Point& a, const Point& b) { return a.value > b.value; });
  Point best = grid.front();
  for (std::size_t i = 0; i < kept && half_angle > 0; ++i) {
    Point p = grid[i];
    double scale = 1;
    while (scale > 1e-6) {
      Point better = p;
      for (const double sign : {-1.0, 1.0}) {
        const Point a = at(p.angle + sign * scale * angle_step, p.azimuth);
        if (a.value > better.value) better = a;
        if (azimuth_step == 0) continue;
        const Point b = at(p.angle, p.azimuth + sign * scale * azimuth_step);
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
