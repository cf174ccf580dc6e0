// Format: what ompl::tools::Benchmark::saveResultsToStream() of OMPL 1.5 writes.
#include <stillbase/report/planner_log.hpp>

#include <fmt/format.h>

namespace stillbase {

namespace {

constexpr const char* kStatusWords =
    "status|Unknown status|Invalid start|Invalid goal|Unrecognized goal type|Timeout|Approximate "
    "solution|Exact solution|Crash|Abort";

template <class T>
std::string field(const std::optional<T>& value) {
  return (value ? fmt::format("{}", *value) : std::string()) + "; ";
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

}  // namespace

std::string planner_log_to_text(const PlannerLog& log) {
  double spent = 0;
  for (const PlannerLogPlanner& planner : log.planners) {
    for (const PlannerLogRun& run : planner.runs) spent += run.seconds.value_or(0);
  }
  std::string out = fmt::format(
      "OMPL version 1.5.2\nExperiment {}\n0 experiment properties\nRunning on {}\n"
      "Starting at {}\n<<<|\n{}\n|>>>\n<<<|\nnot recorded\n|>>>\n"
      "{} is the random seed\n{} seconds per run\n2048 MB per run\n{} runs per planner\n"
      "{} seconds spent to collect the data\n2 enum types\n{}\noutcome",
      one_line(log.experiment), one_line(log.host), one_line(log.started), one_line(log.setup),
      log.seed, log.seconds_limit, log.runs_per_planner, spent, kStatusWords);
  for (const std::string& word : log.outcomes) out += "|" + word;
  out += fmt::format("\n{} planners\n", log.planners.size());
  for (const PlannerLogPlanner& planner : log.planners) {
    out += fmt::format(
        "geometric_{}\n0 common properties\n8 properties for each run\nmotion duration REAL\n"
        "motion samples INTEGER\noutcome ENUM\nplanner calls INTEGER\nsolution length REAL\n"
        "solved BOOLEAN\nstatus ENUM\ntime REAL\n{} runs\n",
        planner.name, planner.runs.size());
    for (const PlannerLogRun& run : planner.runs) {
      out += field(run.duration) + field(run.samples) + field(run.outcome) +
             field(run.planner_calls) + field(run.length) +
             fmt::format("{}; {}; ", run.solved ? 1 : 0, static_cast<int>(run.status)) +
             field(run.seconds) + "\n";
    }
    out += ".\n";
  }
  return out;
}

}  // namespace stillbase
