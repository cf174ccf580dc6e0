#include <stillbase/benchmark/analysis.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

namespace {

/// One run with its costs, and where it belongs.
struct Run {
  const RunRecord* record;
  Runtime runtime;
  std::string group;
  double reference;  ///< value of the instance

  const std::string& instance() const { return record->request.instance; }
  bool solved(std::size_t target) const { return std::isfinite(runtime.to_target[target]); }
};

using RunsByOptimizer = std::map<std::string, std::vector<Run>>;

void add_once(std::vector<std::string>& list, const std::string& entry) {
  if (std::find(list.begin(), list.end(), entry) == list.end()) list.push_back(entry);
}

std::vector<double> axis(double low, double high, int steps) {
  std::vector<double> out;
  for (int i = 0; i <= steps; ++i) out.push_back(low + (high - low) * i / steps);
  return out;
}

std::vector<double> powers_of_ten(const std::vector<double>& exponents) {
  std::vector<double> out;
  for (const double exponent : exponents) out.push_back(std::pow(10, exponent));
  return out;
}

/// Mean over problems of the part of a problem's runs that solve it.
BootstrapInterval part_solved(const std::vector<Run>& runs, std::size_t target,
                              std::uint64_t seed) {
  std::map<std::string, std::pair<double, double>> by_problem;  // solved, runs
  for (const Run& run : runs) {
    auto& [solved, count] = by_problem[run.instance()];
    solved += run.solved(target) ? 1 : 0;
    count += 1;
  }
  std::vector<double> parts;
  for (const auto& entry : by_problem) parts.push_back(entry.second.first / entry.second.second);
  return bootstrap_mean(parts, seed);
}

/// Seconds until the run reached the tightest target, or ended.
double seconds_of(const Run& run) {
  if (!run.solved(kTightestTarget)) return run.record->seconds;
  const double wanted = run.reference + benchmark_precisions()[kTightestTarget];
  for (const Improvement& point : run.record->improvements) {
    if (point.violation <= kBenchmarkViolation && point.value <= wanted) return point.seconds;
  }
  return run.record->seconds;
}

std::vector<double> seconds_by_group(const std::vector<Run>& runs,
                                     const std::vector<std::string>& groups) {
  std::vector<double> out;
  for (const std::string& group : groups) {
    double seconds = 0;
    int successes = 0;
    for (const Run& run : runs) {
      if (run.group != group) continue;
      seconds += seconds_of(run);
      successes += run.solved(kTightestTarget) ? 1 : 0;
    }
    out.push_back(successes > 0 ? seconds / successes : kInfinity);
  }
  return out;
}

std::vector<Runtime> runtimes_of_group(const std::vector<Run>& runs, const std::string& group) {
  std::vector<Runtime> out;
  for (const Run& run : runs) {
    if (run.group == group) out.push_back(run.runtime);
  }
  return out;
}

OptimizerFigures figures_of(const std::string& optimizer, const std::vector<Run>& runs,
                            const BenchmarkAnalysis& analysis, const AnalysisOptions& options) {
  OptimizerFigures out;
  out.optimizer = optimizer;
  std::set<std::string> solved;
  std::map<std::string, std::pair<double, double>> by_family;
  double distinct = 0, evaluations = 0;
  for (const Run& run : runs) {
    const RunRecord& record = *run.record;
    ++out.runs;
    const bool by_the_clock = record.stop_reason == nlp::to_string(nlp::StopReason::Deadline);
    out.unfinished += record.end == RunEnd::Finished && !by_the_clock ? 0 : 1;
    if (run.solved(kTightestTarget)) solved.insert(run.instance());
    by_family[record.family].first += run.solved(kTightestTarget) ? 1 : 0;
    by_family[record.family].second += 1;
    distinct += static_cast<double>(record.distinct_solutions);
    out.hessians_per_run += static_cast<double>(record.hessians);
    evaluations += static_cast<double>(record.evaluations);
    out.seconds += record.seconds;
  }
  for (const std::size_t target : kShownTargets) {
    out.solved.push_back(part_solved(runs, target, options.seed));
    std::vector<double> times;
    for (const std::string& group : analysis.groups) {
      times.push_back(expected_running_time(runtimes_of_group(runs, group), target));
    }
    out.running_time.push_back(std::move(times));
  }
  out.hessians_per_run /= std::max(1.0, static_cast<double>(out.runs));
  out.seconds_to_tightest = seconds_by_group(runs, analysis.groups);
  out.problems_solved = static_cast<int>(solved.size());
  for (const auto& [family, part] : by_family) out.by_family[family] = part.first / part.second;
  if (evaluations > 0) out.distinct_per_1000 = 1000 * distinct / evaluations;
  if (out.seconds > 0) out.distinct_per_second = distinct / out.seconds;
  return out;
}

using Pair = std::pair<std::string, std::uint64_t>;  ///< instance, seed

Pair pair_of(const Run& run) { return {run.instance(), run.record->request.seed}; }

/// The runs of some instances, as the profiles take them; an (instance, seed) pair is a problem.
struct ProfileRuns {
  CostTable costs;             ///< at the tightest target: row per pair, column per optimizer
  std::vector<int> variables;  ///< of each pair
  std::vector<std::vector<Runtime>> runtimes;       ///< per optimizer
  std::vector<std::vector<int>> runtime_variables;  ///< of each of these runs
};

/// @param instance empty: all
ProfileRuns profile_runs(const RunsByOptimizer& runs, const BenchmarkAnalysis& analysis,
                         const std::string& instance) {
  const std::size_t count = analysis.optimizers.size();
  std::map<Pair, std::size_t> rows;
  ProfileRuns out;
  out.runtimes.resize(count);
  out.runtime_variables.resize(count);
  for (std::size_t s = 0; s < count; ++s) {
    for (const Run& run : runs.at(analysis.optimizers[s].optimizer)) {
      if (!instance.empty() && run.instance() != instance) continue;
      const auto [row, is_new] = rows.insert({pair_of(run), rows.size()});
      if (is_new) {
        out.costs.emplace_back(count, kInfinity);
        out.variables.push_back(run.record->variables);
      }
      out.costs[row->second][s] = run.runtime.to_target[kTightestTarget];
      out.runtimes[s].push_back(run.runtime);
      out.runtime_variables[s].push_back(run.record->variables);
    }
  }
  return out;
}

/// Fills in one curve of every optimizer. `shares` gives the curves of a part of the runs.
void add_curve(ShareCurve OptimizerFigures::*curve, const ProfileRuns& all,
               const std::vector<ProfileRuns>& by_instance, const AnalysisOptions& options,
               BenchmarkAnalysis& analysis,
               const std::function<std::vector<std::vector<double>>(const ProfileRuns&)>& shares) {
  const std::vector<std::vector<double>> values = shares(all);
  std::vector<std::vector<std::vector<double>>> parts;
  for (const ProfileRuns& runs : by_instance) parts.push_back(shares(runs));
  for (std::size_t s = 0; s < values.size(); ++s) {
    ShareCurve& out = analysis.optimizers[s].*curve;
    out.value = values[s];
    for (std::size_t i = 0; i < out.value.size(); ++i) {
      std::vector<double> per_problem;
      for (const auto& part : parts) per_problem.push_back(part[s][i]);
      const BootstrapInterval band = bootstrap_mean(per_problem, options.seed, options.resamples);
      out.low.push_back(std::min(band.low, out.value[i]));
      out.high.push_back(std::max(band.high, out.value[i]));
    }
  }
}

/// Runtime distributions; data and performance profiles at the tightest target.
void add_profiles(const RunsByOptimizer& runs, const std::vector<std::string>& instances,
                  const AnalysisOptions& options, BenchmarkAnalysis& analysis) {
  const ProfileRuns all = profile_runs(runs, analysis, "");
  std::vector<ProfileRuns> by_instance;
  for (const std::string& instance : instances) {
    by_instance.push_back(profile_runs(runs, analysis, instance));
  }
  add_curve(
      &OptimizerFigures::runtime_ecdf, all, by_instance, options, analysis,
      [costs = powers_of_ten(analysis.log_cost_axis)](const ProfileRuns& part) {
        std::vector<std::vector<double>> out;
        for (std::size_t s = 0; s < part.runtimes.size(); ++s) {
          out.push_back(runtime_distribution(part.runtimes[s], part.runtime_variables[s], costs));
        }
        return out;
      });
  add_curve(&OptimizerFigures::data_profile, all, by_instance, options, analysis,
            [kappas = powers_of_ten(analysis.log_kappa_axis)](const ProfileRuns& part) {
              return data_profile(part.costs, part.variables, kappas);
            });
  add_curve(&OptimizerFigures::performance_profile, all, by_instance, options, analysis,
            [taus = powers_of_ten(analysis.log_tau_axis)](const ProfileRuns& part) {
              return performance_profile(part.costs, taus);
            });
}

/// The optimizer of least expected running time; their number when none is finite.
std::size_t fastest(const std::vector<double>& times, std::size_t except) {
  std::size_t best = times.size();
  for (std::size_t s = 0; s < times.size(); ++s) {
    if (s == except || !std::isfinite(times[s])) continue;
    if (best == times.size() || times[s] < times[best]) best = s;
  }
  return best;
}

/// Part of the resamplings of a group's (instance, seed) pairs in which `best` is the fastest too.
double sureness(const std::vector<std::map<Pair, const Run*>>& runs_of, std::size_t target,
                std::size_t best, const AnalysisOptions& options) {
  std::vector<Pair> pairs;
  for (const auto& entry : runs_of[best]) pairs.push_back(entry.first);
  int same = 0;
  for (int r = 0; r < options.resamples; ++r) {
    Random random(options.seed, static_cast<std::uint64_t>(r));
    std::vector<double> spent(runs_of.size(), 0), successes(runs_of.size(), 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Pair& pair =
          pairs[static_cast<std::size_t>(random.index(static_cast<int>(pairs.size())))];
      for (std::size_t s = 0; s < runs_of.size(); ++s) {
        const auto at = runs_of[s].find(pair);
        if (at == runs_of[s].end()) continue;
        const Run& run = *at->second;
        spent[s] += run.solved(target) ? run.runtime.to_target[target] : run.runtime.spent;
        successes[s] += run.solved(target) ? 1 : 0;
      }
    }
    std::vector<double> times;
    for (std::size_t s = 0; s < runs_of.size(); ++s) {
      times.push_back(successes[s] > 0 ? spent[s] / successes[s] : kInfinity);
    }
    same += fastest(times, times.size()) == best ? 1 : 0;
  }
  return static_cast<double>(same) / options.resamples;
}

void add_wins(const RunsByOptimizer& runs, const AnalysisOptions& options,
              BenchmarkAnalysis& analysis) {
  const std::size_t count = analysis.optimizers.size();
  for (std::size_t g = 0; g < analysis.groups.size(); ++g) {
    std::vector<std::map<Pair, const Run*>> runs_of(count);
    for (std::size_t s = 0; s < count; ++s) {
      for (const Run& run : runs.at(analysis.optimizers[s].optimizer)) {
        if (run.group == analysis.groups[g]) runs_of[s][pair_of(run)] = &run;
      }
    }
    for (std::size_t t = 0; t < std::size(kShownTargets); ++t) {
      std::vector<double> times;
      for (const OptimizerFigures& figures : analysis.optimizers) {
        times.push_back(figures.running_time[t][g]);
      }
      Win win;
      win.group = analysis.groups[g];
      win.target = t;
      const std::size_t best = fastest(times, count), second = fastest(times, best);
      if (best < count) {
        win.best = analysis.optimizers[best].optimizer;
        win.running_time = times[best];
        win.sure = sureness(runs_of, kShownTargets[t], best, options);
      }
      if (best < count && second < count) {
        win.second = analysis.optimizers[second].optimizer;
        win.second_running_time = times[second];
      }
      analysis.wins.push_back(std::move(win));
    }
  }
}

void add_defaults(const RunsByOptimizer& tuned, const RunsByOptimizer& with_defaults,
                  BenchmarkAnalysis& analysis) {
  for (const auto& [optimizer, runs] : with_defaults) {
    const auto others = tuned.find(optimizer);
    if (others == tuned.end()) continue;
    std::map<Pair, const Run*> by_pair;
    for (const Run& run : others->second) by_pair[pair_of(run)] = &run;
    DefaultsComparison out;
    out.optimizer = optimizer;
    for (const Run& run : runs) {
      const auto at = by_pair.find(pair_of(run));
      if (at == by_pair.end()) continue;
      ++out.pairs;
      out.defaults += run.solved(kTightestTarget) ? 1 : 0;
      out.tuned += at->second->solved(kTightestTarget) ? 1 : 0;
    }
    if (out.pairs == 0) continue;
    out.defaults /= out.pairs;
    out.tuned /= out.pairs;
    analysis.defaults.push_back(out);
  }
}

}  // namespace

