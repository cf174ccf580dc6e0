// stillbase bench: which optimizer for which capture problem, at which cost, and how sure is that.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include <stillbase/benchmark/run.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "app/bench_page.hpp"
#include "app/bench_runs.hpp"
#include "app/command_line.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

struct BenchRequest {
  BenchSelection selection;
  std::string suite, folder;
  int jobs = 0;
  bool quick = false, list = false, planners = false, update_best_known = false;
};

/// One instance of each kind, two seeds and few evaluations: shows that everything works, not who
/// is better.
void make_quick(BenchSelection& selection) {
  if (selection.problems.empty()) selection.instances = 1;
  selection.seeds = 2;
  selection.budget = 500;
  selection.with_defaults = false;
}

std::string needs_of(const nlp::OptimizerInfo& info) {
  std::string out = info.uses_hessian    ? "gradients, Hessian"
                    : info.uses_gradient ? "gradients"
                                         : "values";
  if (info.global) out += ", finite bounds";
  if (info.stochastic) out += ", a seed";
  if (info.min_variables > 1) out += fmt::format(", {} variables", info.min_variables);
  return out;
}

int list_optimizers() {
  TextTable table;
  table.header = {"optimizer", "needs", "library", "what it is"};
  for (const std::string& name : nlp::optimizer_names()) {
    const auto optimizer = nlp::make_optimizer(name);
    const nlp::OptimizerInfo& info = optimizer->info();
    table.rows.push_back(
        {name, needs_of(info), info.library.empty() ? "stillbase" : info.library, info.about});
  }
  PageSection section;
  section.heading = "Optimizers";
  section.table = std::move(table);
  const std::string page = page_to_markdown({"stillbase bench", {section}});
  write_stdout(page.substr(page.find('|')));
  return kDone;
}

/// A folder that goes with this object, for runs without -o.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    const fs::path parent = fs::temp_directory_path(error);
    if (error) throw FileError(fmt::format("no temporary folder (TMPDIR): {}", error.message()));
    std::string name = (parent / "stillbase_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw FileError("no temporary folder: " + name);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The table without the entries of instances that have changed: their points no longer have the
/// values that the table states.
BestKnownTable read_known(const std::string& path,
                          const std::vector<BenchmarkInstance>& instances) {
  if (path.empty() || !fs::exists(path)) return {};
  BestKnownTable table = read_best_known(read_text_file(path), path);
  for (const BenchmarkInstance& instance : instances) {
    const auto known = table.find(instance.name);
    if (known == table.end()) continue;
    const Judged judged = judge_point(instance, known->second.point);
    const double apart = std::abs(judged.value - known->second.value);
    if (judged.violation <= kReferenceViolation && apart <= 1e-9 * (1 + judged.value)) continue;
    say(fmt::format("{}: {} has changed; its value is left out", path, instance.name));
    table.erase(known);
  }
  return table;
}

std::map<std::string, double> values_of(const BestKnownTable& table,
                                        const std::vector<BenchmarkInstance>& instances) {
  std::map<std::string, double> out;
  for (const BenchmarkInstance& instance : instances) {
    const auto known = table.find(instance.name);
    if (known != table.end()) out[instance.name] = known->second.value;
  }
  return out;
}

/// The best few runs of each instance, their points made exact.
std::vector<RunRecord> refined_best(const std::vector<BenchmarkInstance>& instances,
                                    const std::vector<RunRecord>& records, std::size_t most) {
  std::map<std::string, std::vector<const RunRecord*>> of_instance;
  for (const RunRecord& record : records) {
    if (record.improvements.empty()) continue;
    if (!(record.improvements.back().violation <= kBenchmarkViolation)) continue;
    of_instance[record.request.instance].push_back(&record);
  }
  std::vector<RunRecord> out;
  for (const BenchmarkInstance& instance : instances) {
    std::vector<const RunRecord*>& runs = of_instance[instance.name];
    std::stable_sort(runs.begin(), runs.end(), [](const RunRecord* a, const RunRecord* b) {
      return a->improvements.back().value < b->improvements.back().value;
    });
    if (runs.size() > most) runs.resize(most);
    for (const RunRecord* record : runs) out.push_back(refined(instance, *record));
  }
  return out;
}

/// The suite of the source tree below the working directory, or that of the installed tool.
/// @throws InputError
std::string default_suite() {
  const fs::path relative = fs::path("bench") / "suite.yaml";
  std::error_code error;
  if (fs::is_regular_file(relative, error)) return relative.string();
  const fs::path tool = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = (tool.parent_path() / STILLBASE_DATA / relative).lexically_normal();
  if (fs::is_regular_file(installed, error)) return installed.string();
  throw InputError({{relative.string(), 0, "missing-file",
                     fmt::format("there is no such file, nor {}; state --suite or problem files",
                                 installed.string())}});
}

/// Files of other people are not replaced.
void refuse_foreign(const std::string& folder) {
  if (!fs::is_directory(folder) || fs::is_empty(folder) || fs::exists(fs::path(folder) / "runs")) {
    return;
  }
  throw FileError(folder + ": holds files, but no runs of a benchmark; choose another folder");
}

int run_bench(const BenchRequest& request) {
  if (request.list) return list_optimizers();
  if (request.update_best_known && !request.selection.problems.empty()) {
    throw CommandLineError("--update-best-known: belongs to the suite, not to problem files");
  }
  // Problem files need no suite.
  SuiteSpec suite;
  if (!request.suite.empty() || request.selection.problems.empty()) {
    suite = read_suite(request.suite.empty() ? default_suite() : request.suite);
  }
  const int jobs =
      request.jobs > 0 ? request.jobs : std::max(1u, std::thread::hardware_concurrency());
  std::unique_ptr<TemporaryFolder> temporary;
  if (request.folder.empty()) temporary = std::make_unique<TemporaryFolder>();
  const std::string folder = temporary ? temporary->path() : request.folder;
  if (request.planners) {
    PlannerBenchOptions planners;
    planners.problems =
        request.selection.problems.empty() ? suite.approaches : request.selection.problems;
    planners.folder = folder;
    planners.seeds = request.selection.seeds;
    planners.first_seed = request.selection.first_seed;
    planners.jobs = jobs;
    planners.stop = stop_condition();
    planners.print = temporary != nullptr;
    return bench_planners(planners);
  }

  if (!temporary) refuse_foreign(folder);
  const std::vector<BenchmarkInstance> instances = select_instances(suite, request.selection);
  const std::vector<RunRequest> requests = requests_of(instances, request.selection);
  BestKnownTable best_known = read_known(suite.best_known, instances);
  say(fmt::format("{} problems, {} runs, {} at a time", instances.size(), requests.size(), jobs));
  const auto [texts, died] =
      run_all(instances, requests, {(fs::path(folder) / "runs").string(), jobs, stop_condition()});
  if (signal_exit_code() != 0) {
    say(fmt::format("stopped: {} of {} runs are done{}", texts.size(), requests.size(),
                    temporary ? "" : ", the same command goes on from there"));
    return signal_exit_code();
  }
  std::string lines;
  for (const std::string& text : texts) lines += text + "\n";
  BenchFolder content{{suite.gradient_cost, {}}, read_records(lines, "records")};
  const int beaten =
      improve(best_known, refined_best(instances, content.records, request.selection.refined));
  content.references.values = reference_values(content.records, values_of(best_known, instances));
  write_bench_folder(folder, content, lines);
  if (temporary) write_stdout(read_text_file((fs::path(folder) / "report.md").string()));
  if (request.update_best_known && beaten > 0) {
    write_file_atomically(suite.best_known, best_known_to_json(best_known), true);
    say(fmt::format("{}: {} values entered", suite.best_known, beaten));
  } else if (beaten > 0 && request.selection.problems.empty()) {
    say(fmt::format("{} best known values are new or beaten; --update-best-known enters them",
                    beaten));
  }
  for (const std::string& run : died) {
    say(fmt::format("not in the report, its worker died: {}", run));
  }
  if (!temporary) {
    say(fmt::format("written to {}", folder));
    say_next({"report", folder, "-o", fs::path(folder).lexically_normal().string() + ".html"});
  }
  return died.empty() ? kDone : kCampaignIncomplete;
}

}  // namespace

