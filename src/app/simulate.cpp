// stillbase simulate: what base and arm do after the impact under the controllers.
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/simulation/settings.hpp>

#include "app/commands.hpp"
#include "app/contact_table.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/load.hpp"
#include "app/output.hpp"
#include "app/simulate_plot.hpp"
#include "app/start_impact.hpp"
#include "app/words.hpp"
#include "io/json.hpp"
#include "planner/post_impact.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct Options {
  std::string input, controller;
  OutputFile trace, plot;
  bool json = false, contact_table = false;
  std::vector<double> servo;
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
    Plan plan = load_plan(path).plan;
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
  AfterContact contact;  ///< its `simulation` has gone to `result`
};

/// What the contact was, beyond an instantaneous impact; null for that.
Json contact_json(const Run& run) {
  if (run.contact.is_held) {
    const Vector6d& Fbar = run.contact.latch_impulse;
    return {{"model", "latch"},
            {"impulse",
             {{"force", io::array_json(Vector3d(Fbar.head<3>()))},
              {"moment", io::array_json(Vector3d(Fbar.tail<3>()))}}}};
  }
  if (!run.contact.encounter) return nullptr;
  const EncounterResult& encounter = *run.contact.encounter;
  const ContactHistory& contact = encounter.contact;
  return {{"model", "compliant"},
          {"contacts", contact.contacts},
          {"begin", contact.first_begin},
          {"duration", contact.first_end - contact.first_begin},
          {"peak_force", run.result.summary.peak_contact_force},
          {"impulse_inertial", io::array_json(encounter.impulse_N)},
          {"separation_speed", encounter.separation_speed},
          {"momentum_error", encounter.momentum_error}};
}

std::string contact_words(const Run& run) {
  if (run.contact.is_held) {
    const Vector6d& Fbar = run.contact.latch_impulse;
    return fmt::format(
        "  contact         latched by {:.4g} N s and {:.4g} N m s; the target is held\n",
        Fbar.head<3>().norm(), Fbar.tail<3>().norm());
  }
  if (!run.contact.encounter) return "";
  const EncounterResult& encounter = *run.contact.encounter;
  const ContactHistory& contact = encounter.contact;
  if (contact.contacts == 0) return "  contact         none within the horizon\n";
  return fmt::format(
      "  contact         {} time{}, {:.3g} ms at first, up to {:.4g} N, {:.4g} N s, apart at "
      "{:.4g} m/s\n",
      contact.contacts, contact.contacts == 1 ? "" : "s",
      1e3 * (contact.first_end - contact.first_begin), run.result.summary.peak_contact_force,
      encounter.impulse_N.norm(), encounter.separation_speed);
}

Run simulate(const Case& subject, const std::string& name, const StopCondition& stop) {
  const PostImpactSpec& spec = subject.problem.post_impact;
  const auto kind = controller_from_name(name);
  if (!kind) {
    throw CommandLineError(fmt::format("--controller {}: unknown; there are {}", name,
                                       fmt::join(controller_names(), ", ")));
  }
  SimulationOptions options = plant_options_of(spec, subject.problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.stop = stop;
  AfterContact run =
      simulate_after_contact(contact_case(subject.problem, subject.configuration, subject.impact),
                             contact_choice_of(spec), controller_of(*kind, spec), options);
  SimulationResult result = std::move(run.simulation);
  return {name, std::move(result), std::move(run)};
}

Json run_json(const RobotModel& robot, const Run& run) {
  const SimulationSummary& summary = run.result.summary;
  const TraceSample &first = run.result.trace.front(), &last = run.result.trace.back();
  Json limits = Json::array();
  for (const LimitEvent& event : summary.limits) {
    limits.push_back({{"joint", robot.joints[static_cast<std::size_t>(event.joint)].name},
                      {"kind", to_string(event.kind)},
                      {"time", event.time}});
  }
  const auto momentum = [](const TraceSample& sample) {
    return Json{{"total", io::array_json(sample.total)},
                {"base", io::array_json(sample.base)},
                {"coupling", io::array_json(sample.coupling)}};
  };
  return {{"controller", run.controller},
          {"status", to_string(run.result.status)},
          {"end_time", last.time},
          {"momentum_start", momentum(first)},
          {"momentum_end", momentum(last)},
          {"peak_base_rate", summary.peak_base_rate},
          {"residual_base_rate", summary.residual_base_rate},
          {"attitude_turned", summary.attitude_turned},
          {"peak_joint_rate", summary.peak_joint_rate},
          {"residual_joint_rate", summary.residual_joint_rate},
          {"peak_torque", summary.peak_torque},
          {"stop_hits", summary.stop_hits},
          {"wheel_momentum", io::array_json(summary.wheel_momentum)},
          {"thruster_impulse_inertial", io::array_json(last.state.thruster_impulse)},
          {"contact", contact_json(run)},
          {"relative_momentum_drift", summary.relative_momentum_drift},
          {"peak_lost_momentum", summary.peak_lost_momentum},
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
  text += contact_words(run);
  // A contact that takes time changes the momentum of the robot: that of the pair stays.
  text += fmt::format("  momentum drift  {:.2g} (relative)\n",
                      run.contact.encounter ? run.contact.encounter->momentum_error
                                            : summary.relative_momentum_drift);
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
  for (const OutputFile* output : {&options.trace, &options.plot}) {
    if (is_same_file(options.input, output->path)) {
      throw CommandLineError(output->path + ": is the input itself");
    }
  }
  if (is_same_file(options.trace.path, options.plot.path)) {
    throw CommandLineError("--trace and --plot name the same file, " + options.plot.path);
  }
  for (const double x : options.servo) {
    // Stiffer ones need time steps of nanoseconds.
    if (!(x >= 0 && x <= 1e6)) throw CommandLineError("--servo: two numbers from 0 to 1e6");
  }
  if (!options.servo.empty() && !options.contact_table) {
    throw CommandLineError("--servo: belongs to --contact-table");
  }
  const bool has_motion =
      options.trace.is_given() || options.plot.is_given() || !options.controller.empty();
  if (options.contact_table && has_motion) {
    throw CommandLineError("--contact-table: has no use for --controller, --trace and --plot");
  }
  const Case subject = load_case(options.input);
  if (options.contact_table) {
    ContactCase contact = contact_case(subject.problem, subject.configuration, subject.impact);
    if (!options.servo.empty()) {
      const int n = subject.problem.robot.n();
      contact.resistance = {};
      contact.resistance.model = ResistanceModel::Servo;
      contact.resistance.stiffness = JointVectord::Constant(n, options.servo[0]);
      contact.resistance.damping = JointVectord::Constant(n, options.servo[1]);
    }
    const std::string table = contact_table(contact, subject.problem.post_impact.contact.friction,
                                            options.json, stop_condition());
    if (signal_exit_code() != 0) return signal_exit_code();
    write_stdout(table);
    return kDone;
  }
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
  command->add_flag("--contact-table", options->contact_table,
                    "instead: how good is the instantaneous impact? Contacts that take time, from "
                    "1e3 to 1e9 N/m, beside it, with the problem's joint resistance and with free "
                    "joints");
  command
      ->add_option(
          "--servo", options->servo,
          "of the table: every joint held by a servo of this stiffness (N m/rad) and damping "
          "(N m s/rad) during the contact, in place of the problem's joint resistance")
      ->expected(2)
      ->type_name("K D");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &action] {
    options->plot.force = options->trace.force;
    action = [options] { return run(*options); };
  });
}

}  // namespace stillbase::app
