// The runs of a benchmark: which ones, and what each leaves behind. The approach planners on
// approach problems, logged for OMPL's Planner Arena.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/benchmark/suite.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/io/benchmark_file.hpp>

namespace stillbase::app {

struct BenchSelection {
  std::vector<std::string> problems;    ///< problem files in place of the suite's families
  std::vector<std::string> select;      ///< instances, or what their names begin with; empty: all
  std::vector<std::string> optimizers;  ///< labels; empty: all, and a few runs with defaults
  /// Per family and goal; not stated: those that `select` names, or the first five.
  std::optional<int> instances;
  int seeds = 15;
  std::uint64_t first_seed = 1;
  long budget = 2000;
  double seconds = 20;
  std::size_t refined = 8;    ///< best runs of each instance whose points are made exact
  bool with_defaults = true;  ///< when `optimizers` is empty
};

/// @throws InputError, FileError; CommandLineError when nothing is selected
std::vector<BenchmarkInstance> select_instances(const SuiteSpec& suite,
                                                const BenchSelection& selection);

/// Every run, in the order of the records.
/// @throws CommandLineError for an unknown optimizer
std::vector<RunRequest> requests_of(const std::vector<BenchmarkInstance>& instances,
                                    const BenchSelection& selection);

struct BenchRunOptions {
  std::string folder;  ///< of the journal
  int jobs = 1;
  StopCondition stop;
};

struct BenchRuns {
  std::vector<std::string> texts;  ///< of the records in the order of the requests
  std::vector<std::string> died;   ///< "<optimizer> on <instance>, seed <n>": without a record
};

/// Executes the runs that the folder's journal does not have yet, one process each.
/// @return fewer than all when stopped
/// @throws FileError, InputError as run_campaign()
BenchRuns run_all(const std::vector<BenchmarkInstance>& instances,
                  const std::vector<RunRequest>& requests, const BenchRunOptions& options);

/// System and processor architecture; no name of the machine, so that records can be shared.
std::string host_words();

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
