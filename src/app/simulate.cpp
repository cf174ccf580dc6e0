// stillbase simulate: what base and arm do after the impact under the controllers.
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/simulation/settings.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/load.hpp"
#include "app/output.hpp"
#include "app/simulate_plot.hpp"
#include "app/start_impact.hpp"
#include "app/words.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

using io::Json;
using io::number_json;

struct Options {
  std::string input, controller;
  OutputFile trace, plot;
  bool json = false;
};

/// A problem and the state right after its impact.
struct Case {
  CaptureProblem problem;
  Configuration configuration;
  ImpactSummary impact;
};

Case load_case(const std::string& path) {
  Case result;
  if (extension_of(path) == ".json") {
    Plan plan = read_plan(read_text_file(path), path).plan;
    return {plan.problem, plan.configuration, plan.impact};
  }
  result.problem = read_problem(path);
  result.configuration = start_configuration(result.problem);
  result.impact = start_impact(result.problem);
  return result;
}

struct Run {
  std::string controller;
  SimulationResult result;
};

Run simulate(const Case& subject, const std::string& name, const StopCondition& stop) {
  const PostImpactSpec& spec = subject.problem.post_impact;
  const auto kind = controller_from_name(name);
  if (!kind) {
    throw CommandLineError(fmt::format("--controller {}: unknown; there are {}", name,
                                       fmt::join(controller_names(), ", ")));
  }
  const PlantState before = state_at_rest(subject.configuration.base, subject.configuration.phi);
  const PlantState after = state_after_impact(subject.problem.robot, subject.problem.resistance,
                                              before, subject.impact.Fbar);
  SimulationOptions options = plant_options_of(spec);
  options.integrator = IntegratorKind::Fehlberg78;
  options.stop = stop;
  return {name, simulate_post_impact(subject.problem.robot, subject.problem.resistance, after,
                                     controller_of(*kind, spec), options)};
}

Json run_json(const RobotModel& robot, const Run& run) {
  const SimulationSummary& summary = run.result.summary;
  const TraceSample &first = run.result.trace.front(), &last = run.result.trace.back();
  Json limits = Json::array();
  for (const LimitEvent& event : summary.limits) {
    limits.push_back({{"joint", robot.joints[static_cast<std::size_t>(event.joint)].name},
                      {"kind", to_string(event.kind)},
                      {"time", number_json(event.time)}});
  }
  const auto momentum = [](const TraceSample& sample) {
    return Json{{"total", io::array_json(sample.total)},
                {"base", io::array_json(sample.base)},
                {"coupling", io::array_json(sample.coupling)}};
  };
  return {{"controller", run.controller},
          {"status", to_string(run.result.status)},
          {"end_time", number_json(last.time)},
          {"momentum_start", momentum(first)},
          {"momentum_end", momentum(last)},
          {"peak_base_rate", number_json(summary.peak_base_rate)},
          {"residual_base_rate", number_json(summary.residual_base_rate)},
          {"attitude_turned", number_json(summary.attitude_turned)},
          {"peak_joint_rate", number_json(summary.peak_joint_rate)},
          {"residual_joint_rate", number_json(summary.residual_joint_rate)},
          {"peak_torque", number_json(summary.peak_torque)},
          {"stop_hits", summary.stop_hits},
          {"wheel_momentum", io::array_json(summary.wheel_momentum)},
          {"relative_momentum_drift", number_json(summary.relative_momentum_drift)},
          {"peak_lost_momentum", number_json(summary.peak_lost_momentum)},
          {"limits", limits}};
}

std::string run_words(const RobotModel& robot, const Run& run) {
  const SimulationSummary& summary = run.result.summary;
  const TraceSample &first = run.result.trace.front(), &last = run.result.trace.back();
  std::string text =
      fmt::format("{}: {} at {:.4g} s\n", run.controller, to_string(run.result.status), last.time);
  text +=
      fmt::format("  base momentum   {:.4g} -> {:.4g} N m s, arm {:.4g} -> {:.4g} N m s\n",
                  first.base.norm(), last.base.norm(), first.coupling.norm(), last.coupling.norm());
  text += fmt::format("  base rate       {:.4g} -> {:.4g} deg/s, turned by up to {:.4g} deg\n",
                      first.state.Omega.tail<3>().norm() * kDegrees,
                      summary.residual_base_rate * kDegrees, summary.attitude_turned * kDegrees);
  text += fmt::format("  joint rates     {:.4g} -> {:.4g} rad/s, peak torque {:.4g} N m\n",
                      first.state.phidot.norm(), summary.residual_joint_rate, summary.peak_torque);
  text += fmt::format("  momentum drift  {:.2g} (relative)\n", summary.relative_momentum_drift);
  for (const LimitEvent& event : summary.limits) {
    text += fmt::format("  limit met       {} {} at {:.3f} s\n",
                        robot.joints[static_cast<std::size_t>(event.joint)].name,
                        to_string(event.kind), event.time);
  }
  return text;
}

int run(const Options& options) {
  options.trace.check();
  options.plot.check();
  const Case subject = load_case(options.input);
  std::vector<std::string> names = subject.problem.post_impact.controllers;
  if (!options.controller.empty()) names = {options.controller};
  if (names.empty()) throw CommandLineError("the problem names no controller: --controller NAME");
  // A trace belongs to one controller.
  if (options.trace.is_given() && !options.plot.is_given()) names.resize(1);

  const RobotModel& robot = subject.problem.robot;
  Json runs = Json::array();
  std::string words;
  bool all_finished = true;
  std::vector<PlotPanel> panels;
  for (const std::string& name : names) {
    const Run run = simulate(subject, name, stop_condition());
    if (options.trace.is_given() && runs.empty()) {
      options.trace.write(trace_csv(robot, run.result.trace));
    }
    if (options.plot.is_given()) {
      for (PlotPanel& panel : figure_panels(name, run.result.trace)) panels.push_back(panel);
    }
    runs.push_back(run_json(robot, run));
    words += run_words(robot, run);
    all_finished = all_finished && run.result.status == SimulationStatus::Finished;
    if (signal_exit_code() != 0) break;
  }
  if (options.plot.is_given()) options.plot.write(plot_svg(panels));
  write_stdout(options.json ? io::pretty({{"format", "stillbase.simulation"},
                                          {"version", 1},
                                          {"problem", subject.problem.name},
                                          {"runs", runs}})
                            : words);
  if (signal_exit_code() != 0) return signal_exit_code();
  return all_finished ? kDone : kLimit;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "simulate",
      "the motion after the impact: in a plan's posture, or in a problem's start posture");
  command->add_option("input", options->input, "problem (YAML) or plan (JSON)")
      ->type_name("PROBLEM.yaml|PLAN.json")
      ->required();
  command->add_option("--controller", options->controller,
                      "one controller in place of the problem's: none, joint_damping, "
                      "joint_damping_literal, rns, rns_damped, rns_handback");
  add_output(*command, options->trace, "--trace",
             "motion of one controller (the first without --controller) as CSV");
  command
      ->add_option("--plot", options->plot.path,
                   "the paper's Figs. 6 to 8 for every controller, as SVG")
      ->type_name("OUT.svg");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &action] {
    options->plot.force = options->trace.force;
    action = [options] { return run(*options); };
  });
}

}  // namespace stillbase::app
