#include "approach/time_law.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace stillbase {

namespace {

/// gamma(sigma) = a + b sigma + c sigma^2 + d sigma^3 for sigma in [0, length]. A joint whose
/// coefficients b, c, d are zero keeps its value to the last bit.
struct Piece {
  JointVectord a, b, c, d;
  double length = 0;
  bool is_curved = false;

  JointVectord at(double sigma) const { return a + sigma * (b + sigma * (c + sigma * d)); }
  JointVectord slope(double sigma) const { return b + sigma * (2 * c + 3 * sigma * d); }
  JointVectord curvature(double sigma) const { return 2 * c + 6 * sigma * d; }
};

/// Pieces that are passed without stopping, and the posture at their end.
struct Section {
  std::vector<Piece> pieces;
  JointVectord end;
};

Piece line(const JointVectord& from, const JointVectord& to) {
  const double length = (to - from).norm();
  const JointVectord zero = JointVectord::Zero(from.size());
  return {from, (to - from) / length, zero, zero, length, false};
}

/// The corner between the directions d1 and d2, cut on both sides.
Piece parabola(const JointVectord& corner, const JointVectord& d1, const JointVectord& d2,
               double cut) {
  return {corner - cut * d1, d1,  (d2 - d1) / (4 * cut), JointVectord::Zero(corner.size()),
          2 * cut,           true};
}

bool is_clear_along(const Piece& piece, const IsClear& is_clear, int checks) {
  JointVectord last = piece.a;
  for (int i = 1; i <= checks; ++i) {
    const JointVectord next = piece.at(piece.length * i / checks);
    if (!is_clear(last, next)) return false;
    last = next;
  }
  return true;
}

/// Straight lines between the waypoints, corners replaced by parabolas as large as `is_clear`
/// allows; a new section begins at a corner that cannot be rounded. |gamma'| is 1 on lines and at
/// the ends of parabolas.
std::vector<Section> round_corners(const std::vector<JointVectord>& points, const IsClear& is_clear,
                                   const TimeLawOptions& options) {
  std::vector<Section> sections(1);
  JointVectord from = points.front();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const JointVectord& corner = points[i];
    const bool is_last = i + 1 == points.size();
    JointVectord d1, d2;
    double cut = 0;
    if (!is_last) {
      const JointVectord in = corner - points[i - 1], out = points[i + 1] - corner;
      d1 = in.normalized();
      d2 = out.normalized();
      if ((d1 + d2).norm() >= options.sharpest_corner) {
        cut = std::min(
            {options.largest_cut, options.cut_share * in.norm(), options.cut_share * out.norm()});
      }
      while (cut > options.smallest_cut &&
             !is_clear_along(parabola(corner, d1, d2, cut), is_clear, options.corner_checks)) {
        cut /= 2;
      }
    }
    std::vector<Piece>& pieces = sections.back().pieces;
    if (cut > options.smallest_cut) {
      const Piece rounded = parabola(corner, d1, d2, cut);
      pieces.push_back(line(from, rounded.a));
      pieces.push_back(rounded);
      from = corner + cut * d2;
    } else {
      pieces.push_back(line(from, corner));
      sections.back().end = from = corner;
      if (!is_last) sections.emplace_back();
    }
  }
  return sections;
}

/// A smooth curve as one section: `times` are values of sigma, `phidot` the slopes there.
Section smooth_section(const JointPath& curve) {
  Section section;
  section.end = curve.phi.back();
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const double h = curve.times[i + 1] - curve.times[i];
    const JointVectord rise = (curve.phi[i + 1] - curve.phi[i]) / h;
    const JointVectord &s0 = curve.phidot[i], &s1 = curve.phidot[i + 1];
    section.pieces.push_back(
        {curve.phi[i], s0, (3 * rise - 2 * s0 - s1) / h, (s0 + s1 - 2 * rise) / (h * h), h, true});
  }
  return section;
}

