// Which links of a robot touch in every posture, and which never do.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

struct ContactSurveyOptions {
  /// A pair that touches in every one of so many postures is one that overlaps by construction;
  /// with 200 a pair that is free in 2 % of them is missed in one case of fifty.
  int postures = 200;
  /// Postures after which a pair that never touched counts as one that cannot.
  int postures_for_never = 2000;
  std::uint64_t seed = 1;
};

struct ContactSurvey {
  using LinkPairs = std::vector<std::pair<std::string, std::string>>;
  LinkPairs always;  ///< touch in every posture: allowed contacts of a problem
  LinkPairs never;   ///< touched in no posture: need not be checked
};

/// Looks at pairs of links with shapes on different bodies that are checked for collisions, at
/// random postures within the joint limits (a joint without limits anywhere in a turn or a metre).
ContactSurvey survey_contacts(const RobotModel& robot, const ContactSurveyOptions& options = {});

}  // namespace stillbase
