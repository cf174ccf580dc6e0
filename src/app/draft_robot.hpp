// The robot of a first problem: a robot file alone, or an arm on a box.
#pragma once

#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

#include "app/problem_draft.hpp"

namespace stillbase::app {

/// How an arm stands on the base's box.
struct DraftMount {
  bool is_lying = false;  ///< else on the middle of the +z face, its axes those of the base
  double lift = 0;        ///< Lying, of its root link from the +z face, m

  /// Lying: on the edge of the +z face towards +x, its z axis along -x, so that a hand which always
  /// points down at the arm's foot points out of the base.
  Pose pose(const Vector3d& base_size) const {
    Pose out;
    out.position.z() = base_size.z() / 2 + lift;
    if (!is_lying) return out;
    out.position.x() = base_size.x() / 2;
    out.orientation = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitY());
    return out;
  }
};

/// The robot of a first problem and how the problem states it.
struct DraftRobot {
  RobotModel model;
  std::string base_lines;                 ///< the file, or base and mount without the hand's frame
  std::string hand;                       ///< link of the file
  std::string joint_lines;                ///< package_path, locked, limits
  bool is_put_together = false;           ///< from a base and the file
  Vector3d base_size = Vector3d::Zero();  ///< m; put together
  std::vector<std::string> notes;         ///< what was chosen, in words
  std::vector<std::string> tips;          ///< links of the file that fingers of the hand carry
};

/// Reads the robot file, finds its hand, puts it on a base where it has none of its own, locks what
/// does not carry the hand and gives limits to what has none.
/// @param tip a link that fingers of the hand carry, in place of the hand; empty: the hand
/// @throws InputError, AssemblyError
/// @throws CommandLineError there is no such hand, or no joint moves it
DraftRobot draft_robot(const DraftRequest& request, const DraftMount& mount,
                       const std::string& tip = {});

}  // namespace stillbase::app
