// What a set of run records says about the optimizers: everything that a report shows, as numbers.
//
// Assumptions. A problem is an instance; all optimizers were given the same seeds, so that a
// (instance, seed) pair is the same start for all of them. Runs with library defaults appear
// in no ranking; they are compared with the tuned ones of the same pairs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/benchmark/record.hpp>
#include <stillbase/benchmark/statistics.hpp>

namespace stillbase {

/// Indices into benchmark_precisions() that tables show: 0.012, 1e-4 and 1e-8.
inline constexpr std::size_t kShownTargets[] = {12, 25, 50};
inline constexpr std::size_t kTightestTarget = 50;

/// A share over an axis, with the 95 % percentile interval at each point: problems drawn with
/// replacement.
struct ShareCurve {
  std::vector<double> value, low, high;
};

struct OptimizerFigures {
  std::string optimizer;
  long runs = 0, unfinished = 0;            ///< unfinished: crashed, out of memory or out of time
  double hessians_per_run = 0;              ///< exact second derivatives asked for, mean
  std::vector<BootstrapInterval> solved;    ///< part of the runs, per shown target
  int problems_solved = 0;                  ///< at least once, at the tightest target
  std::map<std::string, double> by_family;  ///< part of the runs solved at the tightest target
  /// Expected running time per group, one list per shown target; infinity: never.
  std::vector<std::vector<double>> running_time;
  ShareCurve runtime_ecdf, data_profile, performance_profile;  ///< over the curves' axes
  double distinct_per_1000 = 0;    ///< distinct solutions per 1000 evaluations
  double distinct_per_second = 0;  ///< measured: differs from machine to machine
  double seconds = 0;              ///< measured: all runs together
  /// Measured: seconds of a group's runs up to success at the tightest target or end, over the
  /// number of successes; infinity: never.
  std::vector<double> seconds_to_tightest;
};

/// The optimizer of least expected running time of a group at a target.
struct Win {
  std::string group;
  std::size_t target = 0;    ///< index into kShownTargets
  std::string best, second;  ///< empty: none reached it; no second one
  double running_time = 0, second_running_time = 0;
  double sure = 0;  ///< part of the bootstrap samples in which it is the best as well
};

struct DefaultsComparison {
  std::string optimizer;
  int pairs = 0;                   ///< of (instance, seed) with both kinds of run
  double tuned = 0, defaults = 0;  ///< part of them solved at the tightest target
};

struct BenchmarkAnalysis {
  std::vector<std::string> families, groups;  ///< group: family/goal
  int problems = 0, seeds = 0;
  long budget = 0;                     ///< evaluations of a run, the largest
  std::vector<double> log_cost_axis;   ///< log10 of cost per variable: ECDF
  std::vector<double> log_kappa_axis;  ///< log10 of cost / (variables + 1): data profile
  std::vector<double> log_tau_axis;    ///< log10 of cost / cost of the best: performance profile
  std::vector<OptimizerFigures> optimizers;  ///< most solved at the tightest target first
  std::vector<Win> wins;                     ///< per group and shown target
  std::vector<DefaultsComparison> defaults;
  std::vector<std::string> solved_by_nobody;  ///< problems, at the tightest target
  /// Solved at least once, at the tightest target; empty: random search did not run.
  std::optional<int> problems_by_random_search;
};

/// What the runs are measured against: the known value of each instance, or that of the records
/// where it is lower or none is known. Of the records only points that are exact to
/// kReferenceViolation count.
std::map<std::string, double> reference_values(const std::vector<RunRecord>& records,
                                               std::map<std::string, double> best_known);

/// Resampling behind intervals and the certainty of first places.
struct AnalysisOptions {
  std::uint64_t seed = 1;  ///< fixed, so that a report does not depend on when it is made
  int resamples = 200;     ///< of the runs, for each group and target
};

/// @param references of reference_values(); an instance without one was solved by no run
BenchmarkAnalysis analyze_benchmark(const std::vector<RunRecord>& records,
                                    const std::map<std::string, double>& references,
                                    double gradient_cost, const AnalysisOptions& options = {});

}  // namespace stillbase
