// A first problem for an arm: what the user says of it, and the file that `new` writes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase::app {

/// From further away the contact is later than an instant may be, m.
inline constexpr double kFarthest = 4e4;

struct DraftRequest {
  std::string robot;     ///< path of the robot file
  std::string problem;   ///< path of the problem file, that paths in it are relative to
  std::string hand;      ///< link; empty: found
  double base_mass = 0;  ///< kg; 0: ten times the arm's, or the file's own base
  Vector3d base_size = Vector3d::Zero();  ///< m; 0: that of 200 kg/m^3
  double target_mass = 0;                 ///< kg; 0: a tenth of the spacecraft's
  double spin = 2;                        ///< of the target, deg/s
  double distance = 0;  ///< of the target from the hand at the start, m; 0: 1.5, more for slow arms
  std::vector<std::string> package_path;
};

struct Draft {
  std::string text;                 ///< of the problem file
  std::vector<std::string> notes;   ///< what was chosen, in words
  std::vector<std::string> doubts;  ///< whether it plans as it is
};

/// @throws InputError the robot file is refused
/// @throws CommandLineError there is no such hand, or no posture to start from
Draft draft_problem(const DraftRequest& request);

}  // namespace stillbase::app
