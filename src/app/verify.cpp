// stillbase verify: the verdict on a plan file, claim by claim.
#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/verification/trials.hpp>
#include <stillbase/verification/verification.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/output.hpp"
#include "app/words.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::string plan, problem;
  OutputFile output;
  bool json = false;
  int trials = 0;
  std::uint64_t seed = 1;
  int jobs = 1;
};

/// The file says what it was when it was written; a changed one is told from that.
Claim fingerprint_claim(const std::string& name, const std::string& stated,
                        const std::string& computed) {
  const bool is_same = stated == computed;
  Claim claim;
  claim.name = name;
  claim.value = is_same ? 0 : 1;
  claim.limit = 0;
  claim.unit = "1";
  claim.pass = is_same;
  claim.detail = is_same ? "SHA-256 of what was read, as stated: " + stated
                         : "stated " + stated + ", of what was read " + computed;
  return claim;
}

/// Where the problem file of a plan is: as the user says, as the plan says, or beside the plan.
std::optional<std::string> problem_file_of(const PlanFile& file, const Options& options) {
  if (!options.problem.empty()) return options.problem;
  for (const InputFile& input : file.inputs) {
    if (input.role != "problem") continue;
    const std::filesystem::path stated(input.path);
    const auto beside = std::filesystem::path(options.plan).parent_path() / stated;
    for (const std::filesystem::path& path : {stated, beside}) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(path, ignored)) return path.string();
    }
  }
  return std::nullopt;
}

/// What a plan's problem says other than its file. The command line may choose optimizer, seed and
/// starts, and a file may have been given another name.
std::vector<std::string> changes_of_problem(const CaptureProblem& planned,
                                            const std::string& path) {
  std::vector<std::string> changes;
  CaptureProblem problem = read_problem(path);
  if (problem.urdf != planned.urdf) changes.push_back("the robot is another one");
  problem.name = planned.name;
  problem.search.optimizer = planned.search.optimizer;
  problem.search.seed = planned.search.seed;
  problem.search.starts = planned.search.starts;
  const io::Json of_file = io::Json::parse(problem_to_json(problem));
  const io::Json of_plan = io::Json::parse(problem_to_json(planned));
  for (const auto& [key, value] : of_file.items()) {
    if (!of_plan.contains(key) || of_plan.at(key) != value) {
      changes.push_back("'" + key + "' is not that of the file");
    }
  }
  for (const std::string& key : of_plan.keys()) {
    if (!of_file.contains(key)) changes.push_back("'" + key + "' is not in the file");
  }
  return changes;
}

/// The files that the plan was made from are the ones that it names, and its problem is theirs.
Claim inputs_claim(const PlanFile& file, const Options& options) {
  Claim claim;
  claim.name = "inputs_unchanged";
  claim.value = 0;
  claim.unit = "1";
  claim.pass = true;
  const auto path = problem_file_of(file, options);
  if (!path) {
    claim.detail = file.inputs.empty()
                       ? "not compared: the plan names no files"
                       : "not compared: " + file.inputs.front().path + " is not here (--problem)";
    return claim;
  }
  std::vector<std::string> changes;
  try {
    const std::vector<InputFile> found = input_files(*path);
    for (const InputFile& stated : file.inputs) {
      const auto same = [&stated](const InputFile& input) {
        return input.role == stated.role && input.sha256 == stated.sha256;
      };
      if (std::none_of(found.begin(), found.end(), same)) {
        changes.push_back("the " + stated.role + " file has another SHA-256");
      }
    }
    const auto more = changes_of_problem(file.plan.problem, *path);
    changes.insert(changes.end(), more.begin(), more.end());
  } catch (const std::exception& error) {
    changes.push_back(error.what());
  }
  claim.value = static_cast<double>(changes.size());
  claim.pass = changes.empty();
  claim.detail = claim.pass ? "the problem is that of " + *path + ", files as named"
                            : fmt::format("{}: {}", *path, fmt::join(changes, "; "));
  return claim;
}

std::string claim_line(const Claim& claim) {
  const std::string unit = claim.unit == "1" ? "" : " " + claim.unit;
  const std::string value = claim.value ? fmt::format("{:.4g}{}", *claim.value, unit) : "none";
  return fmt::format("{:<6} {:<34} {:>14}  limit {:.4g}{}  {}", claim.pass ? "ok" : "FAILED",
                     claim.name, value, claim.limit, unit, claim.detail);
}

std::string report_line(const ControllerReport& report) {
  if (!report.finished) {
    return fmt::format("{:<22} did not finish: {}", report.controller, report.detail);
  }
  return fmt::format(
      "{:<22} after {:g} s the base turns at {:.3g} deg/s (peak {:.3g}), it turned by {:.3g} deg; "
      "joint rates {:.3g} rad/s (norm; the fastest joint reached {:.3g})",
      report.controller, report.horizon, report.residual_base_rate * kDegrees,
      report.peak_base_rate * kDegrees, report.attitude_turned * kDegrees,
      report.residual_joint_rate, report.peak_joint_rate);
}

