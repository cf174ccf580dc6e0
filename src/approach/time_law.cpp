#include "approach/time_law.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace stillbase {

namespace {

/// Fastest sigma(t) along a section: pieces of constant sigma'' between grid points.
class SpeedProfile {
 public:
  SpeedProfile(const Section& section, const JointVectord& max_rate,
               const JointVectord& max_acceleration) {
    build_grid(section, max_rate, max_acceleration);
    // Two passes over the squared speed (Bobrow, Dubowsky, Gibson 1985, on a grid).
    const std::size_t count = sigma_.size();
    squared_.front() = squared_.back() = 0;
    for (std::size_t j = 0; j + 1 < count; ++j) {
      squared_[j + 1] = std::min(squared_[j + 1],
                                 squared_[j] + 2 * acceleration_[j] * (sigma_[j + 1] - sigma_[j]));
    }
    for (std::size_t j = count - 1; j-- > 0;) {
      squared_[j] = std::min(squared_[j],
                             squared_[j + 1] + 2 * acceleration_[j] * (sigma_[j + 1] - sigma_[j]));
    }
    time_.assign(1, 0.0);
    integral_.assign(1, 0.0);
    for (std::size_t j = 0; j + 1 < count; ++j) {
      const double v0 = std::sqrt(squared_[j]), v1 = std::sqrt(squared_[j + 1]);
      const double dt = 2 * (sigma_[j + 1] - sigma_[j]) / (v0 + v1);
      time_.push_back(time_.back() + dt);
      integral_.push_back(integral_.back() + sigma_[j] * dt + v0 * dt * dt / 2 +
                          (v1 - v0) * dt * dt / 6);
    }
  }

  double duration() const { return time_.back(); }
  double length() const { return sigma_.back(); }

  /// sigma(t), constant outside the motion.
  double position(double t) const {
    if (t <= 0) return 0;
    if (t >= duration()) return length();
    const auto [j, s, v, a] = locate(t);
    return sigma_[j] + v * s + a * s * s / 2;
  }
  /// Integral of sigma from 0 to t.
  double integral(double t) const {
    if (t <= 0) return 0;
    if (t >= duration()) return integral_.back() + (t - duration()) * length();
    const auto [j, s, v, a] = locate(t);
    return integral_[j] + sigma_[j] * s + v * s * s / 2 + a * s * s * s / 6;
  }

 private:
  struct Place {
    std::size_t j;
    double s, v, a;
  };
  Place locate(double t) const {
    const auto upper = std::upper_bound(time_.begin(), time_.end(), t);
    const auto j = static_cast<std::size_t>(upper - time_.begin()) - 1;
    const double v0 = std::sqrt(squared_[j]), v1 = std::sqrt(squared_[j + 1]);
    return {j, t - time_[j], v0, (v1 - v0) / (time_[j + 1] - time_[j])};
  }

  void build_grid(const Section& section, const JointVectord& max_rate,
                  const JointVectord& max_acceleration) {
    double total = 0;
    for (const Piece& piece : section.pieces) total += piece.length;
    double offset = 0;
    sigma_.assign(1, 0.0);
    squared_.assign(1, std::numeric_limits<double>::max());
    const int least = section.pieces.size() < 32 ? 16 : 4;
    for (const Piece& piece : section.pieces) {
      if (piece.length <= 0) continue;
      // On a curve half of the acceleration is kept for the turning itself.
      const double share = piece.is_curved ? 0.5 : 1.0;
      const int parts = std::max(least, static_cast<int>(400 * piece.length / total));
      for (int part = 0; part <= parts; ++part) {
        const double sigma = piece.length * part / parts;
        const JointVectord slope = piece.slope(sigma), curvature = piece.curvature(sigma);
        double squared = std::numeric_limits<double>::max();
        double acceleration = std::numeric_limits<double>::max();
        for (Eigen::Index k = 0; k < slope.size(); ++k) {
          const double g = std::abs(slope[k]), c = std::abs(curvature[k]);
          if (g > 0) {
            squared = std::min(squared, max_rate[k] / g * (max_rate[k] / g));
            acceleration = std::min(acceleration, share * max_acceleration[k] / g);
          }
          if (c > 0) squared = std::min(squared, share * max_acceleration[k] / c);
        }
        if (part == 0) {
          squared_.back() = std::min(squared_.back(), squared);
        } else {
          sigma_.push_back(offset + sigma);
          squared_.push_back(squared);
          acceleration_.back() = std::min(acceleration_.back(), acceleration);
        }
        if (part < parts) acceleration_.push_back(acceleration);
      }
      offset += piece.length;
    }
  }

