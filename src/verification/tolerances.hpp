// Tolerances that several checks share.
#pragma once

namespace stillbase::verification {

struct SharedTolerances {
  /// rad, m, s and their rates: what a plan copies from its problem or from another of its fields
  /// differs by rounding only.
  double rounding = 1e-9;
  /// m/s, rad/s: of a hand from the velocity that it has to match; joint rates that match one have
  /// the condition of the Jacobian.
  double matched_velocity = 1e-6;
  /// m: error of the planner's distances between two flat shapes, by which a path may be too close
  /// and by which two codes may differ.
  double flat_distance = 5e-4;
  /// Of the terms that an objective is a sum and difference of: worst cases are compared relative
  /// to themselves, smaller ones relative to this, for a sampled maximum is slightly low.
  double least_worst_case = 1e-6;
};
inline constexpr SharedTolerances kShared;

}  // namespace stillbase::verification
