// stillbase simulate: what base and arm do after the impact under the controllers.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/report/plot.hpp>

#include "app/command_line.hpp"
#include "app/words.hpp"
#include "io/fields/results.hpp"
#include "planner/contact_case.hpp"

namespace stillbase::app {

namespace {

using Run = io::ControllerRun;

struct SimulateRequest {
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
  result.impact = impact_at(result.problem, result.configuration);
  return result;
}

std::string four(double x) { return size_words(x, 4); }

std::string contact_words(const Run& run) {
  if (run.contact.is_held) {
    const Vector6d& Fbar = run.contact.latch_impulse;
    return fmt::format("  contact         latched by {} N s and {} N m s; the target is held\n",
                       four(Fbar.head<3>().norm()), four(Fbar.tail<3>().norm()));
  }
  if (!run.contact.encounter) return "";
  const EncounterResult& encounter = *run.contact.encounter;
  const ContactHistory& contact = encounter.contact;
  if (contact.contacts == 0) return "  contact         none within the horizon\n";
  return fmt::format(
      "  contact         {} time{}, the first for {:.3g} ms, peak {:.4g} N, {:.4g} N s, separation "
      "at "
      "{:.4g} m/s\n",
      contact.contacts, contact.contacts == 1 ? "" : "s",
      1e3 * (contact.first_end - contact.first_begin), run.result.summary.peak_contact_force,
      encounter.impulse_N.norm(), encounter.separation_speed);
}

Run simulate(const Case& subject, const std::string& name, const StopCondition& stop) {
  check_known("--controller " + name, name, controller_names());
  AfterContact run =
      simulate_post_impact(subject.problem, subject.configuration, subject.impact, name, stop);
  SimulationResult result = std::move(run.simulation);
  Run out{name, std::move(result), std::move(run)};
  if (out.result.status == SimulationStatus::Finished) {
    out.after_horizon =
        motion_after_horizon(subject.problem, subject.configuration, subject.impact, name, stop);
  }
  return out;
}

std::string run_words(const RobotModel& robot, const PostImpactSpec& spec, const Run& run) {
  const SimulationSummary& summary = run.result.summary;
  const TraceSample &first = run.result.trace.front(), &last = run.result.trace.back();
  std::string text =
      fmt::format("{}: {} at {:.4g} s\n", run.controller, to_string(run.result.status), last.time);
  text +=
      fmt::format("  base momentum   {} -> {} N m s, arm {} -> {} N m s\n", four(first.base.norm()),
                  four(last.base.norm()), four(first.coupling.norm()), four(last.coupling.norm()));
  text += fmt::format("  base rate       {} -> {} deg/s, attitude change at most {} deg\n",
                      four(first.state.Omega.tail<3>().norm() * kDegrees),
                      four(summary.residual_base_rate * kDegrees),
                      four(summary.attitude_turned * kDegrees));
  text += fmt::format("  joint rates     {} -> {} rad/s, peak torque {} N m",
                      four(first.state.phidot.norm()), four(summary.residual_joint_rate),
                      four(summary.peak_torque));
  if (summary.peak_demanded_torque > summary.peak_torque) {
    text += fmt::format(" of {:.4g} N m demanded", summary.peak_demanded_torque);
  }
  text += '\n';
  text += contact_words(run);
  if (run.contact.is_held) {
    text += fmt::format("  grip            at most {} N, {} N m\n", four(summary.peak_grip_force),
                        four(summary.peak_grip_moment));
  }
  if (summary.peak_wheel_torque > 0) {
    text += fmt::format("  wheels          at most {:.4g} N m and {:.4g} N m s of an axis; {}\n",
                        summary.peak_wheel_torque, summary.peak_wheel_momenta.maxCoeff(),
                        summary.rest_time ? rest_words(spec.sensor, *summary.rest_time)
                                          : "not at rest at the horizon");
  }
  // A contact that takes time changes the momentum of the robot: that of the pair stays.
  text += fmt::format("  momentum drift  {:.2g} (relative)\n",
                      run.contact.encounter ? run.contact.encounter->momentum_error
                                            : summary.relative_momentum_drift);
  for (const LimitEvent& event : summary.limits) {
    text += fmt::format("  limit reached   {} {} at {:.3f} s\n",
                        robot.joints[static_cast<std::size_t>(event.joint)].name,
                        to_string(event.kind), event.time);
  }
  if (run.after_horizon) {
    text += "  afterwards      " + after_horizon_words(*run.after_horizon, spec.horizon) + '\n';
  }
  return text;
}

constexpr double kLead = 0.1;  // s before the impact, as in the paper

/// The axis of the angular momentum in N, its largest component positive; z without momentum.
Vector3d momentum_axis(const TraceSample& sample) {
  const double size = sample.base.norm() + sample.coupling.norm();
  if (!(sample.total_N.norm() > 1e-9 * size)) return Vector3d::UnitZ();
  Vector3d axis = sample.total_N.normalized();
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Vector3d(-axis) : axis;
}

/// The paper's Figs. 6 to 8 of a run, three panels: (a) base attitude, (b) momenta, (c) joint rate
/// and its parts. As in the paper they begin 0.1 s before the impact, with the robot at rest; the
/// impact is at t = 0. Attitude and momenta are shown along the axis of the total angular momentum
/// (planar robots: z).
/// @param trace from right after the impact on
std::vector<PlotPanel> figure_panels(const std::string& controller,
                                     const std::vector<TraceSample>& trace) {
  PlotPanel attitude{controller + ": (a) base attitude",
                     "time from the impact, s",
                     "rotation angle, deg",
                     {},
                     {{"base attitude", {}}},
                     {{0, "impact"}}};
  PlotPanel momenta{controller + ": (b) angular momenta",
                    "time from the impact, s",
                    "N m s",
                    {},
                    {{"total", {}}, {"base", {}}, {"coupling", {}}},
                    {{0, "impact"}}};
  PlotPanel rates{controller + ": (c) joint rate",
                  "time from the impact, s",
                  "norm, rad/s",
                  {},
                  {{"joint rate", {}}, {"in the null space", {}}, {"orthogonal", {}}},
                  {{0, "impact"}}};
  const Vector3d axis = momentum_axis(trace.front());
  const Eigen::Quaterniond first = trace.front().state.base.orientation;
  const double t0 = trace.front().time;
  const auto add = [&](double t, const TraceSample* sample) {
    for (PlotPanel* panel : {&attitude, &momenta, &rates}) panel->x.push_back(t);
    const auto push = [&](PlotPanel& panel, std::size_t i, double value) {
      panel.series[i].y.push_back(sample == nullptr ? 0.0 : value);
    };
    const TraceSample& s = sample == nullptr ? trace.front() : *sample;
    const Eigen::Quaterniond& R_NB = s.state.base.orientation;
    push(attitude, 0, axis.dot(rotation_log(R_NB * first.conjugate())) * kDegrees);
    push(momenta, 0, axis.dot(s.total_N));
    push(momenta, 1, axis.dot(R_NB * s.base));
    push(momenta, 2, axis.dot(R_NB * s.coupling));
    push(rates, 0, s.state.phidot.norm());
    push(rates, 1, s.rns.norm());
    push(rates, 2, s.orthogonal.norm());
  };
  add(-kLead, nullptr);
  add(0, nullptr);
  for (const TraceSample& sample : trace) add(sample.time - t0, &sample);
  return {attitude, momenta, rates};
}

std::vector<double> stiffnesses() {
  std::vector<double> list;
  for (int decade = 3; decade <= 9; ++decade) list.push_back(std::pow(10.0, decade));
  return list;
}

/// The normal contact of the case with a restitution that a spring-damper can leave.
ContactCase checked_case(ContactCase subject) {
  if (!subject.target || !(subject.impulse > 0) || !(subject.closing_speed > 0)) {
    throw CommandLineError("--contact-table: needs a target that closes in on the hand by a law");
  }
  if (subject.law != ContactLaw::Frictionless) {
    throw CommandLineError(
        "--contact-table: a spring-damper rebounds and slips, so it approaches impact.contact "
        "'normal' alone");
  }
  if (subject.resistance.model == ResistanceModel::Locked) {
    throw CommandLineError("--contact-table: a contact that takes time knows no locked joints");
  }
  subject.restitution = std::max(subject.restitution, kLeastRestitution);
  return subject;
}

std::string table_words(const ContactCase& subject, const std::vector<ModelCheckRow>& rows) {
  const std::string model = to_string(subject.resistance.model);
  std::string text = fmt::format(
      "spring-damper contact against the instantaneous impact: joints {}, restitution {:g}, "
      "closing "
      "at {:.4g} m/s\n",
      model, subject.restitution, subject.closing_speed);
  text +=
      "  stiffness    duration  peak force  impulse off  velocity off  off if joints free  "
      "momentum off\n";
  for (const ModelCheckRow& row : rows) {
    if (!row.ended) {
      text += fmt::format("{:>7.0e} N/m  not over in time\n", row.stiffness);
      continue;
    }
    text +=
        fmt::format("{:>7.0e} N/m {:>8.3g} ms {:>9.4g} N {:>12.2e} {:>13.2e} {:>19.2e} {:>13.1e}\n",
                    row.stiffness, 1e3 * row.duration, row.peak_force, row.impulse_error,
                    row.velocity_error, row.free_error, row.momentum_error);
  }
  text +=
      "off: relative to the jump, velocities in the norm of kinetic energy; 'velocity off' is "
      "against "
      "the jump with\nthe joints as stated (servo: by its formula with the duration found), the "
      "next "
      "against that with free joints\n";
  return text;
}

/// The contact of a case by a spring-damper that gets stiffer row by row, beside the instantaneous
/// impact with the case's joint resistance and with free joints.
/// @param friction Coulomb coefficient of the spring-damper contact; the impact has none
/// @param stop rows that it cuts off are said to be not over
/// @throws CommandLineError for a case without target or closing speed, or with locked joints
std::string contact_table(const ContactCase& stated, double friction, bool as_json,
                          const StopCondition& stop) {
  const ContactCase subject = checked_case(stated);
  std::vector<ModelCheckRow> rows;
  try {
    rows = check_stiffness(subject, friction, stiffnesses(), stop);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(std::string("--contact-table: ") + error.what());
  }
  if (!as_json) return table_words(subject, rows);
  io::ContactTable table{subject.resistance.model, subject.restitution, subject.closing_speed,
                         friction, rows};
  return io::pretty(io::written([&](io::Table& t) { io::contact_table_fields(t, table); }));
}

int simulate_motion(const SimulateRequest& request) {
  for (const OutputFile* output : {&request.trace, &request.plot}) {
    if (is_same_file(request.input, output->path)) {
      throw CommandLineError(output->path + ": is the input itself");
    }
  }
  request.trace.check({".csv"});
  request.plot.check({".svg"});
  if (is_same_file(request.trace.path, request.plot.path)) {
    throw CommandLineError("--trace and --plot name the same file, " + request.plot.path);
  }
  for (const double x : request.servo) {
    // Stiffer ones need time steps of nanoseconds.
    if (!(x >= 0 && x <= 1e6)) throw CommandLineError("--servo: two numbers from 0 to 1e6");
  }
  if (!request.servo.empty() && !request.contact_table) {
    throw CommandLineError("--servo: belongs to --contact-table");
  }
  const bool has_motion =
      request.trace.is_given() || request.plot.is_given() || !request.controller.empty();
  if (request.contact_table && has_motion) {
    throw CommandLineError("--contact-table: has no use for --controller, --trace and --plot");
  }
  const Case subject = load_case(request.input);
  if (request.contact_table) {
    ContactCase contact = contact_case(subject.problem, subject.configuration, subject.impact);
    if (!request.servo.empty()) {
      const int n = subject.problem.robot.n();
      contact.resistance = {};
      contact.resistance.model = ResistanceModel::Servo;
      contact.resistance.stiffness = JointVectord::Constant(n, request.servo[0]);
      contact.resistance.damping = JointVectord::Constant(n, request.servo[1]);
    }
    const std::string table = contact_table(contact, subject.problem.post_impact.contact.friction,
                                            request.json, stop_condition());
    if (signal_exit_code() != 0) return signal_exit_code();
    write_stdout(table);
    return kDone;
  }
  std::vector<std::string> names = subject.problem.post_impact.controllers;
  if (!request.controller.empty()) names = {request.controller};
  if (names.empty()) throw CommandLineError("the problem names no controller: --controller NAME");
  if (names.front() == to_string(ControllerKind::Detumble) &&
      !subject.problem.post_impact.wheels.exist()) {
    throw CommandLineError(
        "--controller detumble: takes the momentum with wheels, and the problem has none "
        "(post_impact.wheels)");
  }
  // A trace belongs to one controller.
  if (request.trace.is_given() && !request.plot.is_given()) names.resize(1);

  const RobotModel& robot = subject.problem.robot;
  io::SimulationRuns all{subject.problem.name, robot, {}};
  std::string words;
  bool all_finished = true;
  std::vector<PlotPanel> panels;
  for (const std::string& name : names) {
    const Run& run = all.runs.emplace_back(simulate(subject, name, stop_condition()));
    if (request.trace.is_given() && all.runs.size() == 1) {
      request.trace.write(trace_csv(robot, run.result.trace));
    }
    if (request.plot.is_given()) {
      for (PlotPanel& panel : figure_panels(name, run.result.trace)) panels.push_back(panel);
    }
    words += run_words(robot, subject.problem.post_impact, run);
    all_finished = all_finished && run.result.status == SimulationStatus::Finished;
    if (signal_exit_code() != 0) break;
  }
  if (request.plot.is_given()) request.plot.write(plot_svg(panels));
  write_stdout(request.json
                   ? io::pretty(io::written([&](io::Table& t) { io::simulation_fields(t, all); }))
                   : words);
  if (signal_exit_code() != 0) return signal_exit_code();
  return all_finished ? kDone : kLimit;
}

}  // namespace

Command simulate_command() {
  auto request = std::make_shared<SimulateRequest>();
  return {"simulate",
          "the motion after the impact: in a plan's posture, or in a problem's start posture",
          std::vector<Option>{
              {"input", "PROBLEM.yaml|PLAN.json", "problem (YAML) or plan (JSON)", &request->input,
               true},
              {.name = "--controller",
               .value = "NAME",
               .about = "one controller in place of the problem's: none, joint_damping, "
                        "joint_damping_literal, rns, rns_damped, rns_handback, detumble",
               .target = &request->controller,
               .words = controller_names()},
              {"--plot", "OUT.svg", "the paper's Figs. 6 to 8 for every controller, as SVG",
               &request->plot.path},
              {"--contact-table", "",
               "instead: how good is the instantaneous impact? Contacts that take time, from 1e3 "
               "to 1e9 N/m, beside it, with the problem's joint resistance and with free joints",
               &request->contact_table},
              {"--servo", "K D",
               "of the table: every joint held by a servo of this stiffness (N m/rad) and damping "
               "(N m s/rad) during the contact, in place of the problem's joint resistance",
               &request->servo, false, 0, 0, 2},
              {"--json", "", "print one JSON object", &request->json}} +
              output_options(request->trace, "--trace",
                             "motion of one controller (the first without --controller) as CSV"),
          [request] {
            request->plot.force = request->trace.force;
            return simulate_motion(*request);
          }};
}

}  // namespace stillbase::app