  std::vector<double> sigma_, squared_, acceleration_;  ///< grid; acceleration_ per interval
  std::vector<double> time_, integral_;
};

/// Where and how fast along a section.
struct PathPoint {
  JointVectord phi, slope;
};
PathPoint point_on(const Section& section, double sigma) {
  for (const Piece& piece : section.pieces) {
    if (sigma <= piece.length && piece.length > 0) return {piece.at(sigma), piece.slope(sigma)};
    sigma -= piece.length;
  }
  const Piece& last = section.pieces.back();
  return {section.end, last.slope(last.length)};
}

/// Motion along a section from time 0, at rest at both ends, with the speed averaged over `window`.
JointPath time_section(const Section& section, const SpeedProfile& profile, double window,
                       const JointVectord& max_rate, const JointVectord& max_acceleration,
                       const TimeLawOptions& options) {
  const double duration = profile.duration() + window;
  const int samples = std::clamp(
      static_cast<int>(std::ceil(std::max(profile.length() / options.sample_travel,
                                          options.samples_per_window * duration / window))),
      options.min_samples, options.max_samples);
  JointPath path;
  for (int i = 0; i <= samples; ++i) {
    const double t = duration * i / samples;
    // Mean of sigma over the window [t - window, t]; its derivative is the difference of the ends.
    const double sigma = (profile.integral(t) - profile.integral(t - window)) / window;
    const double speed = (profile.position(t) - profile.position(t - window)) / window;
    const PathPoint point = point_on(section, std::clamp(sigma, 0.0, profile.length()));
    path.times.push_back(t);
    path.phi.push_back(point.phi);
    path.phidot.push_back(speed * point.slope);
  }
  // Exactly, whatever the sums above were rounded to.
  path.phi.front() = section.begin;
  path.phi.back() = section.end;
  path.phidot.front().setZero();
  path.phidot.back().setZero();
  // The averaged speed meets a curve a little faster than the profile, and the Hermite segments
  // overshoot where the curvature jumps: stretch by what they really demand.
  const double factor = stretch_for_limits(path, max_rate, max_acceleration);
  if (factor > 1) stretch(path, factor * (1 + 1e-9));
  return path;
}

/// The fastest of the windows.
JointPath fastest(const Section& section, const JointVectord& max_rate,
                  const JointVectord& max_acceleration, const TimeLawOptions& options) {
  const SpeedProfile profile(section, max_rate, max_acceleration);
  JointPath best;
  for (const double window : options.windows) {
    JointPath timed = time_section(section, profile, window * profile.duration(), max_rate,
                                   max_acceleration, options);
    if (best.times.empty() || timed.times.back() < best.times.back()) best = std::move(timed);
  }
  return best;
}

}  // namespace

JointPath time_path(const std::vector<JointVectord>& points, const JointVectord& max_rate,
                    const JointVectord& max_acceleration, const IsClear& is_clear,
                    const TimeLawOptions& options) {
  assert(!points.empty());
  std::vector<JointVectord> distinct(1, points.front());
  for (const JointVectord& point : points) {
    if ((point - distinct.back()).norm() > 1e-9) distinct.push_back(point);
  }
  JointPath path;
  path.times.assign(1, 0.0);
  path.phi.assign(1, points.back());
  path.phidot.assign(1, JointVectord::Zero(points.back().size()));
  if (distinct.size() == 1) return path;
  path.phi.front() = points.front();
  distinct.back() = points.back();
  for (const Section& section : round_corners(distinct, is_clear, options)) {
    const JointPath part = fastest(section, max_rate, max_acceleration, options);
    const double begin = path.times.back();
    for (std::size_t i = 1; i < part.times.size(); ++i) {
      path.times.push_back(begin + part.times[i]);
      path.phi.push_back(part.phi[i]);
      path.phidot.push_back(part.phidot[i]);
    }
  }
  return path;
}

JointPath time_curve(const JointPath& curve, const JointVectord& max_rate,
                     const JointVectord& max_acceleration, const TimeLawOptions& options) {
  assert(curve.segments() > 0);
  return fastest(smooth_section(curve), max_rate, max_acceleration, options);
}

}  // namespace stillbase
