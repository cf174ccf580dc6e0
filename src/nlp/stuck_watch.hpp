// Descents of sequential quadratic programming that do not come back onto the constraints.
//
// The first step is along the gradient, as long as that is. From a steep start the descent may end
// where the linearised equations contradict each other: there it lowers the objective by small
// steps for hundreds of evaluations, and never comes back; or it ends there by itself, and the
// start is still the best feasible point. A second descent then begins with a short first step.
#pragma once

#include <algorithm>

#include <stillbase/core/constants.hpp>

namespace stillbase::nlp {

struct StuckOptions {
  int patience = 50;           ///< evaluations without a fall of the violation
  double close = 1e-2;         ///< violation that need not fall: rows are of order one
  double fallen = 0.9;         ///< part of the last violation that counts as a fall
  double off = 1e-6;           ///< violation of a last point that is no end
  double cautious_step = 0.1;  ///< length of the second run's first step; variables are of order 1
};
inline constexpr StuckOptions kStuck;

inline constexpr const char* kStuckRemark =
    "got stuck at a violation, started again with a short first step";

class StuckWatch {
 public:
  /// @param violation largest one of a new point
  void look_at(double violation) {
    ++evaluations_;
    last_ = violation;
    if (violation > std::max(kStuck.close, kStuck.fallen * reference_)) return;
    reference_ = violation;
    evaluations_ = 0;
  }
  bool is_stuck() const { return evaluations_ >= kStuck.patience; }
  /// The last point is violated, beyond what is tolerated as well.
  bool is_off(double tolerance) const { return last_ > std::max(kStuck.off, tolerance); }
  void reset() { *this = StuckWatch(); }

 private:
  int evaluations_ = 0;
  double reference_ = kInfinity;
  double last_ = 0.0;
};

}  // namespace stillbase::nlp
