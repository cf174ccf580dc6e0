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

/// The entries of a posture (n) that belong to the free joints.
Eigen::VectorXd free_part(const JointVectord& phi, const std::vector<Eigen::Index>& free);
/// `phi` (n) with those entries replaced.
JointVectord with_free_part(JointVectord phi, const std::vector<Eigen::Index>& free,
                            const Eigen::VectorXd& part);

/// Motion on segment `i` (between samples i and i + 1) at time t.
JointMotion motion_on_segment(const JointPath& path, std::size_t i, double t);

/// Largest |phidot_k| of each joint on segment i for t in [t0, t1]; exact.
JointVectord peak_rates(const JointPath& path, std::size_t i, double t0, double t1);

/// How far the limits are overstepped: the factor by which all times must be stretched so that
/// every joint's rate and acceleration, taken on the Hermite segments themselves, are within them.
/// At most 1 when they already are.
double stretch_for_limits(const JointPath& path, const JointVectord& max_rate,
                          const JointVectord& max_acceleration);

/// Slows the whole motion down: times from the first one stretched by `factor`.
void stretch(JointPath& path, double factor);

/// Euclidean length in joint space, rad.
double length(const JointPath& path);

}  // namespace stillbase
