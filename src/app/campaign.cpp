// stillbase campaign: many plans, many trials, on many machines.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/campaign/campaign.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/planner/planner.hpp>

#include "app/command_line.hpp"
#include "app/trial_words.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

// --- make

struct CampaignMakeRequest {
  std::string spec;
  OutputFile output;
};

std::string absolute(const std::string& path, const std::string& spec) {
  return fs::absolute(fs::path(spec).parent_path() / path).lexically_normal().string();
}

int make_cases(const CampaignMakeRequest& request) {
  request.output.check({".jsonl"});
  const CampaignSpec spec = read_campaign_spec(read_text_file(request.spec), request.spec);
  std::string text;
  const auto add = [&](const CampaignCase& piece) { text += case_to_text(piece) + "\n"; };
  for (const std::string& name : spec.plans) {
    CampaignCase piece;
    piece.plan = absolute(name, request.spec);
    const std::string content = read_text_file(piece.plan);
    (void)load_plan(piece.plan);  // refused now, not a thousand times later
    piece.sha256 = sha256_hex(content);
    for (const std::uint64_t seed : spec.seeds) {
      piece.seed = seed;
      for (piece.first = 0; piece.first < spec.trials; piece.first += piece.count) {
        piece.count = std::min(spec.trials_per_case, spec.trials - piece.first);
        add(piece);
      }
    }
  }
  for (const std::string& name : spec.problems) {
    CampaignCase piece;
    piece.problem = absolute(name, request.spec);
    (void)read_problem(piece.problem);
    piece.sha256 = sha256_hex(read_text_file(piece.problem));
    piece.count = spec.trials;
    for (const std::uint64_t seed : spec.seeds) {
      piece.seed = seed;
      add(piece);
    }
  }
  std::size_t count = 0;
  try {
    count = cases_from_text(text, request.spec).size();
  } catch (const InputError& error) {
    // The lines of the finding are those of generated cases: one file is named twice.
    throw InputError({{request.spec, 0, "duplicate-case",
                       fmt::format("plans and problems: the same file may be named once ({})",
                                   error.findings().front().message)}});
  }
  request.output.write(text);
  say(fmt::format("{} cases", count));
  if (request.output.is_given()) {
    const std::string folder = fs::path(request.output.path).replace_extension().string();
    say_next({"campaign", "run", request.output.path, "-o", folder});
  }
  return kDone;
}

/// The same for all cases whose trials belong together: those of a plan or problem with a seed.
std::string subject_key(CampaignCase piece) {
  piece.first = piece.count = 0;
  return case_to_text(piece);
}

/// Path of its plan or problem file.
std::string file_of(const CampaignCase& piece) {
  return piece.plan.empty() ? piece.problem : piece.plan;
}

std::string subject_of(const CampaignCase& piece) {
  return fmt::format("{}, seed {}", file_of(piece), piece.seed);
}

/// Trials of one case.
struct TrialRange {
  std::int64_t first = 0, end = 0;  ///< end: behind the last one
  int line = 0;                     ///< of the case
};

/// "trial 3" or "trials 3 to 5".
std::string range_words(const TrialRange& range) {
  return range.end - range.first == 1 ? fmt::format("trial {}", range.first)
                                      : fmt::format("trials {} to {}", range.first, range.end - 1);
}

/// Which trials the cases of a list have, each at most once.
class TrialRanges {
 public:
  /// @return an earlier case that shares a trial with this one, which is left out then
  std::optional<TrialRange> add(const std::string& subject, const TrialRange& range) {
    std::map<std::int64_t, TrialRange>& ranges = subjects_[subject];
    if (range.end == range.first) return std::nullopt;
    const auto next = ranges.lower_bound(range.first);
    if (next != ranges.end() && next->second.first < range.end) return next->second;
    if (next != ranges.begin() && std::prev(next)->second.end > range.first) {
      return std::prev(next)->second;
    }
    ranges[range.first] = range;
    return std::nullopt;
  }

  /// Trials before a subject's last one that no case has.
  std::vector<TrialRange> gaps(const std::string& subject) const {
    std::vector<TrialRange> out;
    std::int64_t covered = 0;
    for (const auto& entry : subjects_.at(subject)) {
      const TrialRange& range = entry.second;
      if (range.first > covered) out.push_back({covered, range.first});
      covered = range.end;
    }
    return out;
  }

