// stillbase plan: a problem file in, a plan file out.
#include <charconv>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/report/plot.hpp>
#include <stillbase/search/search.hpp>
#include <stillbase/search/trade_off.hpp>

#include "app/after_impact_advice.hpp"
#include "app/check_report.hpp"
#include "app/command_line.hpp"
#include "app/plan_summary.hpp"
#include "app/window_words.hpp"
#include "app/words.hpp"
#include "core/escape.hpp"
#include "io/fields/results.hpp"
#include "io/problem_reader.hpp"

namespace stillbase::app {

namespace {

struct PlanRequest {
  std::string problem, optimizer, pareto, starts;
  std::optional<std::uint64_t> seed;
  int jobs = 0;
  double time_limit = 0;
  OutputFile output;
  bool json = false, is_verbose = false;
};

int starts_of(const std::string& text) {
  if (text == "auto") return kAutomaticStarts;
  int starts = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), starts);
  if (error != std::errc() || end != text.data() + text.size() || starts < 1 ||
      starts > kMaxStarts) {
    throw CommandLineError(
        fmt::format("--starts {}: must be from 1 to {}, or auto", text, kMaxStarts));
  }
  return starts;
}

ObjectiveQuantity quantity_of(const std::string& word) {
  check_known("--pareto " + word, word, io::words_of(io::objective_names()));
  return *io::value_of(io::objective_names(), word);
}

std::pair<ObjectiveQuantity, ObjectiveQuantity> quantities_of(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw CommandLineError("--pareto: two quantities, as in A,B");
  const auto both =
      std::pair(quantity_of(text.substr(0, comma)), quantity_of(text.substr(comma + 1)));
  if (both.first == both.second) throw CommandLineError("--pareto: two different quantities");
  return both;
}

/// A quantity at a time after the impact needs the one that a term of the objective states, and the
/// nominal value of some cannot be minimised.
void check_quantity(const CaptureProblem& problem, ObjectiveQuantity quantity) {
  if (const std::string why = io::objection_to_nominal(problem, quantity); !why.empty()) {
    throw CommandLineError(fmt::format("--pareto: {}: {}", to_string(quantity), why));
  }
  if (!row_of(quantity).needs_time) return;
  for (const ObjectiveTerm& term : problem.objective) {
    if (term.quantity == quantity) return;
  }
  throw CommandLineError(fmt::format(
      "--pareto: {} needs its time; state it with 'after' as a term of the problem's objective",
      to_string(quantity)));
}

std::string front_json(const CaptureProblem& problem, TradeOff front) {
  return io::pretty(io::written([&](io::Table& t) { io::pareto_fields(t, problem, front); }));
}

/// "base_angular_momentum_N_m_s": name and unit as one word.
std::string column(ObjectiveQuantity quantity) {
  std::string unit = unit_of(quantity);
  for (char& c : unit) c = c == ' ' || c == '/' ? '_' : c;
  return to_string(quantity) + "_" + unit;
}

std::string front_csv(const CaptureProblem& problem, const TradeOff& front) {
  std::string text = column(front.first) + "," + column(front.second);
  for (const Joint& joint : problem.robot.joints) {
    text += ',' + csv_field(joint.name + (joint.is_prismatic() ? "_m" : "_rad"));
  }
  text += ",base_x_m,base_y_m,base_z_m,base_qw,base_qx,base_qy,base_qz,contact_time_s\n";
  for (const TradeOffPoint& point : front.points) {
    const Configuration& at = point.configuration;
    text += fmt::format("{},{}", point.first, point.second);
    for (const double angle : at.phi) text += fmt::format(",{}", angle);
    for (const double x : at.base.position) text += fmt::format(",{}", x);
    const Eigen::Quaterniond& q = at.base.orientation;
    text += fmt::format(",{},{},{},{},{}\n", q.w(), q.x(), q.y(), q.z(), at.contact_time);
  }
  return text;
}

std::string label(ObjectiveQuantity quantity) {
  std::string name = to_string(quantity);
  for (char& c : name) c = c == '_' ? ' ' : c;
  return fmt::format("{} ({})", name, unit_of(quantity));
}

