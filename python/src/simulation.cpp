// The motion after the impact.
#include <fmt/format.h>

#include <pybind11/stl.h>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "io/fields/results.hpp"
#include "long_call.hpp"
#include "results.hpp"

namespace stillbase::python {

namespace {

/// The run of one controller; arrays are views of its trace.
struct Simulation {
  io::ControllerRun run;
  std::string problem;
  RobotModel robot;
};

const std::vector<TraceSample>& trace_of(py::handle self) {
  return self.cast<const Simulation&>().run.result.trace;
}

/// The case of a plan, or of a problem at a configuration (its start configuration without one).
struct Subject {
  const CaptureProblem& problem;
  Configuration configuration;
  ImpactSummary impact;
};

Subject subject_of(const py::object& object, const std::optional<Configuration>& configuration) {
  if (py::isinstance<PlanResult>(object)) {
    const Plan& plan = object.cast<const PlanResult&>().file.plan;
    if (!configuration) return {plan.problem, plan.configuration, plan.impact};
  } else if (!py::isinstance<Problem>(object)) {
    throw py::type_error("subject: must be a Problem or a Plan");
  }
  const CaptureProblem& problem = py::isinstance<PlanResult>(object)
                                      ? object.cast<const PlanResult&>().file.plan.problem
                                      : object.cast<const Problem&>().data;
  const Configuration at = configuration ? *configuration : start_configuration(problem);
  check_fits(problem.robot.n(), at);
  return {problem, at, impact_at(problem, at)};
}

py::object simulate(const py::object& object, const std::optional<std::string>& controller,
                    const std::optional<Configuration>& configuration,
                    const std::optional<double>& time_limit) {
  const Subject subject = subject_of(object, configuration);
  const auto& named = subject.problem.post_impact.controllers;
  if (!controller && named.empty()) {
    throw std::invalid_argument("controller: the problem names none, so one must be stated");
  }
  const std::string name = controller ? *controller : named.front();
  LongCall call(time_limit);
  std::optional<AfterHorizon> beyond;
  AfterContact after = call([&] {
    AfterContact run = simulate_post_impact(subject.problem, subject.configuration, subject.impact,
                                            name, call.stop());
    if (run.simulation.status == SimulationStatus::Finished) {
      beyond = motion_after_horizon(subject.problem, subject.configuration, subject.impact, name,
                                    call.stop());
    }
    return run;
  });
  SimulationResult result = std::move(after.simulation);
  return call.finish(py::cast(
      std::make_shared<Simulation>(Simulation{{name, std::move(result), std::move(after), beyond},
                                              subject.problem.name,
                                              subject.problem.robot})));
}

}  // namespace

void register_simulation(py::module_& m) {
  py::class_<Simulation, std::shared_ptr<Simulation>> simulation(
      m, "Simulation",
      "The motion after the impact under one controller, at k times. Vectors are in B unless it\n"
      "says N; arrays are views that cannot be written.");
  simulation.def_property_readonly(
      "controller", [](const Simulation& s) { return s.run.controller; }, "Its name.");
  simulation.def_property_readonly(
      "status", [](const Simulation& s) { return to_string(s.run.result.status); },
      "'finished', or what ended it before the horizon.");
  simulation.def_property_readonly(
      "times",
      [](py::handle self) {
        const auto& trace = trace_of(self);
        return view_of(&trace.front().time, {trace.size()}, {sizeof(TraceSample)}, self);
      },
      "(k,), s after the impact.");
  simulation.def_property_readonly(
      "kinetic_energy",
      [](py::handle self) {
        const auto& trace = trace_of(self);
        return view_of(&trace.front().kinetic_energy, {trace.size()}, {sizeof(TraceSample)}, self);
      },
      "Of the robot, (k,), J.");
  const auto rows = [&simulation](const char* name, auto part, const char* doc) {
    simulation.def_property_readonly(
        name, [part](py::handle self) { return views_of(trace_of(self), part, self); }, doc);
  };
  using Sample = TraceSample;
  rows(
      "joint_positions", [](const Sample& s) -> auto& { return s.state.phi; }, "(k, n), rad (m).");
  rows(
      "joint_velocities", [](const Sample& s) -> auto& { return s.state.phidot; },
      "(k, n), rad/s (m/s).");
  rows(
      "joint_velocities_rns", [](const Sample& s) -> auto& { return s.rns; },
      "Their part in the angular reaction null space, (k, n).");
  rows(
      "joint_torques", [](const Sample& s) -> auto& { return s.tau; },
      "Of the controller after limits, (k, n), N m (N).");
  rows(
      "base_positions", [](const Sample& s) -> auto& { return s.state.base.position; },
      "Of B in N, (k, 3), m.");
  rows(
      "base_velocities", [](const Sample& s) -> auto& { return s.state.Omega; },
      "[v; omega] in B, (k, 6), m/s, rad/s.");
  rows(
      "momentum_base", [](const Sample& s) -> auto& { return s.base; },
      "Htilde_omega omega, (k, 3), N m s.");
  rows(
      "momentum_coupling", [](const Sample& s) -> auto& { return s.coupling; },
      "Htilde_omegaphi phidot, (k, 3), N m s.");
  rows(
      "momentum_total", [](const Sample& s) -> auto& { return s.total; }, "L_g, (k, 3), N m s.");
  rows(
      "momentum_total_N", [](const Sample& s) -> auto& { return s.total_N; },
      "L_g in N, conserved, (k, 3), N m s.");
  simulation.def_property_readonly(
      "base_orientations",
      [](py::handle self) {
        return quaternions_of(
            trace_of(self), [](const Sample& s) -> auto& { return s.state.base; });
      },
      "R_NB as [w, x, y, z], (k, 4).");
  const auto number = [&simulation](const char* name, double SimulationSummary::*member,
                                    const char* doc) {
    simulation.def_property_readonly(
        name, [member](const Simulation& s) { return s.run.result.summary.*member; }, doc);
  };
  number("peak_base_rate", &SimulationSummary::peak_base_rate, "Largest |omega|, rad/s.");
  number("residual_base_rate", &SimulationSummary::residual_base_rate,
         "|omega| at the end, rad/s.");
  number("attitude_turned", &SimulationSummary::attitude_turned,
         "Largest change of attitude, rad.");
  number("peak_torque", &SimulationSummary::peak_torque, "Of any joint, N m (N).");
  number("peak_demanded_torque", &SimulationSummary::peak_demanded_torque,
         "The same as the controller asks for it, before the torque limits, N m (N).");
  number("relative_momentum_drift", &SimulationSummary::relative_momentum_drift,
         "Error of the conserved momenta, relative.");
  simulation.def_property_readonly(
      "after_horizon",
      [](const Simulation& s) -> py::object {
        if (!s.run.after_horizon) return py::none();
        AfterHorizon after = *s.run.after_horizon;
        return python_of([&](io::Table& t) { io::after_horizon_fields(t, after); });
      },
      "What the joints do after the horizon, as in plan files; None: not computed.");
  simulation.def(
      "to_csv", [](const Simulation& s) { return trace_csv(s.robot, s.run.result.trace); },
      "The trace as CSV, units in the names of the columns.");
  simulation.def(
      "to_dict",
      [](const Simulation& s) {
        io::SimulationRuns runs{s.problem, s.robot, {s.run}};
        return python_of([&](io::Table& t) { io::simulation_fields(t, runs); });
      },
      "What `stillbase simulate --json` prints of this run.");
  simulation.def("__repr__", [](const Simulation& s) {
    return fmt::format("<stillbase.Simulation '{}' under {}: {}>", s.problem, s.run.controller,
                       to_string(s.run.result.status));
  });

  m.def(
      "simulate", &simulate, py::arg("subject"), py::arg("controller") = py::none(), py::kw_only(),
      py::arg("configuration") = py::none(), py::arg("time_limit") = py::none(),
      "Simulates from the contact to the horizon of the problem's `post_impact` section.\n"
      "\n"
      "subject: a Plan, or a Problem (at `configuration`, without one at its start\n"
      "configuration). controller: one of `none`, `joint_damping`, `joint_damping_literal`,\n"
      "`rns`, `rns_damped`, `rns_handback`; without one the first of the problem. time_limit, s.\n"
      "Other Python threads run meanwhile; Ctrl-C raises Interrupted with the motion so far.\n"
      "Raises ValueError, InputError.");
}

}  // namespace stillbase::python