 private:
  std::map<std::string, std::map<std::int64_t, TrialRange>> subjects_;  ///< by first trial
};

TrialRange range_of(const CampaignCase& piece, int line) {
  return {piece.first, std::int64_t{piece.first} + piece.count, line};
}

/// The cases of a list, one per line.
/// @throws InputError with the bad lines, at most `kMostBadLines` of them
std::vector<CampaignCase> read_cases(const std::vector<std::string>& lines,
                                     const std::string& path) {
  constexpr std::size_t kMostBadLines = 20;
  std::vector<CampaignCase> cases;
  std::vector<Finding> findings;
  TrialRanges ranges;
  for (std::size_t i = 0; i < lines.size() && findings.size() < kMostBadLines; ++i) {
    const int line = static_cast<int>(i) + 1;
    try {
      cases.push_back(case_from_text(lines[i], path, line));
      const CampaignCase& piece = cases.back();
      const TrialRange range = range_of(piece, line);
      const std::optional<TrialRange> other = ranges.add(subject_key(piece), range);
      if (!other) continue;
      findings.push_back(
          {path, line, "overlapping-case",
           fmt::format("{} of {}: line {} has {} of it; a trial may be in one case "
                       "alone",
                       range_words(range), subject_of(piece), other->line, range_words(*other))});
    } catch (const InputError& error) {
      findings.push_back(error.findings().front());
    }
  }
  if (!findings.empty()) throw InputError(std::move(findings));
  return cases;
}

