#include "approach/joint_path.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase {

JointMotion motion_on_segment(const JointPath& path, std::size_t i, double t) {
  const double h = path.times[i + 1] - path.times[i];
  const double u = (t - path.times[i]) / h;
  const JointVectord& q0 = path.phi[i];
  const JointVectord &v0 = path.phidot[i], &v1 = path.phidot[i + 1];
  const JointVectord rise = path.phi[i + 1] - q0;
  JointMotion motion;
  motion.phi = q0 + (u * u * (3 - 2 * u)) * rise + (h * u * (1 - u) * (1 - u)) * v0 -
               (h * u * u * (1 - u)) * v1;
  motion.phidot =
      (6 * u * (1 - u) / h) * rise + ((1 - u) * (1 - 3 * u)) * v0 + (u * (3 * u - 2)) * v1;
  motion.phiddot =
      ((6 - 12 * u) / (h * h)) * rise + ((6 * u - 4) / h) * v0 + ((6 * u - 2) / h) * v1;
  return motion;
}

JointVectord peak_rates(const JointPath& path, std::size_t i, double t0, double t1) {
  const JointMotion a = motion_on_segment(path, i, t0);
  const JointMotion b = motion_on_segment(path, i, t1);
  JointVectord peak = a.phidot.cwiseAbs().cwiseMax(b.phidot.cwiseAbs());
  // The rate is a parabola in t: its vertex is where the (linear) acceleration vanishes.
  for (Eigen::Index k = 0; k < peak.size(); ++k) {
    if (a.phiddot[k] * b.phiddot[k] < 0) {
      const double at = a.phiddot[k] / (a.phiddot[k] - b.phiddot[k]);
      const double vertex = a.phidot[k] + a.phiddot[k] * at * (t1 - t0) / 2;
      peak[k] = std::max(peak[k], std::abs(vertex));
    }
  }
  return peak;
}

double length(const JointPath& path, int parts) {
  double sum = 0;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    const double h = (path.times[i + 1] - path.times[i]) / parts;
    JointVectord last = path.phi[i];
    for (int part = 1; part <= parts; ++part) {
      const JointVectord phi = motion_on_segment(path, i, path.times[i] + part * h).phi;
      sum += (phi - last).norm();
      last = phi;
    }
  }
  return sum;
}

double stretch_for_limits(const JointPath& path, const MotionLimits& limits) {
  double factor = 0;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    const double t0 = path.times[i], t1 = path.times[i + 1];
    const JointVectord rate = peak_rates(path, i, t0, t1);
    // The acceleration is linear on a segment: largest at an end.
    const JointVectord acceleration =
        motion_on_segment(path, i, t0)
            .phiddot.cwiseAbs()
            .cwiseMax(motion_on_segment(path, i, t1).phiddot.cwiseAbs());
    for (Eigen::Index k = 0; k < rate.size(); ++k) {
      factor = std::max(factor, rate[k] / limits.rate[k]);
      factor = std::max(factor, std::sqrt(acceleration[k] / limits.acceleration[k]));
    }
  }
  return factor;
}

void stretch(JointPath& path, double factor) {
  for (double& t : path.times) t = path.times.front() + (t - path.times.front()) * factor;
  for (JointVectord& rate : path.phidot) rate /= factor;
}

void keep_limits(JointPath& path, const MotionLimits& limits) {
  const double factor = stretch_for_limits(path, limits);
  if (factor > 1) stretch(path, factor * (1 + 1e-9));
}

}  // namespace stillbase
