#include <stillbase/benchmark/statistics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

namespace {

/// Part of the rows whose figure is at most the limit, for each limit.
template <class Figure>
std::vector<double> part_within(std::size_t rows, const std::vector<double>& limits,
                                Figure figure) {
  std::vector<double> out;
  for (const double limit : limits) {
    long within = 0;
    for (std::size_t row = 0; row < rows; ++row) within += figure(row) <= limit ? 1 : 0;
    out.push_back(rows == 0 ? 0 : static_cast<double>(within) / static_cast<double>(rows));
  }
  return out;
}

std::size_t optimizers_of(const CostTable& costs) { return costs.empty() ? 0 : costs[0].size(); }

}  // namespace

std::vector<double> benchmark_precisions() {
  constexpr int kTargets = 51;
  std::vector<double> out;
  for (int i = 0; i < kTargets; ++i) out.push_back(std::pow(10, -8.0 * i / (kTargets - 1)));
  return out;
}

Runtime runtime_of(const RunRecord& record, double best_known,
                   const std::vector<double>& precisions, double gradient_cost) {
  const auto cost = [gradient_cost](long evaluations, long gradients) {
    return static_cast<double>(evaluations) + gradient_cost * static_cast<double>(gradients);
  };
  // Evaluations alone end a run: the same number for all. With derivatives it has then cost more.
  const auto budget = static_cast<double>(record.request.budget);
  Runtime out;
  out.spent = std::min(cost(record.evaluations, record.gradients), budget);
  out.to_target.assign(precisions.size(), kInfinity);
  for (const Improvement& point : record.improvements) {
    if (!(point.violation <= kBenchmarkViolation)) continue;
    if (cost(point.evaluations, point.gradients) > budget) break;
    for (std::size_t i = 0; i < precisions.size(); ++i) {
      if (point.value > best_known + precisions[i]) continue;
      out.to_target[i] = std::min(out.to_target[i], cost(point.evaluations, point.gradients));
    }
  }
  return out;
}

double expected_running_time(const std::vector<Runtime>& runs, std::size_t target) {
  double spent = 0;
  int successes = 0;
  for (const Runtime& run : runs) {
    const bool reached = std::isfinite(run.to_target[target]);
    spent += reached ? run.to_target[target] : run.spent;
    successes += reached ? 1 : 0;
  }
  return successes == 0 ? kInfinity : spent / successes;
}

std::vector<double> runtime_distribution(const std::vector<Runtime>& runs,
                                         const std::vector<int>& dimensions,
                                         const std::vector<double>& costs_per_variable) {
  std::vector<double> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const double cost : runs[i].to_target) all.push_back(cost / dimensions[i]);
  }
  return part_within(all.size(), costs_per_variable, [&](std::size_t row) { return all[row]; });
}

std::vector<std::vector<double>> data_profile(const CostTable& costs,
                                              const std::vector<int>& dimensions,
                                              const std::vector<double>& kappas) {
  std::vector<std::vector<double>> out;
  for (std::size_t s = 0; s < optimizers_of(costs); ++s) {
    out.push_back(part_within(costs.size(), kappas, [&](std::size_t problem) {
      return costs[problem][s] / (dimensions[problem] + 1);
    }));
  }
  return out;
}

std::vector<std::vector<double>> performance_profile(const CostTable& costs,
                                                     const std::vector<double>& taus) {
  std::vector<double> best;
  for (const auto& row : costs) best.push_back(*std::min_element(row.begin(), row.end()));
  std::vector<std::vector<double>> out;
  for (std::size_t s = 0; s < optimizers_of(costs); ++s) {
    out.push_back(part_within(costs.size(), taus, [&](std::size_t problem) {
      return std::isfinite(costs[problem][s]) ? costs[problem][s] / best[problem] : kInfinity;
    }));
  }
  return out;
}

BootstrapInterval bootstrap_mean(const std::vector<double>& per_problem, std::uint64_t seed,
                                 int resamples) {
  BootstrapInterval out;
  if (per_problem.empty()) return out;
  const int count = static_cast<int>(per_problem.size());
  std::vector<double> means;
  for (int r = 0; r < resamples; ++r) {
    Random random(seed, static_cast<std::uint64_t>(r));
    double sum = 0;
    for (int i = 0; i < count; ++i)
      sum += per_problem[static_cast<std::size_t>(random.index(count))];
    means.push_back(sum / count);
  }
  std::sort(means.begin(), means.end());
  const auto percentile = [&means](double part) {
    const double place = part * static_cast<double>(means.size() - 1);
    return means[static_cast<std::size_t>(std::lround(place))];
  };
  for (const double x : per_problem) out.value += x / count;
  out.low = percentile(0.025);
  out.high = percentile(0.975);
  return out;
}

}  // namespace stillbase