/// "3 (Killed (3 tries)), 7 (...)": cases whose workers died.
std::string dead_words(const MergedCampaign& merged) {
  std::vector<std::string> words;
  for (const CaseRecord& record : merged.records) {
    if (record.status != CaseStatus::Died) continue;
    words.push_back(fmt::format("{} ({})", record.number, record.text));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

// --- run

struct CampaignRunRequest {
  std::string cases, shard = "1/1", folder;
  int jobs = 1;
  double seconds = 3600;
};

/// Content of the plan or problem file of a case.
/// @throws InputError as read_text_file(), and for a file that has changed; FileError
std::string read_file_of(const CampaignCase& piece) {
  std::string content = read_text_file(file_of(piece));
  if (sha256_hex(content) != piece.sha256) {
    throw InputError({{file_of(piece), 0, "fingerprint",
                       "the file has changed since `campaign make`; put it back, or make the list "
                       "of cases again and run it in another folder"}});
  }
  return content;
}

/// Reads the files of a case before its worker begins: that one is not there says nothing of the
/// case.
/// @throws InputError, FileError
void check_files(const std::string& text) {
  const CampaignCase piece = case_from_text(text);
  (void)read_file_of(piece);
  if (!piece.problem.empty()) (void)input_files(piece.problem);
}

/// The worker: a case's text in, its result out. What it throws becomes the record of a crash.
std::string work(const std::string& text) {
  const CampaignCase piece = case_from_text(text);
  const std::string path = file_of(piece);
  const std::string content = read_file_of(piece);
  CampaignCaseResult result;
  Plan plan;
  if (piece.problem.empty()) {
    plan = read_plan(content, path).plan;
    result.plan_status = "given";
  } else {
    CaptureProblem problem = read_problem(path);
    problem.search.seed = piece.seed;
    PlannerOptions options;
    options.jobs = 1;  // the other processors have cases of their own
    plan = make_plan(problem, options);
    result.plan_status = to_string(plan.status);
  }
  result.verified = judge_plan(plan).pass;
  std::vector<TrialOutcome> outcomes;
  if (plan.status != PlanStatus::Infeasible) {
    outcomes =
        run_trials(plan, perturbations_for(plan.problem), piece.seed, piece.first, piece.count, 1);
  }
  result.outcomes = trial_outcomes_to_text(outcomes);
  return case_result_to_text(result);
}

int run_cases(const CampaignRunRequest& request) {
  CampaignOptions campaign;
  campaign.folder = request.folder;
  try {
    campaign.shard = shard_from_text(request.shard);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(error.what());
  }
  campaign.jobs = request.jobs;
  campaign.seconds = request.seconds;
  campaign.stop = stop_condition();
  campaign.check_case = check_files;
  ProgressLine progress;
  campaign.on_progress = [&](int done, int total) { progress.show("cases", done, total); };
  const std::string cases = read_text_file(request.cases);
  (void)read_cases(cases_from_text(cases, request.cases), request.cases);
  const CampaignRun done = run_campaign(cases, campaign, work);
  progress.clear();
  say(fmt::format("shard {}: {} of {} cases done, {} of them now; {} failed", request.shard,
                  done.found + done.recorded, done.cases, done.recorded, done.failed));
  if (!done.died.empty()) {
    say(fmt::format("the workers of {} cases died {} times each: {}; the same command tries again",
                    done.died.size(), campaign.tries, fmt::join(done.died, ", ")));
  }
  if (signal_exit_code() != 0) return signal_exit_code();
  if (done.is_complete()) {
    say_next({"campaign", "merge", request.folder, "-o", request.folder + ".json"});
  }
  return done.is_complete() ? kDone : kCampaignIncomplete;
}

// --- merge

struct CampaignMergeRequest {
  std::string folder;
  OutputFile output;
};

/// Trials of the same plan or problem with the same seed.
struct Group {
  io::CampaignGroup result;
  std::map<int, std::vector<TrialOutcome>> parts;  ///< by first trial
};

void summarize(Group& group) {
  std::vector<TrialOutcome> outcomes;
  std::vector<int> numbers;  // of their trials: some may be in no case, or in one that failed
  for (const auto& [first, part] : group.parts) {
    for (std::size_t i = 0; i < part.size(); ++i) {
      outcomes.push_back(part[i]);
      numbers.push_back(first + static_cast<int>(i));
    }
  }
  const CampaignCase& piece = group.result.piece;
  const CaptureProblem problem =
      piece.plan.empty() ? read_problem(piece.problem)
                         : read_plan(read_text_file(piece.plan), piece.plan).plan.problem;
  group.result.trials.first.sizes = perturbations_for(problem);
  group.result.trials.first.seed = piece.seed;
  group.result.trials.second = summarize_trials(outcomes, 0, objective_unit_name(problem));
  for (Spread& spread : group.result.trials.second.spreads) {
    spread.worst_trial = numbers[static_cast<std::size_t>(spread.worst_trial)];
  }
  group.result.trials.second.failures = count_failures(outcomes, problem.post_impact);
}

/// In the order in which the cases name them.
std::vector<io::CampaignGroup> groups_of(const MergedCampaign& merged,
                                         const std::vector<CampaignCase>& cases) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> numbers;
  for (const CaseRecord& record : merged.records) {
    if (record.status != CaseStatus::Finished) continue;
    const CampaignCase& piece = cases[static_cast<std::size_t>(record.number)];
    const std::size_t number = numbers.insert({subject_key(piece), groups.size()}).first->second;
    if (number == groups.size()) groups.emplace_back();
    Group& group = groups[number];
    const CampaignCaseResult result = case_result_from_text(record.text);
    group.result.piece = piece;
    group.result.plan_status = result.plan_status;
    group.result.verified = group.result.verified && result.verified;
    const std::vector<TrialOutcome> outcomes = trial_outcomes_from_text(result.outcomes);
    // A case without trials may begin where another one does.
    std::vector<TrialOutcome>& part = group.parts[piece.first];
    part.insert(part.end(), outcomes.begin(), outcomes.end());
  }
  std::vector<io::CampaignGroup> out;
  for (Group& group : groups) {
    summarize(group);
    out.push_back(std::move(group.result));
  }
  return out;
}

/// Trials that are in no case, a line per plan or problem and seed.
std::vector<std::string> gap_lines(const std::vector<CampaignCase>& cases,
                                   const std::vector<io::CampaignGroup>& groups) {
  constexpr std::size_t kShown = 3;
  TrialRanges ranges;
  for (const CampaignCase& piece : cases) (void)ranges.add(subject_key(piece), range_of(piece, 0));
  std::vector<std::string> lines;
  for (const io::CampaignGroup& group : groups) {
    const std::vector<TrialRange> gaps = ranges.gaps(subject_key(group.piece));
    if (gaps.empty()) continue;
    std::vector<std::string> words;
    for (std::size_t i = 0; i < std::min(gaps.size(), kShown); ++i) {
      words.push_back(range_words(gaps[i]));
    }
    if (gaps.size() > kShown) words.push_back(fmt::format("{} more gaps", gaps.size() - kShown));
    lines.push_back(
        fmt::format("{} of {} are in no case", fmt::join(words, ", "), subject_of(group.piece)));
  }
  return lines;
}

/// The groups with the least probability of success, the least one in full: what fits a screen.
void print_groups(std::vector<const io::CampaignGroup*> groups) {
  constexpr std::size_t kShown = 10;
  const auto success = [](const io::CampaignGroup* g) {
    return g->trials.second.success_probability;
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const auto* a, const auto* b) { return success(a) < success(b); });
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (i == kShown) {
      say(fmt::format("and {} with higher probabilities of success", groups.size() - kShown));
      break;
    }
    const io::CampaignGroup& group = *groups[i];
    say(fmt::format("{}: {}{}", subject_of(group.piece),
                    i == 0 ? trial_words(group.trials.second) : success_words(group.trials.second),
                    group.verified ? "" : "\n  the plan fails its verification"));
  }
}