std::string front_svg(const CaptureProblem& problem, const TradeOff& front) {
  PlotPanel panel;
  panel.title = problem.name;
  panel.x_label = label(front.first);
  panel.y_label = label(front.second);
  PlotSeries series{"best found", {}};
  for (const TradeOffPoint& point : front.points) {
    panel.x.push_back(point.first);
    series.y.push_back(point.second);
  }
  panel.series.push_back(series);
  return plot_svg({panel});
}

std::string front_table(const TradeOff& front) {
  std::string text = fmt::format("{:>34} {:>34}\n", label(front.first), label(front.second));
  for (const TradeOffPoint& point : front.points) {
    text += fmt::format("{:>34.6g} {:>34.6g}\n", point.first, point.second);
  }
  return text;
}

std::string front_words(const TradeOff& front) {
  if (front.points.empty()) return "no configuration satisfies the constraints";
  const TradeOffPoint &a = front.points.front(), &b = front.points.back();
  return fmt::format("increasing {} from {} to {} {} reduces {} from {} to {} {}{}",
                     to_string(front.first), size_words(a.first), size_words(b.first),
                     unit_of(front.first), to_string(front.second), size_words(a.second),
                     size_words(b.second), unit_of(front.second),
                     front.stopped ? " (stopped early, best so far)" : "");
}

/// Two quantities against each other instead of a plan.
/// @return the exit code
/// @throws CommandLineError for other words than two quantities, or another extension of the file
/// than .json, .csv, .svg
int run_pareto(const CaptureProblem& problem, const PlanRequest& request) {
  const OutputFile& output = request.output;
  const auto [first, second] = quantities_of(request.pareto);
  check_quantity(problem, first);
  check_quantity(problem, second);
  const std::string extension = extension_of(output.path);
  TradeOffOptions options;
  options.optimizer = problem.search.optimizer;
  options.starts = number_of_starts(problem.search);
  options.seed = problem.search.seed;
  options.stop = stop_condition(request.time_limit);
  options.jobs = request.jobs;
  ProgressLine progress;
  options.on_progress = [&](int done, int total) { progress.show("levels", done, total); };
  const TradeOff front = trade_off(problem, first, second, options);
  progress.clear();
  if (extension == ".json") output.write(front_json(problem, front));
  if (extension == ".csv") output.write(front_csv(problem, front));
  if (extension == ".svg" && front.points.size() > 1) output.write(front_svg(problem, front));
  if (request.json) {
    write_stdout(front_json(problem, front));
  } else if (!output.is_given()) {
    write_stdout(front_table(front));
  }
  say(front_words(front));
  if (!front.points.empty() && problem.measure.kind != RiskMeasure::Nominal) {
    say(fmt::format("the values are nominal: the problem's measure '{}' is not used",
                    io::word_of(io::kMeasureNames, problem.measure.kind)));
  }
  if (signal_exit_code() != 0) return signal_exit_code();
  if (front.stopped) return kLimit;
  return front.points.empty() ? kInfeasible : kDone;
}

int exit_code_of(const Plan& plan, bool keeps_limits) {
  if (signal_exit_code() != 0) return signal_exit_code();
  if (plan.status == PlanStatus::Limit) return kLimit;
  if (plan.status == PlanStatus::Infeasible) return kInfeasible;
  if (!arrives(plan.approach)) return kNoApproach;
  return keeps_limits ? kDone : kInfeasible;
}

