// What makes a motion to a configuration take its time, and what would make it faster.
#pragma once

#include <optional>
#include <string>

#include <stillbase/approach/options.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {

enum class PaceLimit { Rate, Acceleration, Torque };

struct Pace {
  double duration = 0;  ///< s of the straight motion from the start posture
  /// The limits of which twice as much saves the most; torques where they stretch the time law.
  PaceLimit limit = PaceLimit::Rate;
  std::string joint;  ///< that is at them for longest
  /// Of these limits, at which the motion takes as long as wanted; empty: no multiple does it.
  std::optional<double> factor;
};

/// Of the straight motion, which no path undercuts by much.
/// @param goal the configuration that it leads to, in a problem whose feature is chosen
/// @param wanted duration, s
/// @throws std::invalid_argument see plan_approach
Pace pace_of_straight_motion(const CaptureProblem& problem, const Configuration& goal,
                             double wanted, const ApproachOptions& options = {});

}  // namespace stillbase
