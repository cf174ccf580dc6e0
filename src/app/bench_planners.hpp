// The approach planners on approach problems, logged for OMPL's Planner Arena.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>

namespace stillbase::app {

struct PlannerBenchOptions {
  std::vector<std::string> problems;  ///< problem files
  std::string folder;
  int seeds = 15;
  std::uint64_t first_seed = 1;
  int jobs = 1;
  double seconds = 60;  ///< time limit of a run
  StopCondition stop;
  bool print = false;  ///< the logs on stdout as well
};

/// For each problem a configuration is planned once; then every planner plans the approach to it
/// with every seed, each in a process of its own. Writes `planners_<problem>.log` into the folder.
/// @return exit code
/// @throws InputError, FileError
int bench_planners(const PlannerBenchOptions& options);

}  // namespace stillbase::app
