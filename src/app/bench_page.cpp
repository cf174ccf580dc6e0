#include "app/bench_page.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/report/plot.hpp>

namespace stillbase::app {

namespace {

std::string percent(double part) { return fmt::format("{:.0f} %", 100 * part); }

std::string percent(const BootstrapInterval& part) {
  return fmt::format("{:.0f} % [{:.0f}, {:.0f}]", 100 * part.value, 100 * part.low,
                     100 * part.high);
}

std::string cost(double x) { return std::isfinite(x) ? fmt::format("{:.0f}", x) : "never"; }

std::string precision_words(std::size_t target) {
  return fmt::format("{:.2g}", benchmark_precisions()[target]);
}

/// Rows are the groups of problems, columns the optimizers.
TextTable group_table(
    const BenchmarkAnalysis& analysis,
    const std::function<std::string(const OptimizerFigures&, std::size_t)>& cell) {
  TextTable table;
  table.header = {"problems"};
  for (const OptimizerFigures& figures : analysis.optimizers) {
    table.header.push_back(figures.optimizer);
  }
  for (std::size_t g = 0; g < analysis.groups.size(); ++g) {
    std::vector<std::string> row = {analysis.groups[g]};
    for (const OptimizerFigures& figures : analysis.optimizers) row.push_back(cell(figures, g));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// "nlopt-slsqp: 3, ipopt: 1"
std::string count_list(const std::map<std::string, int>& counts) {
  std::vector<std::string> words;
  words.reserve(counts.size());
  for (const auto& [name, count] : counts) words.push_back(fmt::format("{}: {}", name, count));
  return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

PageFigure figure(const BenchmarkAnalysis& analysis, const std::string& file,
                  const std::string& title, const std::string& x_label, const std::string& y_label,
                  const std::vector<double>& x, ShareCurve OptimizerFigures::*curve) {
  PlotPanel panel;
  panel.title = title;
  panel.x_label = x_label;
  panel.y_label = y_label;
  panel.x = x;
  for (const OptimizerFigures& figures : analysis.optimizers) {
    const ShareCurve& shares = figures.*curve;
    if (panel.series.size() < 18) {
      panel.series.push_back({figures.optimizer, shares.value, shares.low, shares.high});
    }
  }
  return {file, title, panel};
}

PageSection overview(const BenchmarkAnalysis& analysis, double gradient_cost) {
  PageSection out;
  out.heading = "Solved runs";
  out.paragraphs.push_back(fmt::format(
      "{} problems, {} seeds each. A run solves a problem to a precision when a point with "
      "violation at most {:g} is no worse than the best known value by more than it, as judged by "
      "our own evaluation; the value is the objective's norm over its typical size. Intervals: 95 "
      "% bootstrap over problems. Cost: evaluations + {:g} per gradient, at most {}.",
      analysis.problems, analysis.seeds, kBenchmarkViolation, gradient_cost, analysis.budget));
  for (const OptimizerFigures& figures : analysis.optimizers) {
    if (!(figures.hessians_per_run > 0)) continue;
    out.paragraphs.push_back(
        fmt::format("Exact second derivatives are not in the cost: {} asked for them {:.0f} times "
                    "in a run.",
                    figures.optimizer, figures.hessians_per_run));
  }
  out.paragraphs.emplace_back(
      "Not finished: crashed, out of memory, or stopped at the time limit. Distinct: solutions "
      "that are "
      "feasible and optimal to first order, more than 1e-4 apart; points of a continuum count "
      "each.");
  out.table.header = {"optimizer", "runs"};
  for (const std::size_t target : kShownTargets) {
    out.table.header.push_back("to " + precision_words(target));
  }
  for (const char* column : {"problems", "not finished", "distinct per 1000 evaluations"}) {
    out.table.header.emplace_back(column);
  }
  for (const OptimizerFigures& figures : analysis.optimizers) {
    std::vector<std::string> row = {figures.optimizer, std::to_string(figures.runs)};
    for (const BootstrapInterval& part : figures.solved) row.push_back(percent(part));
    row.push_back(fmt::format("{}/{}", figures.problems_solved, analysis.problems));
    row.push_back(std::to_string(figures.unfinished));
    row.push_back(fmt::format("{:.1f}", figures.distinct_per_1000));
    out.table.rows.push_back(std::move(row));
  }
  return out;
}

/// The sentence that names a default: README.md repeats it.
PageSection recommendation(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Which one by default";
  if (analysis.optimizers.size() < 2) {
    out.paragraphs = {"One optimizer alone says nothing about a choice."};
    return out;
  }
  const OptimizerFigures& first = analysis.optimizers[0];
  const OptimizerFigures& second = analysis.optimizers[1];
  const std::string extent = fmt::format("({} problems, {} seeds, a cost of {} evaluations)",
                                         analysis.problems, analysis.seeds, analysis.budget);
  const std::string precision = precision_words(kTightestTarget);
  if (first.solved.back().value == 0) {
    out.paragraphs.push_back(fmt::format(
        "No run reached {}, so that nothing is said of a choice {}.", precision, extent));
  } else if (first.solved.back().value == second.solved.back().value) {
    out.paragraphs.push_back(
        fmt::format("{} and {} solve {} of their runs to {}, and none more {}.", first.optimizer,
                    second.optimizer, percent(first.solved.back()), precision, extent));
  } else {
    out.paragraphs.push_back(
        fmt::format("By default {}: it solves {} of its runs to {}, more than any other; {} "
                    "follows with {} {}.",
                    first.optimizer, percent(first.solved.back()), precision, second.optimizer,
                    percent(second.solved.back()), extent));
  }
  if (analysis.solved_by_nobody.empty()) return out;
  std::string unsolved = fmt::format("No optimizer solved {} of {} problems",
                                     analysis.solved_by_nobody.size(), analysis.problems);
  if (analysis.problems_by_random_search) {
    unsolved += fmt::format("; random search solved {}", *analysis.problems_by_random_search);
  }
  out.paragraphs.push_back(unsolved + ".");
  return out;
}

/// How the two that solve most compare in time, and who finds most per second.
std::string speed_words(const BenchmarkAnalysis& analysis) {
  if (analysis.optimizers.size() < 2) return "One optimizer alone.";
  const auto words = [](const OptimizerFigures& figures) {
    return fmt::format("{:.0f}", figures.distinct_per_second);
  };
  const OptimizerFigures &first = analysis.optimizers[0], &second = analysis.optimizers[1];
  const auto most = std::max_element(
      analysis.optimizers.begin(), analysis.optimizers.end(),
      [](const auto& a, const auto& b) { return a.distinct_per_second < b.distinct_per_second; });
  if (most->distinct_per_second == 0) return "No solution was found.";
  std::string out = fmt::format(
      "In a second {} finds {} distinct solutions (points of a continuum counted each) and {} {}",
      first.optimizer, words(first), second.optimizer, words(second));
  const bool is_named = most - analysis.optimizers.begin() < 2;
  if (!is_named) out += fmt::format("; {} finds most, {}", most->optimizer, words(*most));
  return out + ".";
}

PageSection wins(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Where each wins";
  out.paragraphs = {
      "The optimizer of least expected running time on each kind of problem, the next one with its "
      "multiple of that time, and the part of bootstrap samples of the runs in which it comes out "
      "first as well."};
  out.table.header = {"problems", "to", "first", "cost", "sure", "second", "times the cost"};
  std::map<std::string, int> count;
  for (const Win& win : analysis.wins) {
    const std::string target = precision_words(kShownTargets[win.target]);
    if (win.best.empty()) {
      out.table.rows.push_back({win.group, target, "none", "never", "", "", ""});
      continue;
    }
    ++count[win.best];
    const bool has_second = !win.second.empty();
    out.table.rows.push_back(
        {win.group, target, win.best, cost(win.running_time), percent(win.sure),
         has_second ? win.second : "none",
         has_second ? fmt::format("{:.1f}", win.second_running_time / win.running_time) : ""});
  }
  out.paragraphs.push_back(
      fmt::format("First places of {}: {}.", analysis.wins.size(), count_list(count)));
  return out;
}

PageSection families(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Success by family";
  out.paragraphs = {"Part of the runs that reach " + precision_words(kTightestTarget) + "."};
  out.table.header = {"optimizer"};
  for (const std::string& family : analysis.families) out.table.header.push_back(family);
  for (const OptimizerFigures& figures : analysis.optimizers) {
    std::vector<std::string> row = {figures.optimizer};
    for (const std::string& family : analysis.families) {
      const auto at = figures.by_family.find(family);
      row.push_back(at == figures.by_family.end() ? "" : percent(at->second));
    }
    out.table.rows.push_back(std::move(row));
  }
  return out;
}

PageSection running_times(const BenchmarkAnalysis& analysis, std::size_t shown) {
  PageSection out;
  out.heading = "Expected running time to " + precision_words(kShownTargets[shown]);
  out.paragraphs = {
      "Cost of all runs of a kind of problem up to success or end, over the number of successes."};
  out.table = group_table(analysis, [shown](const OptimizerFigures& figures, std::size_t g) {
    return cost(figures.running_time[shown][g]);
  });
  return out;
}

PageSection curves(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Profiles";
  out.paragraphs = {
      "Runtimes: part of all (run, target) pairs reached, over 51 targets from 1 to 1e-8. Data "
      "profile (More and Wild, 2009) and performance profile (Dolan and More, 2002) at the "
      "tightest target, one problem per instance and seed. Bands: 95 % bootstrap over problems.",
      "Caveat of performance profiles: each curve compares an optimizer with the best of all, not "
      "two optimizers with each other; removing a third one can reverse the order of two "
      "curves (Gould and Scott, 2016)."};
  out.figures = {
      figure(analysis, "ecdf.svg", "Runtimes over 51 targets", "log10 (cost / variables)",
             "part of (run, target) pairs", analysis.log_cost_axis,
             &OptimizerFigures::runtime_ecdf),
      figure(analysis, "data_profile.svg", "Data profile at 1e-8", "log10 (cost / (variables + 1))",
             "part of problems", analysis.log_kappa_axis, &OptimizerFigures::data_profile),
      figure(analysis, "performance_profile.svg", "Performance profile at 1e-8",
             "log10 (cost / cost of the best)", "part of problems", analysis.log_tau_axis,
             &OptimizerFigures::performance_profile)};
  return out;
}

PageSection defaults(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Stated tuning against the library's defaults";
  out.paragraphs = {"Part of the same starts solved to " + precision_words(kTightestTarget) + "."};
  out.table.header = {"optimizer", "starts", "tuned", "defaults"};
  for (const DefaultsComparison& row : analysis.defaults) {
    out.table.rows.push_back(
        {row.optimizer, std::to_string(row.pairs), percent(row.tuned), percent(row.defaults)});
  }
  return out;
}

PageSection unsolved(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Unsolved problems";
  out.paragraphs = {analysis.solved_by_nobody.empty()
                        ? "None: every problem was solved by some optimizer that ran."
                        : fmt::format("{}.", fmt::join(analysis.solved_by_nobody, ", "))};
  return out;
}

/// The figures that do not depend on the machine: the same for the same command.
Page bench_page(const BenchmarkAnalysis& analysis, double gradient_cost) {
  Page page;
  page.title = "Optimizers on capture problems";
  page.sections = {overview(analysis, gradient_cost), recommendation(analysis), wins(analysis),
                   families(analysis)};
  for (std::size_t shown = 0; shown < std::size(kShownTargets); ++shown) {
    page.sections.push_back(running_times(analysis, shown));
  }
  page.sections.push_back(curves(analysis));
  if (!analysis.defaults.empty()) page.sections.push_back(defaults(analysis));
  page.sections.push_back(unsolved(analysis));
  return page;
}

/// The figures in seconds.
Page bench_times_page(const BenchmarkAnalysis& analysis) {
  PageSection out;
  out.heading = "Seconds";
  out.paragraphs = {"Measured, so different on every machine and in every run.",
                    speed_words(analysis)};
  out.table.header = {"optimizer", "runs", "seconds", "seconds per run", "distinct per second"};
  for (const OptimizerFigures& figures : analysis.optimizers) {
    out.table.rows.push_back(
        {figures.optimizer, std::to_string(figures.runs), fmt::format("{:.1f}", figures.seconds),
         fmt::format("{:.3f}", figures.seconds / static_cast<double>(figures.runs)),
         fmt::format("{:.0f}", figures.distinct_per_second)});
  }
  PageSection times;
  times.heading = "Seconds to " + precision_words(kTightestTarget);
  times.paragraphs = {
      "Seconds of all runs of a kind of problem up to success or end, over the number of "
      "successes."};
  times.table = group_table(analysis, [](const OptimizerFigures& figures, std::size_t g) {
    const double seconds = figures.seconds_to_tightest[g];
    return std::isfinite(seconds) ? fmt::format("{:.3g}", seconds) : "never";
  });
  std::map<std::string, int> fastest;
  for (std::size_t g = 0; g < analysis.groups.size(); ++g) {
    const auto best = std::min_element(analysis.optimizers.begin(), analysis.optimizers.end(),
                                       [g](const OptimizerFigures& a, const OptimizerFigures& b) {
                                         return a.seconds_to_tightest[g] < b.seconds_to_tightest[g];
                                       });
    if (best == analysis.optimizers.end() || !std::isfinite(best->seconds_to_tightest[g])) continue;
    ++fastest[best->optimizer];
  }
  times.paragraphs.push_back(fmt::format("First of {} kinds of problems: {}.",
                                         analysis.groups.size(), count_list(fastest)));
  return {"Optimizers on capture problems: time", {out, times}};
}

/// One row per record.
TextTable bench_table(const std::vector<RunRecord>& records,
                      const std::map<std::string, double>& references, double gradient_cost) {
  TextTable out;
  out.header = {"instance",    "family",    "goal",     "variables", "equations",
                "optimizer",   "seed",      "value",    "violation", "reference",
                "evaluations", "gradients", "hessians", "starts",    "distinct_solutions",
                "stop_reason"};
  for (const std::size_t target : kShownTargets) {
    out.header.push_back("cost_to_" + precision_words(target));
  }
  for (const RunRecord& record : records) {
    const auto known = references.find(record.request.instance);
    const bool has_point = !record.improvements.empty();
    std::vector<std::string> row = {
        record.request.instance,
        record.family,
        record.goal,
        std::to_string(record.variables),
        std::to_string(record.equations),
        label_of(record.request),
        std::to_string(record.request.seed),
        has_point ? fmt::format("{}", record.improvements.back().value) : "",
        has_point ? fmt::format("{}", record.improvements.back().violation) : "",
        known == references.end() ? "" : fmt::format("{}", known->second),
        std::to_string(record.evaluations),
        std::to_string(record.gradients),
        std::to_string(record.hessians),
        std::to_string(record.starts),
        std::to_string(record.distinct_solutions),
        record.stop_reason};
    const Runtime runtime =
        runtime_of(record, known == references.end() ? -HUGE_VAL : known->second,
                   benchmark_precisions(), gradient_cost);
    for (const std::size_t target : kShownTargets) {
      const double at = runtime.to_target[target];
      row.push_back(std::isfinite(at) ? fmt::format("{}", at) : "");
    }
    out.rows.push_back(std::move(row));
  }
  return out;
}

constexpr std::size_t kMaxRecordBytes = std::size_t{4} << 30;

std::string in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

BenchmarkAnalysis analysis_of(const BenchFolder& content) {
  return analyze_benchmark(content.records, content.references.values,
                           content.references.gradient_cost);
}

}  // namespace

BenchFolder read_bench_folder(const std::string& folder) {
  const std::string path = in(folder, "bench.json"), records = in(folder, "records.jsonl");
  return {read_bench_references(read_text_file(path), path),
          read_records(read_text_file(records, kMaxRecordBytes), records)};
}

void write_bench_folder(const std::string& folder, const BenchFolder& content,
                        const std::string& record_lines) {
  const auto write = [&folder](const std::string& name, const std::string& text) {
    write_file_atomically(in(folder, name), text, true);
  };
  const auto& [references, records] = content;
  write("bench.json", bench_references_to_json(references));
  write("records.jsonl", record_lines);
  write("runs.csv",
        table_to_csv(bench_table(records, references.values, references.gradient_cost)));
  const BenchmarkAnalysis analysis = analysis_of(content);
  const Page page = bench_page(analysis, references.gradient_cost);
  for (const PageSection& section : page.sections) {
    for (const PageFigure& figure : section.figures)
      write(figure.file, figure.panel.series.empty() ? "" : plot_svg({figure.panel}));
  }
  write("report.md", page_to_markdown(page));
  write("times.md", page_to_markdown(bench_times_page(analysis)));
}

Page bench_folder_page(const BenchFolder& content) {
  const BenchmarkAnalysis analysis = analysis_of(content);
  Page page = bench_page(analysis, content.references.gradient_cost);
  for (PageSection& section : bench_times_page(analysis).sections) {
    page.sections.push_back(std::move(section));
  }
  return page;
}

}  // namespace stillbase::app
