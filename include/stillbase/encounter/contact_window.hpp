// When a contact feature of the target can be met: it faces the robot, and it closes in.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// A contact feature at one instant as the robot sees it that waits with its hand at rest.
struct FeatureView {
  double time = 0;           ///< s
  double closing_speed = 0;  ///< v_n = n . v of the material point, m/s
  double facing_angle = 0;  ///< between n and the line to the stated base, rad: below pi/2 it faces
  double distance = 0;      ///< from the stated base, m
};

/// While a feature faces the stated base and closes in at `constraints.closing_speed_min` or more.
struct ContactWindow {
  double from = 0, to = 0;  ///< s; the ends of the survey where it is open there
  double least_closing_speed = 0, largest_closing_speed = 0;  ///< m/s, both ends included
};

struct FeatureWindows {
  std::string feature;
  std::vector<FeatureView> views;      ///< evenly spaced over the survey, both ends included
  std::vector<ContactWindow> windows;  ///< in order; ends to 1e-9 s
};

struct WindowSurvey {
  double from = 0, to = 0;               ///< s
  std::vector<FeatureWindows> features;  ///< all of the target, in its order
};

/// Follows every contact feature over `variables.contact_time` and one revolution of the target on
/// either side (at most 1000 s each, not before the estimate; 200 rad altogether). The base is
/// taken where the problem states it, also where its position is free.
/// @return no features for a problem whose impulse does not follow from the target's motion
/// @throws std::invalid_argument when the target rotates too often to be predicted
WindowSurvey survey_contact_windows(const CaptureProblem& problem);

}  // namespace stillbase
