// What the base's wheels still take.
#pragma once

#include <algorithm>

#include <stillbase/plan/post_impact.hpp>

namespace stillbase {

/// Part of its capacity that a wheel keeps unused: one that a command has filled up is full,
/// whatever the integration leaves.
inline constexpr double kWheelRounding = 1e-9;

/// What wheel i takes beyond what it holds, of a momentum with the sign of `towards`, N m s; zero:
/// it is full.
/// @param held by the wheels, in B, N m s
inline double wheel_room(const WheelSpec& wheels, const Vector3d& held, int i, double towards) {
  const double filled = towards < 0 ? -held[i] : held[i];
  const bool is_full = filled >= (1 - kWheelRounding) * wheels.momentum[i];
  return is_full ? 0 : wheels.momentum[i] - filled;
}

/// A moment u on the base, in B, N m, no larger than fills a wheel within a period: the wheels get
/// -u.
inline Vector3d within_wheel_room(const WheelSpec& wheels, const Vector3d& held, Vector3d u,
                                  double period) {
  for (int i = 0; i < 3; ++i) {
    const double most = wheel_room(wheels, held, i, -u[i]) / period;
    u[i] = std::clamp(u[i], -most, most);
  }
  return u;
}

}  // namespace stillbase
