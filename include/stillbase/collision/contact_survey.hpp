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
  /// Closer than this counts as touching, m: a clearance that is asked for elsewhere. Links whose
  /// distance never exceeds it would be refused in every posture.
  double margin = 0;
  /// Part of the postures in which a pair must touch to be listed with those that always do. Below
  /// 1 for hulls that are larger than their links: MoveIt's setup assistant takes 0.95.
  double share = 1;
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