std::map<std::string, double> reference_values(const std::vector<RunRecord>& records,
                                               std::map<std::string, double> best) {
  for (const RunRecord& record : records) {
    for (const Improvement& point : record.improvements) {
      if (!(point.violation <= kReferenceViolation)) continue;
      const auto [at, is_new] = best.insert({record.request.instance, point.value});
      if (!is_new) at->second = std::min(at->second, point.value);
    }
  }
  return best;
}

BenchmarkAnalysis analyze_benchmark(const std::vector<RunRecord>& records,
                                    const std::map<std::string, double>& references,
                                    double gradient_cost, const AnalysisOptions& options) {
  const std::vector<double> precisions = benchmark_precisions();
  BenchmarkAnalysis out;
  out.log_cost_axis = axis(0, 4, 80);
  out.log_kappa_axis = axis(0, 4, 80);
  out.log_tau_axis = axis(0, 3, 60);
  RunsByOptimizer tuned, with_defaults;
  std::vector<std::string> instances;
  std::set<std::uint64_t> seeds;
  std::set<std::string> solved;
  for (const RunRecord& record : records) {
    const auto value = references.find(record.request.instance);
    const double reference = value == references.end() ? -kInfinity : value->second;
    Run run{&record, runtime_of(record, reference, precisions, gradient_cost),
            record.family + "/" + record.goal, reference};
    add_once(out.families, record.family);
    add_once(out.groups, run.group);
    add_once(instances, record.request.instance);
    seeds.insert(record.request.seed);
    out.budget = std::max(out.budget, record.request.budget);
    if (run.solved(kTightestTarget)) solved.insert(record.request.instance);
    (record.request.library_defaults ? with_defaults : tuned)[record.request.optimizer].push_back(
        std::move(run));
  }
  out.problems = static_cast<int>(instances.size());
  out.seeds = static_cast<int>(seeds.size());
  for (const auto& [optimizer, runs] : tuned) {
    out.optimizers.push_back(figures_of(optimizer, runs, out, options));
    if (optimizer == "random-search") {
      out.problems_by_random_search = out.optimizers.back().problems_solved;
    }
  }
  std::stable_sort(out.optimizers.begin(), out.optimizers.end(), [](const auto& a, const auto& b) {
    return a.solved.back().value > b.solved.back().value;
  });
  add_profiles(tuned, instances, options, out);
  add_wins(tuned, options, out);
  add_defaults(tuned, with_defaults, out);
  for (const std::string& instance : instances) {
    if (solved.count(instance) == 0) out.solved_by_nobody.push_back(instance);
  }
  return out;
}

}  // namespace stillbase
