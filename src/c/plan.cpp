// Plans of the C interface.
#include <atomic>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "c/c_interface.hpp"

using namespace stillbase;
using stillbase::c::copy_to;
using stillbase::c::guarded;
using stillbase::c::needed;

namespace {

stillbase_plan* handle_of(Plan plan, const ToolVersions& tool,
                          const std::vector<InputFile>& inputs) {
  auto handle = std::make_unique<stillbase_plan>();
  handle->status = to_string(plan.status);
  handle->json = plan_to_json(plan, tool, {}, inputs);
  handle->data = std::move(plan);
  return handle.release();
}

}  // namespace

stillbase_status stillbase_plan_make(const stillbase_problem* problem,
                                     const stillbase_plan_options* stated, stillbase_plan** plan) {
  return guarded([&] {
    const CaptureProblem& data = needed(problem, "problem").data;
    needed(plan, "plan");
    PlannerOptions options;
    std::atomic<bool> is_stopped{false};
    options.stop.interrupted = &is_stopped;
    if (stated != nullptr) {
      const double limit = stated->time_limit;
      if (!(limit >= 0)) throw c::ArgumentError("time_limit: must be >= 0 s");
      if (limit > 0) options.stop.set_deadline_after(limit);
      if (stated->jobs < 0) throw c::ArgumentError("jobs: must be >= 0");
      options.jobs = stated->jobs;
      if (stated->progress != nullptr) {
        options.on_progress = [&](const std::string& what, int done, int total) {
          if (stated->progress(what.c_str(), done, total, stated->user) != 0) is_stopped = true;
        };
      }
    }
    *plan = handle_of(make_plan(data, options), tool_versions(), {});
  });
}

stillbase_status stillbase_plan_read(const char* path, stillbase_plan** plan) {
  return guarded([&] {
    needed(path, "path");
    needed(plan, "plan");
    PlanFile file = load_plan(path);
    *plan = handle_of(std::move(file.plan), file.tool, file.inputs);
  });
}

stillbase_status stillbase_plan_write(const stillbase_plan* plan, const char* path, int replace) {
  return guarded([&] {
    needed(path, "path");
    write_file_atomically(path, needed(plan, "plan").json, replace != 0);
  });
}

void stillbase_plan_free(stillbase_plan* plan) { delete plan; }

int stillbase_plan_joints(const stillbase_plan* plan) {
  return plan == nullptr ? 0 : plan->data.problem.robot.n();
}

const char* stillbase_plan_status(const stillbase_plan* plan) {
  return plan == nullptr ? nullptr : plan->status.c_str();
}

const char* stillbase_plan_feature(const stillbase_plan* plan) {
  if (plan == nullptr) return nullptr;
  const std::string& chosen = plan->data.configuration.feature;
  return chosen.empty() ? plan->data.problem.variables.feature.c_str() : chosen.c_str();
}

const char* stillbase_plan_json(const stillbase_plan* plan) {
  return plan == nullptr ? nullptr : plan->json.c_str();
}

stillbase_status stillbase_plan_choice(const stillbase_plan* plan, stillbase_contact* contact,
                                       double* phi, stillbase_impact* impact,
                                       double* Delta_phidot) {
  return guarded([&] {
    const Plan& data = needed(plan, "plan").data;
    needed(phi, "phi");
    c::write_configuration(data.configuration, contact, phi);
    c::write_impact(data.impact, impact, Delta_phidot);
  });
}

size_t stillbase_plan_samples(const stillbase_plan* plan) {
  return plan == nullptr ? 0 : plan->data.approach.times.size();
}

stillbase_status stillbase_plan_path(const stillbase_plan* plan, double* times,
                                     double* joint_positions, double* joint_velocities) {
  return guarded([&] {
    const Approach& path = needed(plan, "plan").data.approach;
    needed(times, "times");
    needed(joint_positions, "joint_positions");
    const auto n = static_cast<std::size_t>(plan->data.problem.robot.n());
    for (std::size_t i = 0; i < path.times.size(); ++i) {
      times[i] = path.times[i];
      copy_to(joint_positions + i * n, path.joint_positions[i]);
      if (joint_velocities != nullptr) {
        copy_to(joint_velocities + i * n, path.joint_velocities[i]);
      }
    }
  });
}

stillbase_status stillbase_plan_verify(const stillbase_plan* plan, int* passes) {
  return guarded([&] {
    needed(passes, "passes");
    const Verification verification = judge_plan(needed(plan, "plan").data);
    *passes = verification.pass ? 1 : 0;
    std::string failed;
    for (const Claim& claim : verification.claims) {
      if (claim.fails()) failed += claim.name + ": " + claim.detail + "\n";
    }
    if (!failed.empty()) c::fail(STILLBASE_OK, failed.c_str());
  });
}
