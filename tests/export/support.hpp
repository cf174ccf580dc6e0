// Plans for the tests of exports.
#pragma once

#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

namespace stillbase::export_test {

/// The plan of a shipped problem.
inline Plan shipped_plan(const std::string& name) {
  return make_plan(read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/" + name + ".yaml"));
}

/// A held base and a tumbling target, in the plane.
inline const Plan& client_plan() {
  static const Plan plan = shipped_plan("planar_three_link_client");
  return plan;
}

/// A floating base that rotates during the approach, in space.
inline const Plan& floating_plan() {
  static const Plan plan = shipped_plan("iiwa_client_50");
  return plan;
}

}  // namespace stillbase::export_test
