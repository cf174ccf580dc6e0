// The documents of a page: a file's own JSON, and what the page draws beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/plan/problem.hpp>

#include "app/page_visuals.hpp"

namespace stillbase::app {

/// The page of plans, verifications, results and benchmark folders. A verification goes with the
/// plan that it judges.
/// @return HTML
/// @throws InputError, FileError
std::string report_page(const std::vector<std::string>& paths);

/// What `check` draws of one file.
struct CheckedFile {
  std::string path;
  std::string words;                      ///< what was understood
  RobotModel robot;                       ///< of the file
  std::optional<CaptureProblem> problem;  ///< empty: a robot alone
  std::vector<RobotFile> robot_files;     ///< that the robot is drawn from
};

/// The page of robots and problems before anything is planned.
/// @return HTML
std::string check_page(const std::vector<CheckedFile>& files);

}  // namespace stillbase::app
