// Instants at which a run is sampled, and steps between them.
#pragma once

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase {

/// Instants start + i * period; none when the period is zero.
class Ticks {
 public:
  Ticks(double start, double period) : start_(start), period_(period) {}
  double next() const {
    return period_ > 0 ? start_ + static_cast<double>(count_) * period_ : kInfinity;
  }
  /// True when t is the next instant (up to rounding); moves on to the one after.
  bool fires_at(double t) {
    if (period_ <= 0 || next() > t + 1e-9 * period_) return false;
    ++count_;
    return true;
  }

 private:
  double start_, period_;
  long count_ = 0;
};

/// Where a stretch of a run that begins at t ends: at the next instant, or at the end of the run
/// when hardly anything is left after it.
inline double end_of_stretch(double t, double next, double end) {
  next = std::min(next, end);
  return end - next < 1e-9 * (next - t) ? end : next;
}

/// How many steps of at most `longest` reach from t to t1. The allowance keeps rounding of the
/// interval from making two steps of one.
inline double number_of_steps(double t, double t1, double longest) {
  return std::max(1.0, std::ceil((t1 - t) / longest - 1e-6));
}

}  // namespace stillbase
