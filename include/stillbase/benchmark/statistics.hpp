// From run records to the field's figures: runtimes to targets, expected running time, empirical
// distributions, data and performance profiles.
//
// Assumptions. Cost is evaluations + gradient_cost * gradients, so that methods with and without
// derivatives share one axis. A target is a precision above the best known value; a run that ends
// before it reached a target never reached it, and what it spent counts. Lower values are better.
#pragma once

#include <cstdint>
#include <vector>

#include <stillbase/benchmark/record.hpp>

namespace stillbase {

/// 51 precisions, evenly spaced in the logarithm from 10^0 to 10^-8, hardest last.
std::vector<double> benchmark_precisions();

/// One run's costs.
struct Runtime {
  std::vector<double> to_target;  ///< per target; infinity: not reached
  double spent = 0;               ///< when the run ended
};

/// Cost at which value <= best_known + precision was first reached with violation <=
/// kBenchmarkViolation.
/// What came at a higher cost than the run's budget does not count. A crashed run keeps what it
/// reached before.
Runtime runtime_of(const RunRecord& record, double best_known,
                   const std::vector<double>& precisions, double gradient_cost);

/// Expected running time: costs of all runs up to success or end, over the number of successes
/// (Auger and Hansen, CEC 2005). Infinity without a success or without runs.
double expected_running_time(const std::vector<Runtime>& runs, std::size_t target);

/// Part of all (run, target) pairs reached within each cost: the empirical distribution of
/// runtimes (Hansen et al., COCO, Optim. Methods Softw. 36, 2021). 0 without runs.
/// `dimensions`: variables of each run's problem; costs are per variable.
std::vector<double> runtime_distribution(const std::vector<Runtime>& runs,
                                         const std::vector<int>& dimensions,
                                         const std::vector<double>& costs_per_variable);

/// Costs of several optimizers on several problems: cost[problem][optimizer], infinity: unsolved.
using CostTable = std::vector<std::vector<double>>;

/// Part of the problems that an optimizer solves within kappa (n + 1), for each kappa: data profile
/// (More and Wild, SIAM J. Optim. 20, 2009). Row per optimizer.
std::vector<std::vector<double>> data_profile(const CostTable& costs,
                                              const std::vector<int>& dimensions,
                                              const std::vector<double>& kappas);

/// Part of the problems that an optimizer solves within tau times the cost of the best one:
/// performance profile (Dolan and More, Math. Program. 91, 2002). Row per optimizer. Problems that
/// no optimizer solves count as unsolved by all.
/// Caveat: two curves compare each optimizer with the best, not with each other; leaving a third
/// one out may reverse their order (Gould and Scott, ACM TOMS 43, 2016).
std::vector<std::vector<double>> performance_profile(const CostTable& costs,
                                                     const std::vector<double>& taus);

struct BootstrapInterval {
  double low = 0, value = 0, high = 0;
};

/// 95 % percentile interval of a mean over problems, problems drawn with replacement.
/// `per_problem`: one finite number each; all zero when it is empty.
BootstrapInterval bootstrap_mean(const std::vector<double>& per_problem, std::uint64_t seed,
                                 int resamples = 1000);

}  // namespace stillbase