int merge_cases(const CampaignMergeRequest& request) {
  request.output.check({".json"});
  MergedCampaign merged = merge_campaign(request.folder);
  const std::vector<CampaignCase> cases =
      read_cases(merged.cases, (fs::path(request.folder) / "cases.jsonl").string());
  std::vector<io::CampaignGroup> groups = groups_of(merged, cases);
  request.output.write(io::pretty(
      io::written([&](io::Table& t) { io::campaign_result_fields(t, merged, groups); })));
  const auto failed =
      std::count_if(merged.records.begin(), merged.records.end(), [](const CaseRecord& record) {
        return record.status != CaseStatus::Finished && record.status != CaseStatus::Died;
      });
  say(fmt::format(
      "{} of {} cases, each once; {} failed, {} missing, {} contradictory, {} repeated "
      "alike, {} damaged lines",
      merged.cases.size() - merged.missing.size(), merged.cases.size(), failed,
      merged.missing.size(), merged.contradictory.size(), merged.duplicates, merged.damaged));
  const std::string dead = dead_words(merged);
  if (!dead.empty()) say(fmt::format("cases whose workers died: {}", dead));
  for (const std::string& line : gap_lines(cases, groups)) say(line);
  std::vector<const io::CampaignGroup*> shown;
  shown.reserve(groups.size());
  for (const io::CampaignGroup& group : groups) shown.push_back(&group);
  print_groups(shown);
  if (!merged.is_complete()) {
    const std::string list = (fs::path(request.folder) / "cases.jsonl").string();
    say_next({"campaign", "run", list, "-o", request.folder});
  } else if (request.output.is_given()) {
    say_next({"report", request.output.path, "-o", with_extension(request.output.path, ".html")});
  }
  return merged.is_complete() ? kDone : kCampaignIncomplete;
}

}  // namespace

Command campaign_command() {
  auto making = std::make_shared<CampaignMakeRequest>();
  auto running = std::make_shared<CampaignRunRequest>();
  auto merging = std::make_shared<CampaignMergeRequest>();
  return {
      "campaign",
      "plans and random trials as a list of cases, on one or many machines",
      {},
      {},
      {{"make", "the list of cases, one per line",
        std::vector<Option>{{"spec", "SPEC.yaml", "campaign file (YAML)", &making->spec, true}} +
            output_options(making->output, "-o,--output", "cases; without it stdout"),
        [making] { return make_cases(*making); }},
       {"run",
        "run the cases that are not in the folder's journals yet",
        {{"cases", "CASES.jsonl", "list of cases", &running->cases, true},
         {"--shard", "I/N", "part I of N, from 1", &running->shard},
         {"--jobs", "N", "worker processes", &running->jobs, false, 1, 1024},
         {"--case-limit", "S", "time limit of one case", &running->seconds},
         {"-o,--output", "DIR", "folder of the campaign", &running->folder, true}},
        [running] { return run_cases(*running); }},
       {"merge", "check that every case is there exactly once, and summarise the results",
        std::vector<Option>{{"folder", "DIR", "folder of the campaign", &merging->folder, true}} +
            output_options(merging->output, "-o,--output", "result (JSON); without it stdout"),
        [merging] { return merge_cases(*merging); }}}};
}

}  // namespace stillbase::app
