#include "app/bench_runs.hpp"

#include <sys/utsname.h>

#include <algorithm>

#include <fmt/format.h>

#include <stillbase/benchmark/run.hpp>
#include <stillbase/campaign/campaign.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "app/tool.hpp"

namespace stillbase::app {

namespace {

constexpr const char* kDefaultsMark = ":defaults";

/// A problem file as a family of one instance per question that it asks.
FamilySpec family_of(const std::string& path) {
  FamilySpec out;
  out.problem = read_problem(path);
  out.name = out.problem.name;
  out.goals = {BenchmarkGoal::Nominal};
  out.cone_half_angle = out.problem.uncertainty.cone_half_angle;
  if (out.cone_half_angle > 0) out.goals.push_back(BenchmarkGoal::WorstCase);
  out.impact_case = out.problem.constraints.impact_case;
  if (out.impact_case != CaseConstraint::None) out.goals.push_back(BenchmarkGoal::Case);
  out.instances = 1;
  return out;
}

/// "iiwa/nominal" names iiwa/nominal/0, iiwa/nominal/1, ...
bool names(const std::string& part, const std::string& instance) {
  return instance == part || instance.rfind(part + "/", 0) == 0;
}

bool is_selected(const BenchSelection& selection, const std::string& instance, int number) {
  constexpr int kInstances = 5;
  if (selection.select.empty()) return number < selection.instances.value_or(kInstances);
  return std::any_of(
      selection.select.begin(), selection.select.end(), [&](const std::string& part) {
        if (part == instance) return true;
        return names(part, instance) && number < selection.instances.value_or(number + 1);
      });
}

RunRecord record_without_result(const BenchmarkInstance& instance, const RunRequest& request,
                                const CaseRecord& found) {
  RunRecord record = empty_record(instance, request);
  record.message = found.text;
  record.end = found.status;
  return record;
}

}  // namespace

std::string host_words() {
  struct utsname name = {};
  if (::uname(&name) != 0) return "unknown";
  return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

std::vector<BenchmarkInstance> select_instances(const SuiteSpec& suite,
                                                const BenchSelection& selection) {
  std::vector<FamilySpec> families = suite.families;
  if (!selection.problems.empty()) {
    if (selection.instances) {
      throw CommandLineError("--instances: a problem file is one instance of each goal");
    }
    families.clear();
  }
  for (const FamilySpec& family : families) {
    if (selection.instances.value_or(0) <= family.instances) continue;
    say(fmt::format("--instances {}: {} has {}", *selection.instances, family.name,
                    family.instances));
  }
  for (const std::string& path : selection.problems) families.push_back(family_of(path));
  std::vector<BenchmarkInstance> out;
  for (const FamilySpec& family : families) {
    for (const BenchmarkGoal goal : family.goals) {
      for (int number = 0; number < family.instances; ++number) {
        const std::string name = fmt::format("{}/{}/{}", family.name, to_string(goal), number);
        if (is_selected(selection, name, number)) {
          out.push_back(make_instance(family, goal, number));
        }
      }
    }
  }
  for (const std::string& part : selection.select) {
    const bool is_known = std::any_of(
        out.begin(), out.end(), [&](const BenchmarkInstance& i) { return names(part, i.name); });
    if (!is_known) {
      throw CommandLineError(fmt::format("--select {}: no instance has such a name", part));
    }
  }
  return out;
}

std::vector<RunRequest> requests_of(const std::vector<BenchmarkInstance>& instances,
                                    const BenchSelection& selection) {
  struct Contestant {
    std::string optimizer;
    bool library_defaults;
    int seeds;
  };
  std::vector<Contestant> contestants;
  const std::vector<std::string> known = nlp::optimizer_names();
  for (const std::string& label : selection.optimizers) {
    const std::size_t mark = label.find(kDefaultsMark);
    const bool has_defaults = mark != std::string::npos;
    const std::string name = label.substr(0, mark);
    const bool is_label = !has_defaults || label.substr(mark) == kDefaultsMark;
    check_known("--optimizers " + label, is_label ? name : label, known);
    for (const Contestant& other : contestants) {
      if (other.optimizer != name || other.library_defaults != has_defaults) continue;
      throw CommandLineError(fmt::format("--optimizers {}: twice", label));
    }
    contestants.push_back({name, has_defaults, selection.seeds});
  }
  if (selection.optimizers.empty()) {
    for (const std::string& name : known) contestants.push_back({name, false, selection.seeds});
    // Comparison of the libraries' own options with the tuning: a fifth of the seeds is enough.
    for (const std::string& name : known) {
      const bool is_tuned = !nlp::make_optimizer(name)->info().tuning.empty();
      if (is_tuned && selection.with_defaults) {
        contestants.push_back({name, true, std::max(1, selection.seeds / 5)});
      }
    }
  }
  std::vector<RunRequest> out;
  for (const BenchmarkInstance& instance : instances) {
    const std::string sha256 = instance_sha256(instance);
    for (const Contestant& contestant : contestants) {
      for (int i = 0; i < contestant.seeds; ++i) {
        out.push_back({instance.name, sha256, contestant.optimizer, contestant.library_defaults,
                       selection.first_seed + static_cast<std::uint64_t>(i), selection.budget,
                       selection.seconds});
      }
    }
  }
  return out;
}

BenchRuns run_all(const std::vector<BenchmarkInstance>& instances,
                  const std::vector<RunRequest>& requests, const BenchRunOptions& options) {
  std::map<std::string, const BenchmarkInstance*> by_name;
  for (const BenchmarkInstance& instance : instances) by_name[instance.name] = &instance;
  std::string cases;
  double seconds = 0;
  for (const RunRequest& request : requests) {
    cases += request_to_text(request) + "\n";
    seconds = std::max(seconds, request.seconds);
  }
  const std::string host = host_words();
  CampaignOptions campaign;
  campaign.folder = options.folder;
  campaign.jobs = options.jobs;
  // A solver that asks for evaluations is stopped at its own limit and keeps what it found; one
  // that no longer does is ended from outside.
  campaign.seconds = seconds + 1;
  campaign.stop = options.stop;
  ProgressLine progress;
  campaign.on_progress = [&](int done, int total) { progress.show("runs", done, total); };
  (void)run_campaign(cases, campaign, [&](const std::string& text) {
    const RunRequest request = request_from_text(text);
    StopCondition stop;
    stop.deadline =
        StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                          std::chrono::duration<double>(request.seconds));
    return record_to_text(run_benchmark(*by_name.at(request.instance), request, stop), host);
  });
  progress.clear();
  BenchRuns out;
  for (const CaseRecord& found : merge_campaign(options.folder).records) {
    const RunRequest& request = requests.at(static_cast<std::size_t>(found.number));
    if (found.status == CaseStatus::Died) {
      out.died.push_back(fmt::format("{} on {}, seed {}: {}", label_of(request), request.instance,
                                     request.seed, found.text));
      continue;
    }
    out.texts.push_back(
        found.status == CaseStatus::Finished
            ? found.text
            : record_to_text(record_without_result(*by_name.at(request.instance), request, found),
                             host));
  }
  return out;
}

}  // namespace stillbase::app
