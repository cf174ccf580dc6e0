// stillbase plan: a problem file in, a plan file out.
#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/planner/planner.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/load.hpp"
#include "app/output.hpp"
#include "app/pareto.hpp"
#include "app/plan_summary.hpp"
#include "planner/post_impact.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::string problem, optimizer, pareto;
  std::optional<std::uint64_t> seed;
  std::optional<int> starts;
  double time_limit = 0;
  OutputFile output;
  bool json = false;
};

ToolVersions tool_versions() {
  ToolVersions versions{{"stillbase", STILLBASE_VERSION},
                        {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                              EIGEN_MINOR_VERSION)}};
#if defined(__clang__)
  versions["compiler"] = fmt::format("clang {}.{}", __clang_major__, __clang_minor__);
#elif defined(__GNUC__)
  versions["compiler"] = fmt::format("g++ {}.{}", __GNUC__, __GNUC_MINOR__);
#endif
  return versions;
}

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

int run(const Options& options) {
  options.output.check();
  if (is_same_file(options.problem, options.output.path)) {
    throw CommandLineError("--output " + options.output.path + ": is the problem file itself");
  }
  if (!options.optimizer.empty() && !nlp::make_optimizer(options.optimizer)) {
    throw CommandLineError(fmt::format("--optimizer {}: unknown; there are {}", options.optimizer,
                                       fmt::join(nlp::optimizer_names(), ", ")));
  }
  CaptureProblem problem = read_problem(options.problem);
  const std::vector<InputFile> inputs = input_files(options.problem);
  if (!options.optimizer.empty()) problem.search.optimizer = options.optimizer;
  if (options.seed) problem.search.seed = *options.seed;
  if (options.starts) problem.search.starts = *options.starts;

  if (!options.pareto.empty()) {
    if (!problem.variables.features.empty()) {
      throw CommandLineError(
          "--pareto: the front is that of one contact feature; the problem leaves the choice of "
          "variables.feature open");
    }
    return run_pareto(problem, options.pareto, options.time_limit, options.output, options.json);
  }

  PlannerOptions planner;
  planner.stop = stop_condition(options.time_limit);
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
  options.output.write(text);
  if (options.json && options.output.is_given()) write_stdout(text);
  say(plan_summary(plan));
  if (options.output.is_given()) say(fmt::format("written to {}", options.output.path));
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

void add_plan(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "plan", "find the posture in which an impact disturbs the base least, and the way to it");
  command->add_option("problem", options->problem, "problem file (YAML)")
      ->type_name("PROBLEM.yaml")
      ->required();
  add_output(*command, options->output, "-o,--output", "plan file (JSON); without it stdout");
  command->add_option("--optimizer", options->optimizer,
                      "local solver in place of the problem's, e.g. nlopt-slsqp or ipopt");
  command->add_option("--seed", options->seed, "seed of all random choices")->check(whole_number());
  command->add_option("--starts", options->starts, "starts of the search")
      ->check(CLI::Range(1, kMaxStarts));
  command->add_option("--time-limit", options->time_limit, "seconds after which the search stops")
      ->type_name("S")
      ->check(positive_number());
  command
      ->add_option("--pareto", options->pareto,
                   "no plan, but the front of two quantities, e.g. "
                   "base_angular_momentum,joint_rate_norm (.json, .csv or .svg)")
      ->type_name("A,B");
  command->add_flag("--json", options->json, "print the plan on stdout also with -o");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
