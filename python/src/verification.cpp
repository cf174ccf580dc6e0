// Does a plan work: verification, audit, and trials with random errors.
#include <algorithm>

#include <fmt/format.h>

#include <pybind11/stl.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/verification/trials.hpp>

#include "io/fields/results.hpp"
#include "long_call.hpp"
#include "results.hpp"

namespace stillbase::python {

namespace {

struct VerificationResult {
  Verification data;
  std::string content_sha256;
};

struct Trials {
  TrialSetting setting;
  std::vector<TrialOutcome> outcomes;
  TrialReport report;
};

/// Trials between two looks at the progress, per worker.
constexpr int kTrialsAtOnce = 16;
/// More threads than any machine runs at a time; kTrialsAtOnce times it is an int.
constexpr int kMostWorkers = 4096;

py::object verify(const PlanResult& plan, bool audit, const std::optional<double>& time_limit) {
  LongCall call(time_limit);
  VerifyOptions options;
  options.stop = call.stop();
  const Plan& subject = plan.file.plan;
  Verification data =
      call([&] { return audit ? judge_plan(subject, options) : verify_plan(subject, options); });
  return call.finish(py::cast(std::make_shared<VerificationResult>(VerificationResult{
      std::move(data),
      read_plan(plan_to_json(subject, plan.file.tool, {}, plan.file.inputs), "plan")
          .computed_sha256})));
}

Perturbations sizes_of(const CaptureProblem& problem, const std::map<std::string, double>& stated) {
  Perturbations sizes = perturbations_for(problem);
  const std::pair<const char*, double*> known[] = {
      {"cone_half_angle", &sizes.cone_half_angle},
      {"closing_speed", &sizes.closing_speed},
      {"closing_speed_error", &sizes.closing_speed_error},
      {"restitution", &sizes.restitution},
      {"target_mass", &sizes.target_mass},
      {"target_inertia", &sizes.target_inertia},
      {"contact_point", &sizes.contact_point},
      {"contact_time", &sizes.contact_time},
      {"robot_mass", &sizes.robot_mass},
      {"base_rate_error", &sizes.base_rate_error},
      {"joint_rate_error", &sizes.joint_rate_error}};
  for (const auto& [name, value] : stated) {
    const auto* at = std::find_if(std::begin(known), std::end(known),
                                  [&name](const auto& entry) { return name == entry.first; });
    if (at == std::end(known)) throw std::invalid_argument("sizes: '" + name + "' is not known");
    if (!(value >= 0 && value < kInfinity)) {
      throw std::invalid_argument("sizes: " + name + " must be >= 0 and finite");
    }
    *at->second = value;
  }
  return sizes;
}

py::object run(const PlanResult& plan, int count, std::uint64_t seed, int jobs,
               const std::map<std::string, double>& sizes, const py::object& progress,
               const std::optional<double>& time_limit) {
  if (count < 1) throw std::invalid_argument("count: must be at least 1");
  if (jobs < 1) throw std::invalid_argument("jobs: must be at least 1");
  const int workers = std::min(jobs, kMostWorkers);
  const Plan& subject = plan.file.plan;
  Trials out{{sizes_of(subject.problem, sizes), seed, 0, count}, {}, {}};
  LongCall call(time_limit);
  const Progress report = call.progress(progress);
  out.outcomes = call([&] {
    std::vector<TrialOutcome> all;
    while (static_cast<int>(all.size()) < count && !call.stop().reached()) {
      const int first = static_cast<int>(all.size());
      const int some = std::min(count - first, kTrialsAtOnce * workers);
      const auto more =
          run_trials(subject, out.setting.sizes, seed, first, some, workers, call.stop());
      all.insert(all.end(), more.begin(), more.end());
      if (report) report("trials", static_cast<int>(all.size()), count);
    }
    return all;
  });
  out.report = summarize_trials(out.outcomes);
  return call.finish(py::cast(std::make_shared<Trials>(std::move(out))));
}

/// One number or flag of each trial.
template <class T>
py::array column_of(const std::vector<TrialOutcome>& outcomes, T TrialOutcome::*member) {
  py::array_t<T> out(static_cast<py::ssize_t>(outcomes.size()));
  T* at = out.mutable_data();
  for (const TrialOutcome& outcome : outcomes) *at++ = outcome.*member;
  return out;
}

void register_verification(py::module_& m) {
  py::class_<Claim> check(m, "Check", "One statement of a plan or demand of its problem, checked.");
  check.def_readonly("name", &Claim::name, "Of the check.");
  check.def_property_readonly(
      "group", [](const Claim& c) { return to_string(c.group); },
      "'inputs', 'physics', 'constraints', 'approach', 'after_contact' or 'audit'.");
  check.def_readonly("value", &Claim::value, "What was found; None: it could not be evaluated.");
  check.def_readonly("limit", &Claim::limit, "What the value is held against.");
  check.def_readonly("unit", &Claim::unit, "Of value and limit; '1' for ratios and counts.");
  check.def_property_readonly(
      "passes",
      [](const Claim& c) -> std::optional<bool> {
        if (!c.is_checked) return std::nullopt;
        return c.pass;
      },
      "None: it could not be checked, for the reason in `detail`.");
  check.def_readonly("detail", &Claim::detail, "What was compared, or why it was not.");
  check.def("__repr__", [](const Claim& c) {
    return fmt::format("<stillbase.Check {}: {}>", c.name,
                       c.pass      ? "pass"
                       : c.fails() ? "fail"
                                   : "not checked");
  });

  py::class_<VerificationResult, std::shared_ptr<VerificationResult>> verification(
      m, "Verification", "Verdict on a plan, recomputed by other code than the planner's.");
  verification.def_property_readonly(
      "passes", [](const VerificationResult& v) { return v.data.pass; },
      "No check failed and at least one passed.");
  verification.def_property_readonly(
      "interrupted", [](const VerificationResult& v) { return v.data.interrupted; },
      "Stopped before the end: no verdict.");
  verification.def_property_readonly(
      "checks", [](const VerificationResult& v) { return v.data.claims; }, "All checks.");
  verification.def(
      "to_dict",
      [](const VerificationResult& v) {
        Verification copy = v.data;
        std::string sha256 = v.content_sha256;
        return python_of([&](io::Table& t) { io::verification_fields(t, copy, sha256, nullptr); });
      },
      "The verification file as a dict.");
  verification.def("__repr__", [](const VerificationResult& v) {
    return fmt::format("<stillbase.Verification: {}, {} checks>", v.data.pass ? "pass" : "fail",
                       v.data.claims.size());
  });
  m.def("verify", &verify, py::arg("plan"), py::kw_only(), py::arg("audit") = true,
        py::arg("time_limit") = py::none(),
        "Recomputes a plan by other code than the planner's; with `audit` its search record too.\n"
        "time_limit, s: remaining checks are not made. Other Python threads run meanwhile; Ctrl-C\n"
        "raises Interrupted with the checks that were made.");
}

void register_trials(py::module_& m) {
  py::class_<Trials, std::shared_ptr<Trials>> trials(
      m, "Trials", "Impacts and motions after them with random errors; one row for each trial.");
  trials.def_property_readonly(
      "count", [](const Trials& t) { return t.outcomes.size(); }, "Trials that were done.");
  trials.def_property_readonly(
      "input_names", [](const Trials&) { return trial_input_names(); }, "What was drawn.");
  trials.def_property_readonly(
      "inputs",
      [](const Trials& t) {
        const std::size_t columns = trial_input_names().size();
        py::array_t<double> out({t.outcomes.size(), columns});
        double* at = out.mutable_data();
        for (const TrialOutcome& outcome : t.outcomes) {
          at = std::copy(outcome.inputs.begin(), outcome.inputs.end(), at);
        }
        return out;
      },
      "Deviations from nominal, (k, len(input_names)).");
  const auto column = [&trials](const char* name, auto member, const char* doc) {
    trials.def_property_readonly(
        name, [member](const Trials& t) { return column_of(t.outcomes, member); }, doc);
  };
  column("hit", &TrialOutcome::hit, "The contact takes place, (k,).");
  column("finished", &TrialOutcome::finished, "The simulation reached the horizon, (k,).");
  column("success", &TrialOutcome::success, "Contact, and the problem's limits hold, (k,).");
  column("impulse", &TrialOutcome::impulse, "(k,), N s.");
  column("objective", &TrialOutcome::objective, "Of the problem, (k,), in its unit.");
  column("base_rate_jump", &TrialOutcome::base_rate_jump, "|Delta omega|, (k,), rad/s.");
  column("residual_base_rate", &TrialOutcome::residual_base_rate, "At the horizon, (k,), rad/s.");
  column("attitude_turned", &TrialOutcome::attitude_turned, "Largest change, (k,), rad.");
  column("peak_rate_part", &TrialOutcome::peak_rate_part,
         "Largest part of a joint's rate limit, (k,).");
  column("peak_torque_part", &TrialOutcome::peak_torque_part,
         "Largest part of a joint's torque limit, (k,).");
  column("stop_hits", &TrialOutcome::stop_hits, "Joint stops that were reached, (k,).");
  trials.def_property_readonly(
      "success_probability", [](const Trials& t) { return t.report.success_probability; },
      "Part of the trials that succeed.");
  trials.def_property_readonly(
      "success_interval",
      [](const Trials& t) {
        return py::make_tuple(t.report.success_lower, t.report.success_upper);
      },
      "Its 95 % interval by Wilson, (lower, upper).");
  trials.def(
      "to_dict",
      [](const Trials& t) {
        TrialResult copy{t.setting, t.report};
        return python_of([&](io::Table& table) { io::trials_fields(table, copy); });
      },
      "The object `trials` of verification files: probability, distributions, sensitivities.");
  trials.def("__repr__", [](const Trials& t) {
    return fmt::format("<stillbase.Trials: {} of {} succeed>", t.report.successes, t.report.trials);
  });
  m.def("trials", &run, py::arg("plan"), py::arg("count"), py::kw_only(), py::arg("seed") = 1,
        py::arg("jobs") = 1, py::arg("sizes") = std::map<std::string, double>{},
        py::arg("progress") = py::none(), py::arg("time_limit") = py::none(),
        "Simulates impact and motion after it with random errors in direction, speed, masses,\n"
        "contact point, contact time and sensors. Trial k depends on seed and k alone.\n"
        "\n"
        "jobs: trials at a time. sizes: half ranges in place of the problem's, keys as in\n"
        "to_dict()['perturbations']. progress(what, done, total); time_limit, s. Other Python\n"
        "threads run meanwhile; Ctrl-C raises Interrupted with the trials that were done. Raises\n"
        "ValueError, InputError.");
}

}  // namespace

void register_results(py::module_& m) {
  register_verification(m);
  register_trials(m);
}

}  // namespace stillbase::python
