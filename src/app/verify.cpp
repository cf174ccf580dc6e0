// stillbase verify: does a plan work, and is its search record right?
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/verification/trials.hpp>

#include "app/command_line.hpp"
#include "app/judgement.hpp"
#include "app/trial_words.hpp"

namespace stillbase::app {

namespace {

struct VerifyRequest {
  std::string plan, problem;
  OutputFile output;
  bool json = false, shows_all = false, reruns = false;
  int trials = 0;
  std::uint64_t seed = 1;
  int jobs = 0;
  double time_limit = 0;
};

using Trials = std::pair<TrialSetting, TrialReport>;

std::optional<Trials> trials_of(const Plan& plan, const VerifyRequest& request,
                                const StopCondition& stop) {
  if (request.trials == 0) return std::nullopt;
  Trials trials;
  trials.first.sizes = perturbations_for(plan.problem);
  trials.first.seed = request.seed;
  trials.first.wanted = request.trials;
  ProgressLine progress;
  const std::vector<TrialOutcome> outcomes = run_trials(
      plan, trials.first.sizes, request.seed, 0, request.trials, jobs_or_processors(request.jobs),
      stop, [&progress](int done, int total) { progress.show("trials", done, total); });
  trials.second = summarize_trials(outcomes, 0, objective_unit_name(plan.problem));
  trials.second.failures = count_failures(outcomes, plan.problem.post_impact);
  return trials;
}

std::vector<std::string> next_of(const VerifyRequest& request, bool pass) {
  if (pass) {
    std::vector<std::string> words{"report", request.plan};
    if (request.output.is_given()) words.push_back(request.output.path);
    words.insert(words.end(), {"-o", with_extension(request.plan, ".html")});
    return words;
  }
  if (!request.shows_all) return {"verify", request.plan, "--all"};
  return {"check", request.plan};
}

int verify_plan_file(const VerifyRequest& request) {
  request.output.check({".json"});
  const PlanFile file = read_plan(read_text_file(request.plan), request.plan);
  VerifyOptions verify;
  verify.stop = stop_condition(request.time_limit);
  Verification verification = judge_plan(file.plan, verify);
  add_input_checks(file, request.plan, request.problem, verification);
  if (request.reruns) add_repeated_search(file, request.jobs, verification);

  // A plan that fails may lack what a trial needs.
  std::optional<Trials> trials;
  if (verification.pass) trials = trials_of(file.plan, request, verify.stop);
  const std::string text =
      verification_to_json(verification, file.computed_sha256, trials ? &*trials : nullptr);
  publish_verification(file.plan, verification, text,
                       {request.output, request.json, request.shows_all, "verification"});
  if (trials) say(trial_words(trials->second, &file.plan.problem.post_impact));
  const bool are_cut = trials && trials->second.trials < request.trials;
  if (are_cut) {
    say(fmt::format("interrupted after {} of {} trials", trials->second.trials, request.trials));
  }
  const bool has_failed = !verification.pass && !verification.interrupted;
  if (request.trials > 0 && has_failed) say("no trials: the plan fails its verification");
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  if (!verification.interrupted) say_next(next_of(request, verification.pass));
  if (signal_exit_code() != 0) return signal_exit_code();
  if (verification.interrupted || are_cut) return kLimit;
  return verification.pass ? kDone : kVerificationFailed;
}

}  // namespace

Command verify_command() {
  auto request = std::make_shared<VerifyRequest>();
  return {
      "verify",
      "recompute a plan by other code than the planner's: does it work, and is its search record "
      "right",
      std::vector<Option>{
          {"plan", "PLAN.json", "plan file (JSON)", &request->plan, true},
          {"--problem", "PROBLEM.yaml",
           "problem file that the plan must be made from; without it the one that the plan "
           "names, where it is",
           &request->problem},
          {"--trials", "N",
           "simulate impact and motion after it this often, with random errors in direction, "
           "speed, mass, contact point and sensors",
           &request->trials, false, 0, 100'000'000},
          {"--seed", "", "of the trials; same seed, same trials", &request->seed},
          {"--jobs", "N",
           "threads of trials and of a repeated search, by default as many as processors; results "
           "do not depend on it",
           &request->jobs, false, 1, 256},
          {"--all", "", "print every check in full, also those that hold", &request->shows_all},
          {"--time-limit", "S", "seconds after which checks and trials stop", &request->time_limit},
          {"--rerun", "", "repeat the search and compare all bytes of the plan", &request->reruns},
          {"--json", "", "print the verification on stdout also with -o", &request->json}} +
          output_options(request->output, "-o,--output", "verification file (JSON); else stdout"),
      [request] { return verify_plan_file(*request); }};
}

}  // namespace stillbase::app
