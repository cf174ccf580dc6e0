// Shipped problems, whole or without what comes before and after the impact.
#pragma once

#include <string>

#include <stillbase/io/problem_file.hpp>

namespace stillbase::test {

/// @param name of a file in problems/, without its extension
inline CaptureProblem shipped(const std::string& name) {
  return read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/" + name + ".yaml");
}

/// Without approach and without controllers after the impact: the search and its proof alone.
inline CaptureProblem without_path(const std::string& name) {
  CaptureProblem problem = shipped(name);
  problem.approach.enabled = false;
  problem.post_impact.controllers.clear();
  return problem;
}

}  // namespace stillbase::test
