// What one run of one optimizer on one benchmark problem leaves behind, as plain data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <stillbase/core/child_process.hpp>

namespace stillbase {

/// A point better than all before it in the run, judged by our own evaluation: among points with
/// violation at most kBenchmarkViolation the lower value, else the lower violation.
struct Improvement {
  long evaluations = 0;  ///< of the model so far, this one included
  long gradients = 0;    ///< those of them with derivatives
  double value = 0;      ///< |y| / unit, dimensionless: see BenchmarkProgram
  double violation = 0;  ///< largest, in the constraints' units
  double seconds = 0;    ///< since the run began; differs from machine to machine
};

/// Largest violation of a point that counts as a solution.
inline constexpr double kBenchmarkViolation = 1e-6;
/// Largest violation of a point that others are measured against. Within kBenchmarkViolation a
/// point can be better than any that is exact, by more than the tightest target.
inline constexpr double kReferenceViolation = 1e-9;

/// A run that is to be done.
struct RunRequest {
  std::string instance;
  std::string problem_sha256;  ///< of everything that makes up the instance
  std::string optimizer;
  bool library_defaults = false;  ///< see nlp::OptimizeOptions
  std::uint64_t seed = 1;
  long budget = 2000;  ///< evaluations of the model
  double seconds = 20;
};

/// Name of a contestant: the optimizer's, with ":defaults" when it runs with its library's options.
std::string label_of(const RunRequest& request);

using RunEnd = ChildEnd;  ///< how the process of a run ended

struct RunRecord {
  RunRequest request;
  std::string family, goal;
  int variables = 0, equations = 0;
  std::string library, options;  ///< whose code ran, options that were set
  RunEnd end = RunEnd::Finished;
  std::string stop_reason;  ///< why the last local solve ended, in words
  std::string message;
  long evaluations = 0, gradients = 0, hessians = 0;  ///< spent
  long starts = 0;                                    ///< local solves begun
  long distinct_solutions = 0;                        ///< feasible and optimal ones
  double seconds = 0;
  std::vector<Improvement> improvements;
  std::vector<double> best_point;  ///< variables at the last improvement
  double best_kkt_residual = -1;   ///< of first order there; negative: not finite, or no point
};

}  // namespace stillbase