/// Fastest sigma(t) along a section: pieces of constant sigma'' between grid points.
class SpeedProfile {
 public:
  SpeedProfile(const Section& section, const MotionLimits& limits, const TimeLawOptions& options) {
    build_grid(section, limits, options);
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

  void build_grid(const Section& section, const MotionLimits& limits,
                  const TimeLawOptions& options) {
    double total = 0;
    for (const Piece& piece : section.pieces) total += piece.length;
    double offset = 0;
    sigma_.assign(1, 0.0);
    squared_.assign(1, std::numeric_limits<double>::max());
    const int least =
        section.pieces.size() < 32 ? options.grid_per_piece : options.grid_per_short_piece;
    for (const Piece& piece : section.pieces) {
      const double share = piece.is_curved ? options.curve_share : 1.0;
      const int parts =
          std::max(least, static_cast<int>(options.grid_per_section * piece.length / total));
      for (int part = 0; part <= parts; ++part) {
        const double sigma = piece.length * part / parts;
        const JointVectord slope = piece.slope(sigma), curvature = piece.curvature(sigma);
        double squared = std::numeric_limits<double>::max();
        double acceleration = std::numeric_limits<double>::max();
        for (Eigen::Index k = 0; k < slope.size(); ++k) {
          const double g = std::abs(slope[k]), c = std::abs(curvature[k]);
          if (g > 0) {
            squared = std::min(squared, limits.rate[k] / g * (limits.rate[k] / g));
            acceleration = std::min(acceleration, share * limits.acceleration[k] / g);
          }
          if (c > 0) squared = std::min(squared, share * limits.acceleration[k] / c);
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
    if (sigma <= piece.length) return {piece.at(sigma), piece.slope(sigma)};
    sigma -= piece.length;
  }
  const Piece& last = section.pieces.back();
  return {section.end, last.slope(last.length)};
}

/// Motion along a section from time 0, at rest at both ends, with the speed averaged over `window`.
JointPath time_section(const Section& section, const SpeedProfile& profile, double window,
                       const MotionLimits& limits, const TimeLawOptions& options) {
  const double duration = profile.duration() + window;
  const double wanted = std::ceil(std::max(profile.length() / options.sample_travel,
                                           options.samples_per_window * duration / window));
  const int samples = static_cast<int>(std::clamp(wanted, static_cast<double>(options.min_samples),
                                                  static_cast<double>(options.max_samples)));
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
  // Exact ends, without the rounding of the sums above.
  path.phi.front() = section.pieces.front().a;
  path.phi.back() = section.end;
  path.phidot.front().setZero();
  path.phidot.back().setZero();
  // On a curve the averaged speed exceeds the profile slightly, and the Hermite segments overshoot
  // where the curvature jumps: the samples are stretched by what the segments demand.
  keep_limits(path, limits);
  return path;
}

/// The fastest of the windows.
JointPath fastest(const Section& section, const MotionLimits& limits,
                  const TimeLawOptions& options) {
  const SpeedProfile profile(section, limits, options);
  JointPath best;
  for (const double window : options.windows) {
    JointPath timed = time_section(section, profile, window * profile.duration(), limits, options);
    if (best.times.empty() || timed.times.back() < best.times.back()) best = std::move(timed);
  }
  return best;
}

}  // namespace

JointPath over_length(const JointPath& curve) {
  constexpr double kStill = 1e-7;  // rad, and rad per unit of the parameter
  JointPath out;
  double sigma = 0;
  for (std::size_t i = 0; i < curve.phi.size(); ++i) {
    const double speed = curve.phidot[i].norm();
    const bool is_end = i == 0 || i + 1 == curve.phi.size();
    if (i > 0) {
      const double chord = (curve.phi[i] - out.phi.back()).norm();
      if (!(chord > kStill) || (speed < kStill && !is_end)) continue;
      sigma += chord;
    }
    out.times.push_back(sigma);
    out.phi.push_back(curve.phi[i]);
    out.phidot.push_back(curve.phidot[i]);
  }
  out.phi.back() = curve.phi.back();
  // At rest the rate has no direction: the chord gives it.
  for (std::size_t i = 0; i < out.phi.size() && out.segments() > 0; ++i) {
    const std::size_t beside = i + 1 < out.phi.size() ? i : i - 1;
    const JointVectord chord = out.phi[beside + 1] - out.phi[beside];
    JointVectord& slope = out.phidot[i];
    slope = slope.norm() < kStill ? chord.normalized() : slope.normalized();
  }
  return out;
}

JointPath time_path(const std::vector<JointVectord>& points, const MotionLimits& limits,
                    const IsClear& is_clear, const TimeLawOptions& options) {
  assert(!points.empty());
  std::vector<JointVectord> distinct(1, points.front());
  for (const JointVectord& point : points) {
    if ((point - distinct.back()).norm() > 1e-9) distinct.push_back(point);
  }
  JointPath path{{0.0}, {points.back()}, {JointVectord::Zero(points.back().size())}};
  if (distinct.size() == 1) return path;
  path.phi.front() = points.front();
  distinct.back() = points.back();
  for (const Section& section : round_corners(distinct, is_clear, options)) {
    const JointPath part = fastest(section, limits, options);
    const double begin = path.times.back();
    for (std::size_t i = 1; i < part.times.size(); ++i) {
      path.times.push_back(begin + part.times[i]);
      path.phi.push_back(part.phi[i]);
      path.phidot.push_back(part.phidot[i]);
    }
  }
  return path;
}

JointPath time_curve(const JointPath& curve, const MotionLimits& limits,
                     const TimeLawOptions& options) {
  assert(curve.segments() > 0);
  return fastest(smooth_section(curve), limits, options);
}

}  // namespace stillbase
