#include "app/bench_runs.hpp"

#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/campaign/campaign.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/report/planner_log.hpp>

#include "app/tool.hpp"
#include "io/names.hpp"
#include "io/problem_reader.hpp"

namespace stillbase::app {

namespace {

using io::Json;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

struct PlannerTask {
  CaptureProblem problem;
  Configuration goal;
  std::optional<TargetMotion> target;
};

PlannerTask task_of(const std::string& path) {
  PlannerTask out;
  out.problem = read_problem(path);
  if (!out.problem.approach.enabled) {
    throw InputError(
        {{path, 0, "no-approach", "approach.enabled: the problem asks for no approach"}});
  }
  if (out.problem.approach.base == BaseMode::Floating && !out.problem.approach.station_free) {
    throw InputError({{path, 0, "path-decides",
                       "approach.station_free: the configuration depends on the path, so that "
                       "planners would not be given "
                       "the same task"}});
  }
  PlannerOptions options;
  options.stop = stop_condition();
  out.goal = make_plan(out.problem, options).configuration;
  out.problem = at_feature(std::move(out.problem), out.goal.feature);
  out.target = encounter_motion(out.problem, out.goal);
  return out;
}

double length_of(const Approach& approach) {
  double length = 0;
  for (std::size_t i = 1; i < approach.joint_positions.size(); ++i) {
    length += (approach.joint_positions[i] - approach.joint_positions[i - 1]).norm();
  }
  return length;
}

/// One run: case text in, result line out.
std::string plan_once(PlannerTask task, const Json& request) {
  task.problem.approach.planner = request.at("planner").get<std::string>();
  std::map<std::string, long> calls;
  const auto begin = Clock::now();
  const Approach approach =
      plan_approach(task.problem, task.goal, task.target ? &*task.target : nullptr,
                    request.at("seed").get<std::uint64_t>(), {}, calls);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  const bool found = approach.status == ApproachStatus::Found;
  Json out = {{"status", io::word_of(io::approach_status_names(), approach.status)},
              {"seconds", seconds},
              {"calls", calls[task.problem.approach.planner]}};
  if (found) {
    out["length"] = length_of(approach);
    out["duration"] = approach.times.back() - approach.times.front();
    out["samples"] = approach.times.size();
  }
  return out.dump();
}

/// As OMPL writes it: 2026-01-31 12:00:00, local time.
std::string now_words() {
  const std::time_t now = std::time(nullptr);
  std::tm local = {};
  char text[32] = "";
  if (localtime_r(&now, &local) != nullptr) {
    std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S", &local);
  }
  return text;
}

/// OMPL's status of a run. What OMPL does not distinguish (contact before the end, too slow) is
/// its unknown status; `outcome` has the details.
PlannerLogStatus log_status(CaseStatus status, const std::string& approach) {
  if (status == CaseStatus::TimedOut) return PlannerLogStatus::Timeout;
  if (status != CaseStatus::Finished) return PlannerLogStatus::Crash;
  if (approach == "found") return PlannerLogStatus::ExactSolution;
  if (approach == "start_invalid") return PlannerLogStatus::InvalidStart;
  if (approach == "goal_invalid") return PlannerLogStatus::InvalidGoal;
  if (approach == "time_out" || approach == "stopped") return PlannerLogStatus::Timeout;
  return PlannerLogStatus::Unknown;
}

PlannerLogRun log_run(const CaseRecord& record) {
  PlannerLogRun out;
  if (record.status != CaseStatus::Finished) {
    out.status = log_status(record.status, "");
    return out;
  }
  const Json json = Json::parse(record.text);
  const std::string word = json.at("status").get<std::string>();
  out.solved = word == "found";
  out.status = log_status(record.status, word);
  const auto& names = io::approach_status_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].first == word) out.outcome = static_cast<int>(i);
  }
  out.seconds = json.at("seconds").get<double>();
  out.planner_calls = json.at("calls").get<long>();
  if (out.solved) {
    out.length = json.at("length").get<double>();
    out.duration = json.at("duration").get<double>();
    out.samples = json.at("samples").get<long>();
  }
  return out;
}

}  // namespace

int bench_planners(const PlannerBenchOptions& options) {
  std::vector<PlannerTask> tasks;
  for (const std::string& path : options.problems) {
    say(fmt::format("configuration for {}", path));
    tasks.push_back(task_of(path));
    if (signal_exit_code() != 0) return signal_exit_code();
  }
  const std::vector<std::string> planners = approach_planner_names();
  std::string cases;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string text = io::canonical(io::problem_json(tasks[i].problem));
    for (const std::string& planner : planners) {
      for (int k = 0; k < options.seeds; ++k) {
        cases += Json({{"problem", i},
                       {"name", tasks[i].problem.name},
                       {"problem_sha256", sha256_hex(text)},
                       {"planner", planner},
                       {"seed", options.first_seed + static_cast<std::uint64_t>(k)}})
                     .dump() +
                 "\n";
      }
    }
  }
  CampaignOptions campaign;
  campaign.folder = (fs::path(options.folder) / "planner_runs").string();
  campaign.jobs = options.jobs;
  campaign.seconds = options.seconds;
  campaign.stop = options.stop;
  ProgressLine progress;
  campaign.on_progress = [&](int done, int total) { progress.show("runs", done, total); };
  const CampaignRun done = run_campaign(cases, campaign, [&](const std::string& text) {
    const Json request = Json::parse(text);
    return plan_once(tasks.at(request.at("problem").get<std::size_t>()), request);
  });
  progress.clear();
  if (signal_exit_code() != 0) {
    say(fmt::format("stopped: {} of {} runs are done", done.found + done.recorded, done.cases));
    return signal_exit_code();
  }
  if (!done.died.empty()) {
    say(
        fmt::format("incomplete: the workers of {} runs died {} times each; the same command tries "
                    "them again",
                    done.died.size(), campaign.tries));
    const std::vector<std::string> lines = cases_from_text(cases, campaign.folder);
    for (const int number : done.died) say(lines[static_cast<std::size_t>(number)]);
    return kCampaignIncomplete;
  }
  const MergedCampaign merged = merge_campaign(campaign.folder);
  std::size_t next = 0;
  for (const PlannerTask& task : tasks) {
    PlannerLog log;
    log.experiment = task.problem.name;
    log.setup = task.problem.purpose;
    log.host = host_words();
    log.started = now_words();
    log.seed = options.first_seed;
    log.seconds_limit = options.seconds;
    log.runs_per_planner = options.seeds;
    for (const auto& name : io::approach_status_names()) log.outcomes.emplace_back(name.first);
    for (const std::string& planner : planners) {
      log.planners.push_back({planner, {}});
      for (int k = 0; k < options.seeds; ++k) {
        log.planners.back().runs.push_back(log_run(merged.records.at(next++)));
      }
    }
    const std::string text = planner_log_to_text(log);
    const std::string path =
        (fs::path(options.folder) / ("planners_" + task.problem.name + ".log")).string();
    write_file_atomically(path, text, true);
    if (options.print) write_stdout(text);
    if (!options.print) say("written to " + path);
  }
  return kDone;
}

}  // namespace stillbase::app
