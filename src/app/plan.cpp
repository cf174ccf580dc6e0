// stillbase plan: a problem file in, a plan file out.
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "app/command_line.hpp"
#include "app/pareto.hpp"
#include "app/plan_summary.hpp"

namespace stillbase::app {

namespace {

struct PlanRequest {
  std::string problem, optimizer, pareto;
  std::optional<std::uint64_t> seed;
  std::optional<int> starts;
  double time_limit = 0;
  OutputFile output;
  bool json = false, is_verbose = false;
};

bool arrives(const Plan& plan) {
  return plan.approach.status == ApproachStatus::Found ||
         plan.approach.status == ApproachStatus::NotRequested;
}

int exit_code_of(const Plan& plan, bool keeps_limits) {
  if (signal_exit_code() != 0) return signal_exit_code();
  if (plan.status == PlanStatus::Limit) return kLimit;
  if (plan.status == PlanStatus::Infeasible) return kInfeasible;
  if (!arrives(plan)) return kNoApproach;
  return keeps_limits ? kDone : kInfeasible;
}

int plan_capture(const PlanRequest& request) {
  request.output.check();
  if (is_same_file(request.problem, request.output.path)) {
    throw CommandLineError("--output " + request.output.path + ": is the problem file itself");
  }
  if (!request.optimizer.empty() && !nlp::make_optimizer(request.optimizer)) {
    throw CommandLineError(fmt::format("--optimizer {}: unknown; there are {}", request.optimizer,
                                       fmt::join(nlp::optimizer_names(), ", ")));
  }
  CaptureProblem problem = read_problem(request.problem);
  const std::vector<InputFile> inputs = input_files(request.problem);
  if (!request.optimizer.empty()) problem.search.optimizer = request.optimizer;
  if (request.seed) problem.search.seed = *request.seed;
  if (request.starts) problem.search.starts = *request.starts;

  if (!request.pareto.empty()) {
    if (!problem.variables.features.empty()) {
      throw CommandLineError(
          "--pareto: the front is that of one contact feature; the problem leaves the choice of "
          "variables.feature open");
    }
    return run_pareto(problem, request.pareto, request.time_limit, request.output, request.json);
  }

  PlannerOptions planner;
  planner.stop = stop_condition(request.time_limit);
  ProgressLine progress;
  planner.on_progress = [&](const std::string& what, int done, int total) {
    progress.show(what, done, total);
  };
  Plan plan = make_plan(problem, planner);
  progress.clear();
  // Stopped while looking for an approach: the configuration is good, the plan is not complete.
  const bool approach_cut =
      !arrives(plan) && plan.status != PlanStatus::Infeasible && planner.stop.reached();
  if (approach_cut) plan.status = PlanStatus::Limit;

  const std::string text = plan_to_json(plan, tool_versions(), {}, inputs);
  request.output.write(text);
  if (request.json && request.output.is_given()) write_stdout(text);
  say(summary_text(plan_summary(plan, request.is_verbose)));
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  // The best that was found may still break what is asked of the time after the impact.
  std::string broken;
  if (plan.status != PlanStatus::Infeasible && arrives(plan) && !planner.stop.reached()) {
    broken = post_impact_failure(plan.problem, plan.configuration, plan.impact, planner.stop);
  }
  if (!broken.empty()) {
    say(fmt::format("no configuration was found that keeps the limits after the impact: {} ({})",
                    broken, plan.problem.post_impact.controllers.front()));
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
          {"--optimizer", "NAME",
           "local solver in place of the problem's, e.g. nlopt-slsqp or ipopt",
           &request->optimizer},
          {"--seed", "", "seed of all random choices", &request->seed},
          {"--starts", "N", "starts of the search", &request->starts, false, 1, kMaxStarts},
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