void print_summary(const Plan& plan, const Verification& verification) {
  say(fmt::format("{:<13} {}: {}", "problem", plan.problem.name, plan.problem.purpose));
  for (const Claim& claim : verification.claims) say(claim_line(claim));
  for (const ControllerReport& report : verification.reports) say(report_line(report));
  const auto failed = std::count_if(verification.claims.begin(), verification.claims.end(),
                                    [](const Claim& claim) { return !claim.pass; });
  if (verification.interrupted) {
    return say("verdict: none, the verification was interrupted; what is shown was judged or cut");
  }
  say(verification.pass
          ? fmt::format("verdict: pass, all {} claims hold", verification.claims.size())
          : fmt::format("verdict: FAIL, {} of {} claims do not hold", failed,
                        verification.claims.size()));
}

void print_trials(const TrialReport& report) {
  say(fmt::format(
      "{} trials: {} succeed, probability {:.4f} (95 % interval {:.4f} to {:.4f}, Wilson)",
      report.trials, report.successes, report.success_probability, report.success_lower,
      report.success_upper));
  for (const Spread& s : report.spreads) {
    say(fmt::format("  {:<20} median {:.4g}, 95 % below {:.4g}, worst {:.4g} (trial {})", s.name,
                    s.p50, s.p95, s.worst, s.worst_trial));
  }
  std::string output;
  for (const Sensitivity& s : report.sensitivities) {
    if (s.output == output) continue;  // the strongest of each
    output = s.output;
    say(fmt::format("  {:<20} depends most on {} (rank correlation {:.2f})", output, s.input,
                    s.rank_correlation));
  }
}

using Trials = std::pair<TrialSetting, TrialReport>;

std::optional<Trials> trials_of(const Plan& plan, const Options& options) {
  if (options.trials == 0) return std::nullopt;
  Trials trials;
  trials.first.sizes = perturbations_for(plan.problem);
  trials.first.seed = options.seed;
  trials.first.wanted = options.trials;
  trials.second = summarize_trials(run_trials(plan, trials.first.sizes, options.seed, 0,
                                              options.trials, options.jobs, stop_condition()));
  return trials;
}

int run(const Options& options) {
  options.output.check();
  const PlanFile file = read_plan(read_text_file(options.plan), options.plan);
  VerifyOptions verify;
  verify.stop = stop_condition();
  Verification verification = verify_plan(file.plan, verify);
  const Claim fingerprints[] = {
      fingerprint_claim("content_fingerprint", file.stated_sha256, file.computed_sha256),
      fingerprint_claim("robot_fingerprint", file.stated_robot_sha256, file.computed_robot_sha256),
      inputs_claim(file, options)};
  verification.claims.insert(verification.claims.begin(), std::begin(fingerprints),
                             std::end(fingerprints));
  for (const Claim& claim : fingerprints) verification.pass = verification.pass && claim.pass;

  // A plan that fails its claims may not even be one that can be tried.
  std::optional<Trials> trials;
  if (verification.pass) trials = trials_of(file.plan, options);
  const std::string text =
      verification_to_json(verification, file.computed_sha256, trials ? &*trials : nullptr);
  options.output.write(text);
  if (options.json && options.output.is_given()) write_stdout(text);
  print_summary(file.plan, verification);
  if (trials) print_trials(trials->second);
  if (trials && trials->second.trials < options.trials) {
    say(fmt::format("interrupted after {} of {} trials", trials->second.trials, options.trials));
  }
  if (options.trials > 0 && !trials) say("no trials: the plan does not pass its claims");
  if (options.output.is_given()) say(fmt::format("written to {}", options.output.path));
  if (signal_exit_code() != 0) return signal_exit_code();
  return verification.pass ? kDone : kVerificationFailed;
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "verify", "recompute everything that a plan says, by other code than the planner's");
  command->add_option("plan", options->plan, "plan file (JSON)")
      ->type_name("PLAN.json")
      ->required();
  command
      ->add_option("--problem", options->problem,
                   "problem file that the plan must be made from; without it the one that the plan "
                   "names, where it is")
      ->type_name("PROBLEM.yaml");
  add_output(*command, options->output, "-o,--output", "verification file (JSON); else stdout");
  command
      ->add_option("--trials", options->trials,
                   "try the impact and the time after it this often, everything a little off")
      ->check(CLI::Range(0, 100'000'000));
  command->add_option("--seed", options->seed, "of the trials; same seed, same trials")
      ->check(whole_number());
  command->add_option("--jobs", options->jobs, "trials at a time; results do not depend on it")
      ->check(CLI::Range(1, 256));
  command->add_flag("--json", options->json, "print the verification on stdout also with -o");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