Command bench_command() {
  auto request = std::make_shared<BenchRequest>();
  BenchSelection& selection = request->selection;
  return {
      "bench",
      "compare optimizers on families of capture problems, or approach planners",
      {{"problems", "PROBLEM.yaml", "problem files in place of the suite", &selection.problems},
       {"--suite", "SUITE.yaml",
        "suite of problems; without it bench/suite.yaml, or the one that was installed",
        &request->suite},
       {"--select", "NAME,...",
        "instances of the suite, or what their names begin with, e.g. iiwa/nominal",
        &selection.select},
       {"--instances", "N", "instances per family and goal; without it 5, or those of --select",
        &selection.instances, false, 1, 1000},
       {"--optimizers", "NAME,...",
        "names of --list; NAME:defaults runs with the library's own options",
        &selection.optimizers},
       {"--seeds", "N", "runs per problem", &selection.seeds, false, 1, 10000},
       {"--first-seed", "", "seed of the first run", &selection.first_seed},
       {"--budget", "EVALS", "evaluations of a run", &selection.budget, false, 1, 100'000'000},
       {"--run-limit", "S", "time limit of a run", &selection.seconds},
       {"--jobs", "N", "processes at a time; as many as processors", &request->jobs, false, 1,
        1024},
       {.name = "--quick",
        .value = "",
        .about = "one instance of each kind, 2 seeds, 500 evaluations",
        .target = &request->quick,
        .excludes = {"--seeds", "--budget", "--instances"}},
       {"--list", "", "the optimizers and what each needs", &request->list},
       {"--planners", "", "approach planners instead: logs for OMPL's Planner Arena",
        &request->planners},
       {"--update-best-known", "", "enter what beats the suite's best known values into their file",
        &request->update_best_known},
       {"-o,--output", "DIR", "folder; without it the report on stdout", &request->folder}},
      [request] {
        if (request->quick) make_quick(request->selection);
        return run_bench(*request);
      }};
}

}  // namespace stillbase::app
