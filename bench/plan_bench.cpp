// How long a plan takes, and what takes it: every shipped problem by phases.
//
//   plan_bench [--runs N] [--jobs N] [-o OUT.json] [problem.yaml ...]
//
// Default: one run on one thread of every problem in problems/ that has a plan. The phases are
// those that the planner itself reports (core/phase_clock.hpp), beside reading the problem and
// writing the plan. Prints a table, of several runs the medians; the file has every run.
// tools/bench-compare compares two builds of this program.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/parallel.hpp>
#include <stillbase/core/phase_clock.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/proof/proof.hpp>

#include "io/json.hpp"

namespace {

using namespace stillbase;
using Seconds = PhaseClock::Seconds;

struct Request {
  int runs = 1;
  int jobs = 1;
  std::string output;
  std::vector<std::string> problems;
};

/// Runs of one problem: seconds of each phase, one value per run.
struct Runs {
  std::string problem;
  std::map<std::string, std::vector<Seconds>> phases;
};

constexpr const char* kTotal = "total";

/// Names of files in problems/ that are not planned: sweeps of a direction, simulations.
bool has_plan(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  return file.extension() == ".yaml" && name.find("_sweep_") == std::string::npos &&
         name.find("_post_impact_") == std::string::npos;
}

std::vector<std::string> shipped_problems() {
  std::vector<std::string> files;
  const std::filesystem::path folder = std::string(STILLBASE_SOURCE_DIR) + "/problems";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (has_plan(entry.path())) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::map<std::string, Seconds> run_once(const std::string& file, int jobs) {
  PhaseClock clock;
  {
    PhaseClock::Phase phase(&clock, "other");
    const CaptureProblem problem = [&] {
      const PhaseClock::Phase reading(&clock, "reading");
      return read_problem(file);
    }();
    PlannerOptions options;
    options.jobs = jobs;
    options.clock = &clock;
    const Plan plan = make_plan(problem, options);
    const PhaseClock::Phase writing(&clock, "writing");
    if (plan_to_json(plan, tool_versions(), {}, {}).empty()) std::abort();
  }
  std::map<std::string, Seconds> out = clock.seconds();
  Seconds total;
  for (const auto& [name, seconds] : out) {
    total.wall += seconds.wall;
    total.processor += seconds.processor;
  }
  out[kTotal] = total;
  return out;
}

double median_wall(std::vector<Seconds> runs) {
  std::sort(runs.begin(), runs.end(),
            [](const Seconds& a, const Seconds& b) { return a.wall < b.wall; });
  return runs[runs.size() / 2].wall;
}

/// Milliseconds of the phases that take at least a twentieth, the largest first.
std::string line_of(const Runs& runs) {
  const double total = median_wall(runs.phases.at(kTotal));
  std::vector<std::pair<double, std::string>> parts;
  double rest = total;
  for (const auto& [name, seconds] : runs.phases) {
    const double here = median_wall(seconds);
    if (name == kTotal || here < 0.05 * total) continue;
    parts.emplace_back(-here, name);
    rest -= here;
  }
  std::sort(parts.begin(), parts.end());
  std::string out = fmt::format("| {} | {:.1f} |", runs.problem, 1e3 * total);
  for (const auto& [seconds, name] : parts) out += fmt::format(" {} {:.1f},", name, -1e3 * seconds);
  return out + fmt::format(" remaining {:.1f} |", 1e3 * std::max(rest, 0.0));
}

io::Json json_of(const Runs& runs) {
  io::Json out = io::Json::object();
  out["problem"] = runs.problem;
  for (const auto& [name, seconds] : runs.phases) {
    std::vector<double> wall, processor;
    for (const Seconds& each : seconds) {
      wall.push_back(each.wall);
      processor.push_back(each.processor);
    }
    out["phases"][name]["wall"] = wall;
    out["phases"][name]["processor"] = processor;
  }
  return out;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

io::Json header(const Request& request) {
  io::Json out = io::Json::object();
  out["format"] = "stillbase.plan_bench";
  out["version"] = 1;
  for (const auto& [name, version] : tool_versions()) out["tool"][name] = version;
  out["processor"] = processor_name();
  out["processors"] = processor_count();
  out["jobs"] = request.jobs;
  out["unit"] = "s";
  out["runs"] = io::Json::array();
  return out;
}

Request request_of(int argc, char** argv) {
  Request out;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool has_value = i + 1 < words.size();
    if (words[i] == "--runs" && has_value) {
      out.runs = std::max(1, std::atoi(words[++i].c_str()));
    } else if (words[i] == "--jobs" && has_value) {
      out.jobs = std::max(1, std::atoi(words[++i].c_str()));
    } else if (words[i] == "-o" && has_value) {
      out.output = words[++i];
    } else if (words[i].rfind('-', 0) == 0) {
      std::cerr << "plan_bench [--runs N] [--jobs N] [-o OUT.json] [problem.yaml ...]\n";
      std::exit(2);
    } else {
      out.problems.push_back(words[i]);
    }
  }
  if (out.problems.empty()) out.problems = shipped_problems();
  return out;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef STILLBASE_WITH_PROOF
  stillbase::enable_proofs();
#endif
  const Request request = request_of(argc, argv);
  io::Json out = header(request);
  std::cout << "| problem | total, ms | phases of at least 5 %, ms |\n|---|---|---|\n";
  for (const std::string& file : request.problems) {
    Runs runs{std::filesystem::path(file).stem().string(), {}};
    for (int run = 0; run < request.runs; ++run) {
      for (const auto& [name, seconds] : run_once(file, request.jobs)) {
        runs.phases[name].push_back(seconds);
      }
    }
    std::cout << line_of(runs) << '\n' << std::flush;
    out["runs"].push_back(json_of(runs));
  }
  if (!request.output.empty()) std::ofstream(request.output) << io::pretty(out);
  return EXIT_SUCCESS;
}
