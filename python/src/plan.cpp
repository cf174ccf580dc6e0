// Plans: search, collision judgement, approach path, and their files.
#include <fmt/format.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "convert.hpp"
#include "io/fields/plan.hpp"
#include "long_call.hpp"
#include "results.hpp"

namespace stillbase::python {

namespace {

struct PlanCandidate {
  Candidate candidate;
};

/// Views of an approach keep the plan alive.
struct PlanApproach {
  std::shared_ptr<PlanResult> plan;
  const Approach& data() const { return plan->file.plan.approach; }
};

py::object plan_capture(const std::shared_ptr<Problem>& problem, const py::object& progress,
                        const std::optional<double>& time_limit,
                        const std::optional<int>& max_approaches, int jobs) {
  if (jobs < 0) throw std::invalid_argument("jobs: must be at least 0");
  if (max_approaches && *max_approaches < 1)
    throw std::invalid_argument("max_approaches: must be at least 1");
  LongCall call(time_limit);
  PlannerOptions options;
  options.stop = call.stop();
  options.on_progress = call.progress(progress);
  options.jobs = jobs;
  CaptureProblem asked = problem->data;
  if (max_approaches) asked.approach.max_approaches = *max_approaches;
  Plan plan = call([&] { return make_plan(asked, options); });
  PlanFile file{std::move(plan), tool_versions(), {}, {}, {}, {}, {}};
  return call.finish(py::cast(make_plan_result(std::move(file), problem)));
}

std::shared_ptr<PlanResult> load(const std::filesystem::path& path, bool check_fingerprint) {
  if (check_fingerprint) return make_plan_result(load_plan(path.string()));
  return make_plan_result(read_plan(read_text_file(path.string()), path.string()));
}

std::string text_of(const PlanResult& plan) {
  return plan_to_json(plan.file.plan, plan.file.tool, {}, plan.file.inputs);
}

py::dict objective_dict(const ObjectiveValue& objective) {
  py::dict out;
  out["name"] = objective.name;
  out["unit"] = objective.unit;
  out["value"] = objective.value;
  out["nominal"] = objective.nominal;
  out["worst_case"] = objective.worst_case;
  out["terms"] = objective.terms;
  return out;
}

void register_approach(py::module_& m) {
  py::class_<PlanApproach> approach(
      m, "Approach",
      "Path and time law from the start posture to the contact, at k times. Between them the\n"
      "joints follow cubic Hermite segments. Arrays are views that cannot be written.");
  approach.def_property_readonly(
      "status", [](const PlanApproach& a) { return to_string(a.data().status); },
      "'found', 'not_requested', or what kept the path from being found.");
  approach.def_property_readonly(
      "detail", [](const PlanApproach& a) { return a.data().detail; },
      "What failed, and by how much.");
  const auto number = [&approach](const char* name, double Approach::*member, const char* doc) {
    approach.def_property_readonly(
        name, [member](const PlanApproach& a) { return a.data().*member; }, doc);
  };
  number("duration", &Approach::duration, "Of the motion, s.");
  number("min_clearance", &Approach::min_clearance,
         "Smallest distance of bodies that may not touch, m.");
  number("attitude_excursion", &Approach::attitude_excursion,
         "Largest rotation angle from the base's final attitude, rad.");
  approach.def_property_readonly(
      "times",
      [](py::handle self) {
        const auto& times = self.cast<const PlanApproach&>().data().times;
        return view_of(times.data(), {times.size()}, {sizeof(double)}, self);
      },
      "(k,), s; the last one is the contact time.");
  const auto joints = [&approach](const char* name, std::vector<JointVectord> Approach::*member,
                                  const char* doc) {
    approach.def_property_readonly(
        name,
        [member](py::handle self) {
          return views_of(
              self.cast<const PlanApproach&>().data().*member,
              [](const JointVectord& x) -> auto& { return x; }, self);
        },
        doc);
  };
  joints("joint_positions", &Approach::joint_positions, "(k, n), rad (m).");
  joints("joint_velocities", &Approach::joint_velocities, "(k, n), rad/s (m/s).");
  joints("joint_accelerations", &Approach::joint_accelerations,
         "At the begin of the segment that starts at each sample, (k, n), rad/s^2 (m/s^2).");
  joints("joint_torques", &Approach::joint_torques, "At the same places, (k, n), N m (N).");
  approach.def_property_readonly(
      "base_positions",
      [](py::handle self) {
        return views_of(
            self.cast<const PlanApproach&>().data().base_poses,
            [](const Pose& pose) -> auto& { return pose.position; }, self);
      },
      "Of B in N, (k, 3), m.");
  approach.def_property_readonly(
      "base_orientations",
      [](const PlanApproach& a) {
        return quaternions_of(
            a.data().base_poses, [](const Pose& p) -> auto& { return p; });
      },
      "R_NB as [w, x, y, z], (k, 4).");
  approach.def_property_readonly(
      "base_velocities",
      [](py::handle self) {
        return views_of(
            self.cast<const PlanApproach&>().data().base_velocities,
            [](const Vector6d& x) -> auto& { return x; }, self);
      },
      "[v; omega] in B, (k, 6), m/s, rad/s.");
}

void register_candidate(py::module_& m) {
  py::class_<PlanCandidate> candidate(m, "Candidate", "A configuration that the search found.");
  candidate.def_property_readonly(
      "configuration", [](const PlanCandidate& c) { return c.candidate.configuration; },
      "Posture, base pose, time.");
  const auto number = [&candidate](const char* name, double Candidate::*member, const char* doc) {
    candidate.def_property_readonly(
        name, [member](const PlanCandidate& c) { return c.candidate.*member; }, doc);
  };
  number("objective", &Candidate::objective, "Nominal value, in the objective's unit.");
  number("worst_case", &Candidate::worst_case, "Over the cone of directions, in the same unit.");
  number("value", &Candidate::value, "Of the measure that is minimised, in the same unit.");
  number("max_violation", &Candidate::max_violation, "Of the constraints, in their units.");
  candidate.def_property_readonly(
      "collision_free", [](const PlanCandidate& c) { return c.candidate.collision_free; },
      "Nothing touches but hand and contact feature.");
  candidate.def_property_readonly(
      "collision", [](const PlanCandidate& c) { return c.candidate.collision; },
      "'a with b' where something touches.");
  candidate.def_property_readonly(
      "excluded", [](const PlanCandidate& c) { return c.candidate.excluded; },
      "Why one that ranks before the chosen one was not chosen; '' of the others.");
  candidate.def_property_readonly(
      "turns",
      [](const PlanCandidate& c) {
        py::dict turns;
        for (const JointTurns& joint : c.candidate.turns) {
          turns[py::str(joint.joint)] = py::make_tuple(joint.least, joint.most);
        }
        return turns;
      },
      "By joint, (least, most) whole turns from the stated angle that its limits leave room for.");
}

}  // namespace

std::shared_ptr<PlanResult> make_plan_result(PlanFile file, std::shared_ptr<Problem> problem) {
  if (problem == nullptr) problem = make_problem(file.plan.problem);
  return std::make_shared<PlanResult>(PlanResult{std::move(file), std::move(problem)});
}

void register_plan(py::module_& m) {
  register_candidate(m);
  register_approach(m);
  py::class_<PlanResult, std::shared_ptr<PlanResult>> plan(
      m, "Plan",
      "What a plan file holds: the chosen configuration, its impact, the search record.");
  plan.def_static("load", &load, py::arg("path"), py::kw_only(),
                  py::arg("check_fingerprint") = true,
                  "Reads a plan file. With check_fingerprint one that was changed after it was\n"
                  "written is refused. Raises InputError, FileError.");
  plan.def_static(
      "from_json",
      [](const std::string& text, const std::string& source) {
        return make_plan_result(read_plan(text, source));
      },
      py::arg("text"), py::arg("source") = "plan",
      "Reads the text of a plan file. Raises InputError.");
  plan.def(
      "save",
      [](const PlanResult& p, const std::filesystem::path& path, bool replace) {
        write_file_atomically(path.string(), text_of(p), replace);
      },
      py::arg("path"), py::kw_only(), py::arg("replace") = false,
      "Writes a plan file, whole or not at all; an existing one only with replace. Raises\n"
      "FileError.");
  plan.def("to_json", &text_of, "Text of the plan file.");
  plan.def(
      "to_dict", [](const PlanResult& p) { return python_of(io::Json::parse(text_of(p))); },
      "The plan file as a dict; numbers in lists are arrays.");
  plan.def_property_readonly(
      "status", [](const PlanResult& p) { return to_string(p.file.plan.status); },
      "'optimal', 'feasible', 'infeasible' or 'limit'.");
  plan.def_property_readonly(
      "optimizer", [](const PlanResult& p) { return p.file.plan.optimizer; }, "Its name.");
  plan.def_property_readonly(
      "problem", [](const PlanResult& p) { return p.problem; }, "The problem that was planned.");
  plan.def_property_readonly(
      "configuration", [](const PlanResult& p) { return p.file.plan.configuration; },
      "Where the robot is at the contact.");
  plan.def_property_readonly(
      "impact",
      [](const PlanResult& p) {
        return Impact{p.file.plan.impact, p.problem->robot};
      },
      "The nominal impact there.");
  plan.def_property_readonly(
      "objective", [](const PlanResult& p) { return objective_dict(p.file.plan.objective); },
      "name, unit, value (of the measure), nominal, worst_case, and the nominal terms.");
  plan.def_property_readonly(
      "candidates",
      [](const PlanResult& p) {
        py::list out;
        for (const Candidate& c : p.file.plan.candidates) out.append(PlanCandidate{c});
        return out;
      },
      "What the search found, in its order: docs/plan-file.md, the choice.");
  plan.def_property_readonly(
      "approach", [](std::shared_ptr<PlanResult> p) { return PlanApproach{std::move(p)}; },
      "Path to the configuration.");
  plan.def(py::pickle([](const PlanResult& p) { return py::make_tuple(text_of(p), p.problem); },
                      [](const py::tuple& state) {
                        auto problem = state[1].cast<std::shared_ptr<Problem>>();
                        PlanFile file = read_plan(state[0].cast<std::string>(), "plan");
                        if (problem != nullptr) {
                          file.plan.problem.user = problem->data.user;  // not in the text
                          file.plan.problem.source = problem->data.source;
                        }
                        return make_plan_result(std::move(file), std::move(problem));
                      }));
  plan.def("__repr__", [](const PlanResult& p) {
    const ObjectiveValue& objective = p.file.plan.objective;
    return fmt::format("<stillbase.Plan '{}': {}, {} {:.4g} {}>", p.file.plan.problem.name,
                       to_string(p.file.plan.status), objective.name, objective.value,
                       objective.unit);
  });

  m.def("plan", &plan_capture, py::arg("problem"), py::kw_only(), py::arg("progress") = py::none(),
        py::arg("time_limit") = py::none(), py::arg("max_approaches") = py::none(),
        py::arg("jobs") = 0,
        "Plans a capture: search, collisions, approach path. What was not found is a status of\n"
        "the plan, never an exception.\n"
        "\n"
        "progress(what, done, total) is called as work goes on; what it raises ends the call.\n"
        "time_limit, s: the best so far is returned, with the status 'limit' unless a path was "
        "found\n"
        "and judged by then. max_approaches:\n"
        "in place of the problem's approach.max_approaches. jobs: threads, 0 for as many as\n"
        "processors; the plan is the same. Other Python threads run meanwhile; "
        "Ctrl-C raises\n"
        "Interrupted, whose `result` is the best plan so far. Raises InputError for a problem\n"
        "whose parts do not fit together.");
}

}  // namespace stillbase::python
