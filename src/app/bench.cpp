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
#include <stillbase/io/suite_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "app/bench_folder.hpp"
#include "app/bench_page.hpp"
#include "app/bench_planners.hpp"
#include "app/bench_runs.hpp"
#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/output.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;

struct Options {
  BenchSelection selection;
  std::string suite = "bench/suite.yaml";
  std::string folder;
  int jobs = 0;
  bool quick = false, list = false, planners = false, update_best_known = false;
};

/// One instance of each kind, two seeds and few evaluations: shows that everything works, not who
/// is better.
void make_quick(BenchSelection& selection) {
  selection.instances = 1;
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

int list() {
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
    std::string name = (fs::temp_directory_path() / "stillbase_bench_XXXXXX").string();
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

/// The table without the entries of instances that are no longer what they were: whose points are
/// not worth what the table says.
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
                                    const std::vector<RunRecord>& records) {
  constexpr std::size_t kRefined = 8;
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
    if (runs.size() > kRefined) runs.resize(kRefined);
    for (const RunRecord* record : runs) out.push_back(refined(instance, *record));
  }
  return out;
}

/// Files of other people are not replaced.
void refuse_foreign(const std::string& folder) {
  if (!fs::is_directory(folder) || fs::is_empty(folder) || fs::exists(fs::path(folder) / "runs")) {
    return;
  }
  throw FileError(folder + ": holds files, but no runs of a benchmark; choose another folder");
}

int run(const Options& options) {
  if (options.list) return list();
  if (options.update_best_known && !options.selection.problems.empty()) {
    throw CommandLineError("--update-best-known: belongs to the suite, not to problem files");
  }
  const SuiteSpec suite = read_suite(options.suite);
  const int jobs =
      options.jobs > 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
  std::unique_ptr<TemporaryFolder> temporary;
  if (options.folder.empty()) temporary = std::make_unique<TemporaryFolder>();
  const std::string folder = temporary ? temporary->path() : options.folder;
  if (options.planners) {
    PlannerBenchOptions planners;
    planners.problems =
        options.selection.problems.empty() ? suite.approaches : options.selection.problems;
    planners.folder = folder;
    planners.seeds = options.selection.seeds;
    planners.first_seed = options.selection.first_seed;
    planners.jobs = jobs;
    planners.stop = stop_condition();
    planners.print = temporary != nullptr;
    return bench_planners(planners);
  }

  if (!temporary) refuse_foreign(folder);
  const std::vector<BenchmarkInstance> instances = select_instances(suite, options.selection);
  const std::vector<RunRequest> requests = requests_of(instances, options.selection);
  BestKnownTable best_known = read_known(suite.best_known, instances);
  say(fmt::format("{} problems, {} runs, {} at a time", instances.size(), requests.size(), jobs));
  const std::vector<std::string> texts =
      run_all(instances, requests, {(fs::path(folder) / "runs").string(), jobs, stop_condition()});
  if (signal_exit_code() != 0) {
    say(fmt::format("stopped: {} of {} runs are done{}", texts.size(), requests.size(),
                    temporary ? "" : ", the same command goes on from there"));
    return signal_exit_code();
  }
  std::string lines;
  for (const std::string& text : texts) lines += text + "\n";
  BenchFolder content;
  content.gradient_cost = suite.gradient_cost;
  content.records = read_records(lines, "records");
  const int beaten = improve(best_known, refined_best(instances, content.records));
  content.references = reference_values(content.records, values_of(best_known, instances));
  write_bench_folder(folder, content, texts);
  if (temporary) write_stdout(read_text_file((fs::path(folder) / "report.md").string()));
  if (options.update_best_known && beaten > 0) {
    write_file_atomically(suite.best_known, best_known_to_json(best_known), true);
    say(fmt::format("{}: {} values entered", suite.best_known, beaten));
  } else if (beaten > 0 && options.selection.problems.empty()) {
    say(fmt::format("{} best known values are new or beaten; --update-best-known enters them",
                    beaten));
  }
  if (!temporary) say(fmt::format("written to {}", folder));
  return kDone;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  BenchSelection& selection = options->selection;
  CLI::App* command = app.add_subcommand(
      "bench", "compare optimizers on families of capture problems, or approach planners");
  command->add_option("problems", selection.problems, "problem files in place of the suite")
      ->type_name("PROBLEM.yaml");
  command->add_option("--suite", options->suite, "suite of problems")
      ->capture_default_str()
      ->type_name("SUITE.yaml");
  command
      ->add_option("--select", selection.select,
                   "instances of the suite, or what their names begin with, e.g. iiwa/nominal")
      ->delimiter(',');
  command->add_option("--instances", selection.instances, "instances per family and goal")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--optimizers", selection.optimizers,
                   "names of --list; NAME:defaults runs with the library's own options")
      ->delimiter(',');
  auto* seeds = command->add_option("--seeds", selection.seeds, "runs per problem")
                    ->capture_default_str()
                    ->check(CLI::Range(1, 10000));
  command->add_option("--first-seed", selection.first_seed, "seed of the first run")
      ->capture_default_str()
      ->check(whole_number());
  auto* budget = command->add_option("--budget", selection.budget, "evaluations of a run")
                     ->capture_default_str()
                     ->type_name("EVALS")
                     ->check(CLI::Range(1, 100000000));
  command->add_option("--run-limit", selection.seconds, "time limit of a run")
      ->capture_default_str()
      ->type_name("S")
      ->check(positive_number());
  command->add_option("--jobs", options->jobs, "processes at a time; as many as processors")
      ->check(CLI::Range(1, 1024));
  auto* quick = command->add_flag("--quick", options->quick,
                                  "one instance of each kind, 2 seeds, 500 evaluations");
  quick->excludes(seeds)->excludes(budget);
  command->add_flag("--list", options->list, "the optimizers and what each needs");
  command->add_flag("--planners", options->planners,
                    "approach planners instead: logs for OMPL's Planner Arena");
  command->add_flag("--update-best-known", options->update_best_known,
                    "enter what beats the suite's best known values into their file");
  command->add_option("-o,--output", options->folder, "folder; without it the report on stdout")
      ->type_name("DIR");
  command->callback([options, &action] {
    if (options->quick) make_quick(options->selection);
    action = [options] { return run(*options); };
  });
}

}  // namespace stillbase::app
