// The motion of the target from its estimate on, a second time by `reference`.
#pragma once

#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

/// How far a predicted motion is from its second integration. Relative and per radian turned since
/// the estimate: angles, rates over the rate, places and velocities of the contact features over
/// the sizes that they are sums of.
struct PredictionDifference {
  bool complete = false;  ///< false: stopped before the end
  double largest = 0;
  /// The same between two second integrations whose estimates differ by a hundred rounding errors.
  double growth = 0;
};
/// @param times s, within the horizon of the motion
PredictionDifference prediction_difference(const TargetBody& body, const TargetState& estimate,
                                           const TargetMotion& motion,
                                           const std::vector<double>& times,
                                           const StopCondition& stop);

/// The predicted motion during the approach and at the contact. No check without an estimate of a
/// target that rotates; not verified where rounding of the estimate grows beyond the tolerance.
void check_target_prediction(const Context& context, ClaimList& claims);

}  // namespace stillbase::verification
