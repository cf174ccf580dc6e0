// Joint motion as a plan stores it: samples joined by cubic Hermite segments.
#pragma once

#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase {

struct JointPath {
  std::vector<double> times;         ///< s, increasing
  std::vector<JointVectord> phi;     ///< n each
  std::vector<JointVectord> phidot;  ///< n each
  std::size_t segments() const { return times.empty() ? 0 : times.size() - 1; }
};

struct JointMotion {
  JointVectord phi, phidot, phiddot;
};

/// Rate and acceleration limits of the joints: n each, > 0; rates may be infinite.
struct MotionLimits {
  JointVectord rate, acceleration;
};

/// `phi` (n) with the entries of the free joints replaced.
inline JointVectord with_free_part(JointVectord phi, const std::vector<Eigen::Index>& free,
                                   const Eigen::VectorXd& part) {
  phi(free) = part;
  return phi;
}

/// Motion on segment `i` (between samples i and i + 1) at time t.
JointMotion motion_on_segment(const JointPath& path, std::size_t i, double t);

/// Largest |phidot_k| of each joint on segment i for t in [t0, t1]; exact.
JointVectord peak_rates(const JointPath& path, std::size_t i, double t0, double t1);

/// Euclidean length in joint space, rad, by chords. @param parts of each segment
double length(const JointPath& path, int parts);

/// Factor by which all times must be stretched so that rate and acceleration of every joint are
/// within the limits everywhere on the Hermite segments. At most 1 when they already are.
double stretch_for_limits(const JointPath& path, const MotionLimits& limits);

/// Stretches the times from the first one on by `factor`; the rates are divided by it.
void stretch(JointPath& path, double factor);

/// Stretches the times where the limits ask for it.
void keep_limits(JointPath& path, const MotionLimits& limits);

}  // namespace stillbase
