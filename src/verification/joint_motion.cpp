#include "verification/joint_motion.hpp"

#include <cmath>

namespace stillbase::verification {

HermiteSegment::HermiteSegment(const Approach& approach, std::size_t i)
    : t0_(approach.times[i]),
      h_(approach.times[i + 1] - approach.times[i]),
      a_(approach.joint_positions[i]),
      b_(approach.joint_velocities[i]) {
  const Eigen::VectorXd step = approach.joint_positions[i + 1] - approach.joint_positions[i];
  const Eigen::VectorXd v1 = approach.joint_velocities[i + 1];
  c_ = (3 * step / h_ - 2 * b_ - v1) / h_;
  d_ = (b_ + v1 - 2 * step / h_) / (h_ * h_);
}

HermiteSegment::Extremes HermiteSegment::extremes() const {
  const Eigen::VectorXd first = position(0), last = position(h_);
  Extremes e{first.cwiseMin(last), first.cwiseMax(last),
             velocity(0).cwiseAbs().cwiseMax(velocity(h_).cwiseAbs()),
             acceleration(0).cwiseAbs().cwiseMax(acceleration(h_).cwiseAbs())};
  for (Eigen::Index k = 0; k < a_.size(); ++k) {
    auto look_at = [&](double s) {
      if (!(s > 0 && s < h_)) return;
      const double phi = position(s)(k);
      e.lowest(k) = std::min(e.lowest(k), phi);
      e.highest(k) = std::max(e.highest(k), phi);
    };
    // velocity b + 2 c s + 3 d s^2 = 0, in the form that does not cancel.
    const double q = -(
        c_(k) + std::copysign(std::sqrt(std::max(0.0, c_(k) * c_(k) - 3 * d_(k) * b_(k))), c_(k)));
    if (d_(k) != 0) look_at(q / (3 * d_(k)));
    if (q != 0) look_at(b_(k) / q);
    if (d_(k) != 0) {
      const double s = -c_(k) / (3 * d_(k));  // acceleration zero: extreme rate
      if (s > 0 && s < h_) e.rate(k) = std::max(e.rate(k), std::abs(velocity(s)(k)));
    }
  }
  return e;
}

}  // namespace stillbase::verification