int plan_capture(const PlanRequest& request) {
  if (is_same_file(request.problem, request.output.path)) {
    throw CommandLineError("--output " + request.output.path + ": is the problem file itself");
  }
  const bool is_front = !request.pareto.empty();
  request.output.check(is_front ? std::vector<std::string>{".json", ".csv", ".svg"}
                                : std::vector<std::string>{".json"});
  if (!request.optimizer.empty()) {
    check_known("--optimizer " + request.optimizer, request.optimizer, nlp::optimizer_names());
  }
  std::optional<int> starts;
  if (!request.starts.empty()) starts = starts_of(request.starts);
  std::vector<Finding> remarks;
  CaptureProblem problem = read_placed_problem(request.problem, remarks);
  const std::vector<InputFile> inputs = input_files(request.problem);
  if (!request.optimizer.empty()) problem.search.optimizer = request.optimizer;
  if (request.seed) problem.search.seed = *request.seed;
  if (starts) problem.search.starts = *starts;

  if (is_front) {
    if (!problem.variables.features.empty()) {
      throw CommandLineError(
          "--pareto: the front is that of one contact feature; the problem leaves the choice of "
          "variables.feature open");
    }
    return run_pareto(problem, request);
  }

  PlannerOptions planner;
  planner.stop = stop_condition(request.time_limit);
  planner.jobs = request.jobs;
  ProgressLine progress;
  planner.on_progress = [&](const std::string& what, int done, int total) {
    progress.show(what, done, total);
  };
  Plan plan = make_plan(problem, planner);
  progress.clear();
  // The best that was found may still break what is asked of the time after the impact.
  std::string broken;
  if (!planner.stop.reached() && !plan.is_known_to_hold) {
    broken = post_impact_failure(plan, planner.stop);
  }
  if (!broken.empty() && planner.stop.reached()) {  // this simulation was cut
    plan.status = PlanStatus::Limit;
    broken.clear();
  }

  const std::string text = plan_to_json(plan, tool_versions(), {}, inputs);
  request.output.write(text);
  if (request.json && request.output.is_given()) write_stdout(text);
  say(summary_text(plan_summary(plan, request.is_verbose)));
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  if (!broken.empty()) {
    say(fmt::format("no configuration was found that keeps the limits after the impact: {} ({})",
                    after_impact_words(plan, broken, planner.stop),
                    plan.problem.post_impact.controllers.front()));
    say(fmt::format("the status '{}' is that of the search alone; what may help: {}",
                    to_string(plan.status), after_impact_advice(plan, broken, planner.stop)));
  }
  const bool is_met = plan.status != PlanStatus::Infeasible && arrives(plan.approach);
  if (std::string windows = window_words(plan.problem); !is_met && !windows.empty()) {
    windows.pop_back();
    say(windows);
  }
  if (plan.status == PlanStatus::Infeasible) {
    say_next({"check", request.problem});
  } else if (request.output.is_given()) {
    const std::string& path = request.output.path;
    say_next({"verify", path, "-o", with_extension(path, ".verification.json")});
  }
  return exit_code_of(plan, broken.empty());
}

}  // namespace

Command plan_command() {
  auto request = std::make_shared<PlanRequest>();
  return {
      "plan",
      "find the posture in which an impact disturbs the base least, and the approach path to it",
      std::vector<Option>{
          {"problem", "PROBLEM.yaml", "problem file (YAML)", &request->problem, true},
          {.name = "--optimizer",
           .value = "NAME",
           .about = "local solver in place of the problem's, e.g. nlopt-slsqp or ipopt",
           .target = &request->optimizer,
           .words = nlp::optimizer_names()},
          {"--seed", "", "seed of all random choices", &request->seed},
          {.name = "--starts",
           .value = "N|auto",
           .about = "starts of the search in place of the problem's",
           .target = &request->starts,
           .words = {"auto"}},
          {"--jobs", "N",
           "threads, by default as many as processors; the plan does not depend on it",
           &request->jobs, false, 1, 256},
          {"--time-limit", "S", "seconds after which the search stops", &request->time_limit},
          {"--pareto", "A,B",
           "no plan, but the front of two quantities, e.g. "
           "base_angular_momentum,joint_rate_norm (.json, .csv or .svg)",
           &request->pareto},
          {"--verbose", "", "say also what does not apply to this problem", &request->is_verbose},
          {"--json", "", "print the plan on stdout also with -o", &request->json}} +
          output_options(request->output, "-o,--output", "plan file (JSON); without it stdout"),
      [request] { return plan_capture(*request); }};
}

}  // namespace stillbase::app
