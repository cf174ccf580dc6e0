#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <stillbase/verification/trials.hpp>

namespace stillbase {
namespace {

struct Output {
  const char *name, *unit;
  double TrialOutcome::*value;
};
constexpr Output kOutputs[] = {
    {"impulse", "N s", &TrialOutcome::impulse},
    {"objective", nullptr, &TrialOutcome::objective},  // its unit is the problem's
    {"base_rate_jump", "rad/s", &TrialOutcome::base_rate_jump},
    {"residual_base_rate", "rad/s", &TrialOutcome::residual_base_rate},
    {"attitude_turned", "rad", &TrialOutcome::attitude_turned},
    {"peak_rate_part", "1", &TrialOutcome::peak_rate_part},
    {"peak_torque_part", "1", &TrialOutcome::peak_torque_part},
};

/// @param sorted ascending, not empty
double percentile(const std::vector<double>& sorted, double p) {
  const double at = p * static_cast<double>(sorted.size() - 1);
  const std::size_t i = static_cast<std::size_t>(at);
  const std::size_t j = std::min(i + 1, sorted.size() - 1);
  return sorted[i] + (at - static_cast<double>(i)) * (sorted[j] - sorted[i]);
}

Spread spread(const Output& output, const std::string& unit, const std::vector<double>& values,
              int first) {
  Spread s;
  s.name = output.name;
  s.unit = unit;
  const double N = static_cast<double>(values.size());
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / N;
  double squares = 0;
  for (const double x : values) squares += (x - s.mean) * (x - s.mean);
  if (N > 1) s.mean_half_width = 1.959963984540054 * std::sqrt(squares / (N - 1) / N);
  const auto worst = std::max_element(values.begin(), values.end());
  s.worst = *worst;
  s.worst_trial = first + static_cast<int>(worst - values.begin());
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  s.p5 = percentile(sorted, 0.05);
  s.p50 = percentile(sorted, 0.5);
  s.p95 = percentile(sorted, 0.95);
  s.p99 = percentile(sorted, 0.99);
  return s;
}

/// Ranks from 0; equal values share the mean of theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
    for (std::size_t k = i; k < j; ++k) rank[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    i = j;
  }
  return rank;
}

/// Pearson's correlation; 0 where one does not vary.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double N = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / N;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / N;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

std::vector<std::pair<std::string, int>> count_failures(const std::vector<TrialOutcome>& outcomes,
                                                        const PostImpactSpec& spec) {
  std::map<std::string, int> counts;
  for (const TrialOutcome& outcome : outcomes) {
    if (const std::string failure = trial_failure(outcome, spec); !failure.empty()) {
      ++counts[failure];
    }
  }
  std::vector<std::pair<std::string, int>> out(counts.begin(), counts.end());
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

Interval wilson_interval(int successes, int trials, double z) {
  if (trials <= 0) return {};
  const double N = trials, p = successes / N, zz = z * z / N;
  const double centre = (p + zz / 2) / (1 + zz);
  const double half = z * std::sqrt(p * (1 - p) / N + zz / (4 * N)) / (1 + zz);
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

TrialReport summarize_trials(const std::vector<TrialOutcome>& outcomes, int first,
                             const std::string& objective_unit) {
  TrialReport report;
  report.trials = static_cast<int>(outcomes.size());
  if (outcomes.empty()) return report;
  for (const TrialOutcome& outcome : outcomes) {
    report.hits += outcome.hit;
    report.finished += outcome.finished;
    report.successes += outcome.success;
  }
  report.success_probability = static_cast<double>(report.successes) / report.trials;
  const Interval interval = wilson_interval(report.successes, report.trials);
  report.success_lower = interval.lower;
  report.success_upper = interval.upper;

  const std::vector<std::string> names = trial_input_names();
  std::vector<std::vector<double>> input_ranks;
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::vector<double> values;
    for (const TrialOutcome& outcome : outcomes) values.push_back(outcome.inputs.at(k));
    input_ranks.push_back(ranks(values));
  }
  for (const Output& output : kOutputs) {
    std::vector<double> values;
    for (const TrialOutcome& outcome : outcomes) values.push_back(outcome.*output.value);
    const std::string unit = output.unit == nullptr ? objective_unit : output.unit;
    report.spreads.push_back(spread(output, unit, values, first));
    const std::vector<double> output_ranks = ranks(values);
    std::vector<Sensitivity> found;
    for (std::size_t k = 0; k < names.size(); ++k) {
      found.push_back({output.name, names[k], correlation(input_ranks[k], output_ranks)});
    }
    std::stable_sort(found.begin(), found.end(), [](const Sensitivity& a, const Sensitivity& b) {
      return std::abs(a.rank_correlation) > std::abs(b.rank_correlation);
    });
    report.sensitivities.insert(report.sensitivities.end(), found.begin(), found.end());
  }
  return report;
}

}  // namespace stillbase
