// Checks of a plan's inputs, and how the checks of a plan are printed.
#include "app/judgement.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "app/words.hpp"
#include "audit/search_record.hpp"
#include "io/json.hpp"
#include "io/problem_reader.hpp"

namespace stillbase::app {

std::optional<std::string> problem_file_of(const PlanFile& file, const std::string& plan_path,
                                           const std::string& problem_path) {
  if (!problem_path.empty()) return problem_path;
  for (const InputFile& input : file.inputs) {
    if (input.role != "problem") continue;
    const std::filesystem::path stated(input.path);
    const auto beside = std::filesystem::path(plan_path).parent_path() / stated;
    for (const std::filesystem::path& path : {stated, beside}) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(path, ignored)) return path.string();
    }
  }
  return std::nullopt;
}

namespace {

constexpr const char* kRepeated = "search_repeated";

/// SHA-256 that the file states against that of what was read.
Claim fingerprint_check(const std::string& name, const std::string& stated,
                        const std::string& computed) {
  const bool is_same = stated == computed;
  return {name,
          is_same ? 0.0 : 1.0,
          0,
          "1",
          is_same,
          is_same ? "SHA-256 of what was read, as stated: " + stated
                  : "stated " + stated + ", of what was read " + computed};
}

bool have_same_remarks(const RobotModel& one, const RobotModel& other) {
  return std::equal(one.remarks.begin(), one.remarks.end(), other.remarks.begin(),
                    other.remarks.end(), [](const Finding& a, const Finding& b) {
                      return a.file == b.file && a.line == b.line && a.rule == b.rule &&
                             a.message == b.message;
                    });
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

/// Differences of a plan's problem from its file. The command line may choose optimizer, seed and
/// starts, and a file may have been renamed.
/// @param stated the problem's file as the plan names it
std::vector<std::string> changes_of_problem(const CaptureProblem& planned, const std::string& path,
                                            const std::string& stated) {
  std::vector<std::string> changes;
  CaptureProblem problem = read_problem(path);
  const bool is_named_by_file = problem.name == stem_of(path);
  const std::string name = is_named_by_file ? stem_of(stated) : problem.name;
  if (planned.name != name) {
    changes.push_back(fmt::format("the problem's name is {}, not {}", planned.name, name));
  }
  if (problem.urdf != planned.urdf) changes.push_back("the robot is another one");
  if (!have_same_remarks(problem.robot, planned.robot)) {
    changes.push_back("the remarks on the robot's file are others");
  }
  problem.name = planned.name;
  problem.search.optimizer = planned.search.optimizer;
  problem.search.seed = planned.search.seed;
  problem.search.starts = planned.search.starts;
  const io::Json of_file = io::problem_json(problem), of_plan = io::problem_json(planned);
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

/// Adds the differences between the files that a plan names and those of its problem, in any order.
/// A problem file may have been renamed; the other paths are those in its text.
void changes_of_inputs(const std::vector<InputFile>& stated, std::vector<InputFile> found,
                       std::vector<std::string>& changes) {
  for (const InputFile& input : stated) {
    const auto same = [&input](const InputFile& other) {
      return other.role == input.role && other.sha256 == input.sha256 &&
             (other.path == input.path || input.role == "problem");
    };
    const auto at = std::find_if(found.begin(), found.end(), same);
    if (at == found.end()) {
      changes.push_back(fmt::format("no {} file of the problem has the path {} and the SHA-256 {}",
                                    input.role, input.path, input.sha256));
    } else {
      found.erase(at);
    }
  }
  for (const InputFile& input : found) {
    changes.push_back(
        fmt::format("the {} file {} is not among the plan's inputs", input.role, input.path));
  }
}

/// The files that the plan was made from are the ones that it names, and its problem is theirs.
Claim inputs_check(const PlanFile& file, const std::string& plan_path,
                   const std::string& problem_path) {
  Claim claim{"inputs_unchanged", 0.0, 0, "1", true, {}};
  const auto path = problem_file_of(file, plan_path, problem_path);
  if (!path) {
    claim.value.reset();
    claim.pass = claim.is_checked = false;
    claim.detail = file.inputs.empty()
                       ? "not compared: the plan names no files"
                       : "not compared: " + file.inputs.front().path + " is not here (--problem)";
    return claim;
  }
  std::vector<std::string> changes;
  std::string stated = *path;
  for (const InputFile& input : file.inputs) {
    if (input.role == "problem") stated = input.path;
  }
  try {
    if (!file.inputs.empty()) changes_of_inputs(file.inputs, input_files(*path), changes);
    const auto more = changes_of_problem(file.plan.problem, *path, stated);
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

const char* mark_of(const Claim& claim) {
  return claim.pass ? "ok" : claim.fails() ? "FAILED" : "open";
}

std::string check_line(const Claim& claim) {
  const std::string unit = claim.unit == "1" ? "" : " " + claim.unit;
  const std::string value = claim.value ? fmt::format("{:.4g}{}", *claim.value, unit) : "none";
  const std::string mark = fmt::format("{:<6}", mark_of(claim));
  return fmt::format("  {} {:<34} {:>14}  limit {:.4g}{}  {}",
                     claim.pass      ? mark
                     : claim.fails() ? toned(Tone::Bad, mark)
                                     : toned(Tone::Open, mark),
                     claim.name, value, claim.limit, unit, claim.detail);
}

/// What the checks of each group answer, in the order in which they are printed.
constexpr std::pair<ClaimGroup, const char*> kHeadings[] = {
    {ClaimGroup::Inputs, "inputs: files and shape of the plan"},
    {ClaimGroup::Physics, "physics: impulse, motion right after the impact, objective"},
    {ClaimGroup::Constraints, "constraints: configuration at the contact"},
    {ClaimGroup::Approach, "approach: path to the contact"},
    {ClaimGroup::AfterContact, "after the contact: first controller, target"},
    {ClaimGroup::Audit, "audit: candidates, optimum, proof"},
    {ClaimGroup::SearchRecord, "search record: counts that only the search knows"}};

std::string report_line(const ControllerReport& report) {
  if (!report.finished) {
    return fmt::format("{:<22} did not finish: {}", report.controller, report.detail);
  }
  return fmt::format(
      "{:<22} after {:g} s the base rotates at {} deg/s (peak {}), its attitude changed by {} deg; "
      "joint rates {} rad/s (norm; the fastest joint reached {})",
      report.controller, report.horizon, size_words(report.residual_base_rate * kDegrees),
      size_words(report.peak_base_rate * kDegrees), size_words(report.attitude_turned * kDegrees),
      size_words(report.residual_joint_rate), size_words(report.peak_joint_rate));
}

std::vector<Claim> checks_of(const Verification& verification, ClaimGroup group) {
  std::vector<Claim> checks;
  std::copy_if(verification.claims.begin(), verification.claims.end(), std::back_inserter(checks),
               [group](const Claim& claim) { return claim.group == group; });
  return checks;
}

void print_all_checks(const Verification& verification) {
  for (const auto& [group, heading] : kHeadings) {
    const std::vector<Claim> checks = checks_of(verification, group);
    if (!checks.empty()) say(heading);
    for (const Claim& claim : checks) say(check_line(claim));
  }
}

/// What stands in the plan by the word of the search alone. A search that was to be repeated and
/// was not is another matter: the reason for it is printed.
bool is_own_record(const Claim& claim) {
  return claim.group == ClaimGroup::SearchRecord && !claim.is_checked && claim.name != kRepeated;
}

/// The open checks of the search record as one line; empty without one.
std::string own_record_line(const std::vector<Claim>& checks) {
  std::vector<std::string> names;
  for (const Claim& claim : checks) {
    if (is_own_record(claim)) names.push_back(claim.name);
  }
  if (names.empty()) return "";
  return fmt::format("  {:>9} open  search record: {} (the search's own word; --rerun repeats it)",
                     names.size(), fmt::join(names, ", "));
}

/// Failed and open checks in full, then one line per group, and one for what the search alone
/// knows.
void print_grouped_checks(const Verification& verification) {
  const auto print_where = [&](bool (*is_wanted)(const Claim&)) {
    for (const Claim& claim : verification.claims) {
      if (is_wanted(claim)) say(check_line(claim));
    }
  };
  print_where([](const Claim& claim) { return claim.fails(); });
  print_where([](const Claim& claim) { return !claim.is_checked && !is_own_record(claim); });
  for (const auto& [group, heading] : kHeadings) {
    const std::vector<Claim> checks = checks_of(verification, group);
    if (checks.empty()) continue;
    if (const std::string line = own_record_line(checks); !line.empty()) {
      say(line);
      continue;
    }
    const auto held =
        std::count_if(checks.begin(), checks.end(), [](const Claim& c) { return c.pass; });
    const bool all = held == static_cast<long>(checks.size());
    const std::string of_all = all ? "" : fmt::format(" of {}", checks.size());
    say(fmt::format("  {:>9} hold  {}", fmt::format("{}{}", held, of_all), heading));
  }
}

void print_verdict(const Verification& verification, const std::string& what) {
  const auto& checks = verification.claims;
  if (verification.interrupted) {
    return say(
        toned(Tone::Open, "verdict: none, it was interrupted; the remaining checks were not made"));
  }
  const auto failed =
      std::count_if(checks.begin(), checks.end(), [](const Claim& c) { return c.fails(); });
  const auto open =
      std::count_if(checks.begin(), checks.end(), [](const Claim& c) { return !c.is_checked; });
  const auto of_search = std::count_if(checks.begin(), checks.end(), is_own_record);
  std::string not_checked;
  if (open > of_search) not_checked += fmt::format(", {} could not be checked", open - of_search);
  if (of_search > 0) {
    not_checked += fmt::format(", {} not verified (the search's own record)", of_search);
  }
  const std::string against =
      verification.is_against_file ? "" : ", against the plan's own copy of the problem";
  say(verification.pass
          ? toned(Tone::Good,
                  fmt::format("verdict: pass, all {} {} checks hold{}{}",
                              static_cast<long>(checks.size()) - open, what, not_checked, against))
          : toned(Tone::Bad, fmt::format("verdict: FAIL, {} of {} {} checks do not hold{}{}",
                                         failed, static_cast<long>(checks.size()) - open, what,
                                         not_checked, against)));
}

}  // namespace

void add_input_checks(const PlanFile& file, const std::string& plan_path,
                      const std::string& problem_path, Verification& verification) {
  const Claim checks[] = {
      fingerprint_check("content_fingerprint", file.stated_sha256, file.computed_sha256),
      fingerprint_check("robot_fingerprint", file.stated_robot_sha256, file.computed_robot_sha256),
      inputs_check(file, plan_path, problem_path)};
  verification.claims.insert(verification.claims.begin(), std::begin(checks), std::end(checks));
  verification.pass = verification.pass && all_hold(verification.claims);
  verification.is_against_file = std::end(checks)[-1].is_checked;
}

void add_repeated_search(const PlanFile& file, int jobs, Verification& verification) {
  Claim claim{kRepeated, std::nullopt, 0, "1", false, {}, ClaimGroup::SearchRecord, false};
  if (file.plan.status == PlanStatus::Limit) {
    claim.detail = "not verified: a limit ended the search";
    verification.claims.push_back(claim);
    return;
  }
  PlannerOptions options;
  options.stop = stop_condition();
  options.jobs = jobs;
  ProgressLine progress;
  options.on_progress = [&](const std::string& what, int done, int total) {
    progress.show("repeated " + what, done, total);
  };
  const Plan repeated = make_plan(file.plan.problem, options);
  progress.clear();
  if (options.stop.reached()) {
    claim.detail = "not verified: stopped before its end";
    verification.claims.push_back(claim);
    return;
  }
  const io::Json stated = io::Json::parse(plan_to_json(file.plan, {}, {}, file.inputs));
  const io::Json found = io::Json::parse(plan_to_json(repeated, {}, {}, file.inputs));
  std::vector<std::string> different;
  for (const auto& [key, value] : stated.items()) {
    if (key == "tool" || key == "timing" || key == "content_sha256") continue;
    if (!found.contains(key) || found.at(key) != value) different.push_back(key);
  }
  claim.is_checked = true;
  claim.pass = different.empty();
  claim.value = static_cast<double>(different.size());
  claim.detail =
      claim.pass ? "the repeated search gives the same plan, byte for byte"
                 : fmt::format("the repeated search gives other {}", fmt::join(different, ", "));
  if (claim.pass) {
    // What the search alone knows holds with it.
    for (Claim& record : verification.claims) {
      if (record.group != ClaimGroup::SearchRecord) continue;
      record.is_checked = record.pass = true;
      record.value = 0;
      const std::string said = audit::kSearchSays;
      if (record.detail.starts_with(said)) {
        record.detail = "repeated: " + record.detail.substr(said.size());
      }
    }
  }
  verification.claims.push_back(claim);
  verification.pass = verification.pass && claim.pass;
}

void publish_verification(const Plan& plan, const Verification& verification,
                          const std::string& text, const Publication& publication) {
  publication.output.write(text);
  if (publication.as_json && publication.output.is_given()) write_stdout(text);
  print_verdict(verification, publication.what);
  say(fmt::format("{:<13} {}: {}", "problem", plan.problem.name, plan.problem.purpose));
  if (publication.shows_all) {
    print_all_checks(verification);
  } else {
    print_grouped_checks(verification);
  }
  for (const ControllerReport& report : verification.reports) say(report_line(report));
}

}  // namespace stillbase::app
