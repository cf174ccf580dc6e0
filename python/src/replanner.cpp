// Plans kept up to date while the estimate of their target moves.
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include <pybind11/stl.h>

#include <stillbase/core/error.hpp>
#include <stillbase/planner/replanner.hpp>

#include "convert.hpp"
#include "core/covariance.hpp"
#include "results.hpp"

namespace stillbase::python {

namespace {

/// The result of one update, a copy: the replanner goes on.
struct ReplanUpdate {
  ReplanResult result;
};

StopCondition stop_at(const std::optional<double>& deadline) {
  StopCondition stop;
  if (!deadline) return stop;
  if (!(*deadline >= 0) || !std::isfinite(*deadline)) {
    throw std::invalid_argument("deadline: must be a finite number of seconds, at least 0");
  }
  stop.set_deadline_after(*deadline);
  return stop;
}

StateCovariance covariance_of(const Numbers& array) {
  constexpr int kSize = StateCovariance::RowsAtCompileTime;
  const StateCovariance covariance = matrix_of(array, kSize, kSize, "covariance");
  if (const auto objection = covariance_objection(covariance)) {
    throw InputError({{"estimate", 0, "not-a-covariance", "covariance" + objection->text}});
  }
  return covariance;
}

ReplanUpdate replan(Replanner& replanner, double time, const Numbers& position,
                    const Numbers& orientation, const Numbers& linear_velocity,
                    const Numbers& angular_velocity, const std::optional<Numbers>& covariance,
                    const std::optional<double>& deadline) {
  const StopCondition stop = stop_at(deadline);
  StateEstimate estimate;
  estimate.state.time = time;
  estimate.state.pose.position = vector_of(position, 3, "position");
  const Eigen::VectorXd q = vector_of(orientation, 4, "orientation");
  estimate.state.pose.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  estimate.state.linear_velocity = vector_of(linear_velocity, 3, "linear_velocity");
  estimate.state.angular_velocity = vector_of(angular_velocity, 3, "angular_velocity");
  if (covariance) estimate.covariance = covariance_of(*covariance);
  return {replanner.replan(estimate, stop)};
}

py::object constraints_of(const ReplanResult& result) {
  py::list out;
  for (const ConstraintValue& constraint : result.constraints) {
    py::dict one;
    one["name"] = constraint.name;
    one["value"] = constraint.value;
    one["lower"] = constraint.lower;
    one["upper"] = constraint.upper;
    one["margin"] = margin_of(constraint);
    out.append(one);
  }
  return out;
}

py::object contact_of(const ReplanResult& result) {
  if (!result.contact) return py::none();
  py::dict out;
  out["point"] = result.contact->point;
  out["normal_half_angle"] = result.contact->half_angle;
  out["closing_speed"] = result.contact->closing_speed;
  return out;
}

void register_update(py::module_& m) {
  py::class_<ReplanUpdate> update(m, "ReplanUpdate", "What a Replanner found for one estimate.");
  const auto property = [&update](const char* name, auto get, const char* doc) {
    update.def_property_readonly(
        name, [get](const ReplanUpdate& u) { return get(u.result); }, doc);
  };
  using Result = ReplanResult;
  property(
      "status", [](const Result& r) { return to_string(r.status); },
      "'optimal', 'feasible', 'infeasible', or 'refused': an estimate that cannot be used.");
  property(
      "reason", [](const Result& r) { return std::string(r.reason); }, "Of 'refused', else ''.");
  property(
      "was_cut", [](const Result& r) { return r.was_cut; },
      "The deadline came before the descent had ended.");
  property(
      "configuration", [](const Result& r) { return r.configuration; },
      "The new posture, base pose and contact time.");
  property(
      "value", [](const Result& r) { return r.value; },
      "Of the measure that is minimised, in the objective's unit.");
  property(
      "nominal", [](const Result& r) { return r.nominal; },
      "At the nominal direction, in the same unit.");
  property(
      "worst_case", [](const Result& r) { return r.worst_case; },
      "Over the cone of directions, in the same unit.");
  property(
      "max_violation", [](const Result& r) { return r.max_violation; },
      "Of the constraints, in their units; feasible: at most 1e-9.");
  property("constraints", &constraints_of,
           "Dicts with name, value, lower, upper, and margin: the distance from the nearer end.");
  property(
      "kkt_residual", [](const Result& r) { return r.kkt_residual; }, "inf: not known.");
  property(
      "old_value", [](const Result& r) { return r.old.value; },
      "Of the old posture under this estimate.");
  property(
      "old_max_violation", [](const Result& r) { return r.old.max_violation; },
      "Of the old posture under this estimate: above 1e-9 it is not feasible.");
  property(
      "corrected_value", [](const Result& r) { return r.corrected.value; },
      "Of the old posture moved onto the constraints, where the descent began.");
  property("contact", &contact_of,
           "Standard deviations of the predicted contact: point, m; closing_speed, m/s;\n"
           "normal_half_angle, rad, with probability 0.95. None: no covariance, or no time.");
  property(
      "cone_half_angle", [](const Result& r) { return r.cone_half_angle; },
      "Of the worst case, rad.");
  property(
      "steps", [](const Result& r) { return r.steps; }, "Of the descent.");
  property(
      "seconds", [](const Result& r) { return r.seconds; }, "By the wall clock.");
  update.def("__repr__", [](const ReplanUpdate& u) {
    return fmt::format("<stillbase.ReplanUpdate {}: {:.4g} at {:.3f} s>",
                       to_string(u.result.status), u.result.value,
                       u.result.configuration.contact_time);
  });
}

}  // namespace

void register_replanner(py::module_& m) {
  register_update(m);
  py::class_<Replanner> replanner(
      m, "Replanner",
      "Keeps the posture of a plan up to date while the estimate of its target moves: joints,\n"
      "base pose and time of the contact, not the approach path, which has to be planned\n"
      "again. One thread at a time.");
  replanner.def(
      py::init([](const PlanResult& plan, int max_steps, double longest_step, double least_lead,
                  double stay_within) {
        if (max_steps < 1) throw std::invalid_argument("max_steps: must be at least 1");
        if (!(longest_step > 0)) throw std::invalid_argument("longest_step: must be > 0");
        if (!(least_lead >= 0)) throw std::invalid_argument("least_lead: must be >= 0");
        if (!(stay_within > 0)) throw std::invalid_argument("stay_within: must be > 0");
        ReplanOptions options;
        options.stay_within = stay_within;
        options.max_steps = max_steps;
        options.longest_step = longest_step;
        options.least_lead = least_lead;
        return Replanner(plan.file.plan, options);
      }),
      py::arg("plan"), py::kw_only(), py::arg("max_steps") = ReplanOptions{}.max_steps,
      py::arg("longest_step") = ReplanOptions{}.longest_step,
      py::arg("least_lead") = ReplanOptions{}.least_lead,
      py::arg("stay_within") = ReplanOptions{}.stay_within,
      "Sets up from a plan. max_steps: of an update; longest_step: rad; least_lead: s between\n"
      "an estimate and the contact; stay_within: rad (m) that each joint may be from the plan's\n"
      "posture. Raises InputError for problems that it does not cover.");
  replanner.def(
      "replan", &replan, py::arg("time"), py::arg("position"), py::arg("orientation"),
      py::arg("linear_velocity"), py::arg("angular_velocity"), py::kw_only(),
      py::arg("covariance") = py::none(), py::arg("deadline") = py::none(),
      "Takes an estimate of the target in N (orientation [w, x, y, z] of its axes) and gives\n"
      "the best contact found within deadline, s: never worse than a feasible old one.\n"
      "covariance (12, 12): of position, orientation (rotation vector in the target's axes),\n"
      "linear and angular velocity. Raises ValueError, InputError for what is no covariance.");
  replanner.def_property_readonly(
      "last", [](const Replanner& r) { return ReplanUpdate{r.last()}; },
      "The last update; that of the plan's own estimate before the first.");
}

}  // namespace stillbase::python
