// The last part of an approach whose hand moves at the contact: from rest to the contact with its
// rates, and to rest again where the grasp does not close.
//
// The run: the joints accelerate evenly from rest, phi(t) = phi_c - phidot_c (t_c - t) + phidot_c
// (t_c - t)^2 / (2 T). Hand and target come together with a relative velocity that falls to zero:
// where the target closes in on a hand at rest it does so on this one, by v_n T / 2 less. The
// abort: cubics that take the rates to zero and the hand by a distance d along the normal,
//   phi(T) = phi_c + phidot_c T / 2 + Jhat^+ (n d).
// Both begin and end with the base floating without momentum.
#pragma once

#include <optional>
#include <string>

#include "approach/motion_check.hpp"

namespace stillbase {

struct Arrival {
  std::string failure;               ///< why there is none; empty: the others are set
  TimedMotion run;                   ///< from rest to the contact
  Configuration rest;                ///< where and when it begins
  std::optional<TimedMotion> abort;  ///< where the problem asks for it
  double retreat = 0;                ///< of the abort, m
  double clearance = 0;              ///< smallest along the abort, m
};

/// @param goal at the contact. @pre the hand of the problem moves, and its base floats
Arrival plan_arrival(const ApproachTask& task, const ArrivalOptions& options);

/// Appends run and abort to the approach to the configuration at rest.
void append_arrival(const ApproachTask& task, const Arrival& arrival, Approach& approach);

}  // namespace stillbase
