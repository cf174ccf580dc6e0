// Files of the benchmark: requests, records, best known values, what a folder is measured against.
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/child_process.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/sha256.hpp>

#include "io/fields/results.hpp"
#include "io/problem_reader.hpp"

namespace stillbase {

namespace io {

namespace {

/// A number that is negative where it is not known: null then.
OrNull known_number(double& x) {
  return {Number(x), x < 0, [&x] { x = -1; }};
}

/// [evaluations, gradients, value, violation].
struct ImprovementRow : Value {
  explicit ImprovementRow(Improvement& x) {
    read = [&x](ReadContext& context, const Node& node, const std::string& path) {
      const auto numbers = read_numbers(context, node, path, Dimension::None, 4);
      if (!numbers) return false;
      for (const std::size_t i : {0, 1}) {
        const double count = (*numbers)[i];
        if (count == std::trunc(count) && count >= 0 && count <= kMany) continue;
        context.add(
            node.line, "out-of-range",
            fmt::format("{}[{}] is {}, no whole number from 0 to {}", path, i, count, kMany));
        return false;
      }
      x.evaluations = static_cast<long>((*numbers)[0]);
      x.gradients = static_cast<long>((*numbers)[1]);
      x.value = (*numbers)[2];
      x.violation = (*numbers)[3];
      return true;
    };
    write = [&x] { return Json::array({x.evaluations, x.gradients, x.value, x.violation}); };
  }
};

void request_fields(Table& t, RunRequest& request) {
  std::uint64_t memory = ChildOptions{}.memory;
  t("instance", Text(request.instance), "family/goal/number", kNeeded);
  t("problem_sha256", Text(request.problem_sha256), "of the instance", kNeeded);
  t("optimizer", Text(request.optimizer), "", kNeeded);
  t("library_defaults", Flag(request.library_defaults), "without the stated tuning", kNeeded);
  t("seed", Seed(request.seed), "of the starts", kNeeded);
  t("limits", Map([&](Table& m) {
      m("evaluations", Integer(request.budget, 0, kMany), "of the model", kNeeded);
      m("seconds", Number(request.seconds), "", kNeeded);
      m("memory_bytes", Seed(memory), "", kNeeded);
    }),
    "", kNeeded);
}

void record_fields(Table& t, RunRecord& record, std::string& host) {
  std::string version = STILLBASE_VERSION;
  std::vector<double> seconds;
  for (const Improvement& point : record.improvements) seconds.push_back(point.seconds);
  const auto count = [&t](const char* key, auto& x, const char* text) {
    t(key, Integer(x, 0, kMany), text, kNeeded);
  };
  request_fields(t, record.request);
  t("family", Text(record.family), "", kNeeded);
  t("goal", Text(record.goal), "", kNeeded);
  count("variables", record.variables, "of the capture problem");
  count("equations", record.equations, "of the capture problem");
  t("stillbase", Text(version), "version", kNeeded);
  t("library", Text(record.library), "whose code ran", kNeeded);
  t("options", Text(record.options), "that were set", kNeeded);
  t("end", Word(record.end, names_up_to(RunEnd::OutOfMemory)), "of the process", kNeeded);
  t("stop_reason", Text(record.stop_reason), "of the last local solve", kNeeded);
  t("message", Text(record.message), "", kNeeded);
  count("evaluations", record.evaluations, "spent");
  count("gradients", record.gradients, "spent");
  count("hessians", record.hessians, "spent");
  count("starts", record.starts, "local solves begun");
  count("distinct_solutions", record.distinct_solutions, "feasible and optimal ones");
  t("best_point", Numbers(record.best_point), "variables at the last improvement", kNeeded);
  t("best_kkt_residual", known_number(record.best_kkt_residual), "null: not known", kNeeded);
  t("improvements",
    List(record.improvements, [](Improvement& point) { return ImprovementRow(point); }),
    "evaluations, gradients, value, violation", kNeeded);
  t("measured", Map([&](Table& m) {
      m("host", Text(host), "", kNeeded);
      m("seconds", Number(record.seconds), "", kNeeded);
      m("improvements", Numbers(seconds, static_cast<int>(record.improvements.size())),
        "seconds of each", kNeeded);
    }),
    "what differs from run to run", kNeeded);
  for (std::size_t i = 0; i < std::min(seconds.size(), record.improvements.size()); ++i) {
    record.improvements[i].seconds = seconds[i];
  }
}

}  // namespace

static void fields(Table& t, BestKnown& best) {
  t("value", Number(best.value, kNonNegative), "|y| / unit", kNeeded);
  t("certificate", Map([&](Table& m) {
      m("max_violation", Number(best.violation, {.lower = 0, .upper = kReferenceViolation}), "",
        kNeeded);
      m("kkt_residual", known_number(best.kkt_residual), "null: not judged", kNeeded);
      m("point", Numbers(best.point), "variables of the program", kNeeded);
    }),
    "what proves it", kNeeded);
  t("optimizer", Text(best.optimizer), "that found it", kNeeded);
  t("seed", Seed(best.seed), "of that run", kNeeded);
  t("budget", Integer(best.budget, 0, kMany), "evaluations of that run", kNeeded);
  t("command", Text(best.command), "finds it again", kNeeded);
}

void best_known_fields(Table& t, BestKnownTable& table) {
  format_fields(t, "stillbase.best_known");
  t("values", Dictionary(table, [](BestKnown& best) { return map_of(best); }), "per instance",
    kNeeded);
}

void bench_fields(Table& t, BenchReferences& references) {
  format_fields(t, "stillbase.bench");
  t("gradient_cost", Number(references.gradient_cost, kNonNegative),
    "cost of a gradient in evaluations", kNeeded);
  t("references", Dictionary(references.values, [](double& x) { return Number(x); }),
    "what counts as solved, per instance", kNeeded);
}

}  // namespace io

std::string instance_sha256(const BenchmarkInstance& instance) {
  return sha256_hex(io::canonical(io::problem_json(instance.problem)) +
                    sha256_hex(instance.problem.urdf) + to_string(instance.goal));
}

std::string request_to_text(const RunRequest& request) {
  RunRequest copy = request;
  return io::written([&](io::Table& t) { io::request_fields(t, copy); }).dump();
}

RunRequest request_from_text(std::string_view text) {
  RunRequest request;
  io::read_json(text, "request", [&](io::Table& t) { io::request_fields(t, request); });
  return request;
}

std::string record_to_text(const RunRecord& record, const std::string& host) {
  RunRecord copy = record;
  std::string where = host;
  return io::written([&](io::Table& t) { io::record_fields(t, copy, where); }).dump();
}

std::vector<RunRecord> read_records(std::string_view text, const std::string& source) {
  std::vector<RunRecord> out;
  std::vector<Finding> findings;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    try {
      RunRecord record;
      std::string host;
      io::read_json(text.substr(0, end), source,
                    [&](io::Table& t) { io::record_fields(t, record, host); });
      out.push_back(std::move(record));
    } catch (const InputError& error) {
      findings.push_back({source, line, "not-a-record", error.findings().front().message});
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!findings.empty()) throw InputError(findings);
  return out;
}

BestKnownTable read_best_known(std::string_view text, const std::string& source) {
  BestKnownTable table;
  io::read_json(text, source, [&](io::Table& t) { io::best_known_fields(t, table); });
  return table;
}

std::string best_known_to_json(const BestKnownTable& table) {
  BestKnownTable copy = table;
  return io::pretty(io::written([&](io::Table& t) { io::best_known_fields(t, copy); }));
}

BenchReferences read_bench_references(std::string_view text, const std::string& source) {
  BenchReferences references;
  io::read_json(text, source, [&](io::Table& t) { io::bench_fields(t, references); });
  return references;
}

std::string bench_references_to_json(const BenchReferences& references) {
  BenchReferences copy = references;
  return io::pretty(io::written([&](io::Table& t) { io::bench_fields(t, copy); }));
}

int improve(BestKnownTable& table, const std::vector<RunRecord>& records, double by) {
  std::map<std::string, bool> changed;
  for (const RunRecord& record : records) {
    if (record.improvements.empty()) continue;
    const Improvement& last = record.improvements.back();
    if (!(last.violation <= kReferenceViolation)) continue;
    const RunRequest& request = record.request;
    const auto known = table.find(request.instance);
    if (known != table.end() && !(last.value < known->second.value - by)) continue;
    const std::string command = fmt::format(
        "stillbase bench --select {} --optimizers {} --first-seed {} --seeds 1 --budget {}",
        request.instance, label_of(request), request.seed, request.budget);
    table[request.instance] = {
        last.value,        last.violation, record.best_kkt_residual, record.best_point,
        label_of(request), request.seed,   request.budget,           command};
    changed[request.instance] = true;
  }
  return static_cast<int>(changed.size());
}

}  // namespace stillbase
