#include <stillbase/io/benchmark_file.hpp>

#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/child_process.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/sha256.hpp>

#include "io/json.hpp"
#include "io/json_problem.hpp"
#include "io/names.hpp"

namespace stillbase {

namespace {

using io::Json;

const io::Names<RunEnd>& end_names() {
  static const io::Names<RunEnd> names = {{"finished", RunEnd::Finished},
                                          {"crashed", RunEnd::Crashed},
                                          {"timed_out", RunEnd::TimedOut},
                                          {"out_of_memory", RunEnd::OutOfMemory}};
  return names;
}

Json request_json(const RunRequest& request) {
  return {{"instance", request.instance},
          {"problem_sha256", request.problem_sha256},
          {"optimizer", request.optimizer},
          {"library_defaults", request.library_defaults},
          {"seed", request.seed},
          {"limits",
           {{"evaluations", request.budget},
            {"seconds", request.seconds},
            {"memory_bytes", ChildOptions{}.memory}}}};
}

RunRequest request_of(const Json& json) {
  RunRequest out;
  json.at("instance").get_to(out.instance);
  json.at("problem_sha256").get_to(out.problem_sha256);
  json.at("optimizer").get_to(out.optimizer);
  json.at("library_defaults").get_to(out.library_defaults);
  json.at("seed").get_to(out.seed);
  json.at("limits").at("evaluations").get_to(out.budget);
  json.at("limits").at("seconds").get_to(out.seconds);
  return out;
}

/// A number that may be missing: null for what is negative.
Json optional_json(double x) { return x < 0 ? Json() : x; }
double optional_of(const Json& json) { return json.is_null() ? -1 : json.get<double>(); }

Json numbers_json(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(value);
  return out;
}

RunRecord record_of(const Json& json) {
  RunRecord out;
  out.request = request_of(json);
  json.at("family").get_to(out.family);
  json.at("goal").get_to(out.goal);
  json.at("variables").get_to(out.variables);
  json.at("equations").get_to(out.equations);
  json.at("library").get_to(out.library);
  json.at("options").get_to(out.options);
  const auto end = io::value_of(end_names(), json.at("end").get<std::string>());
  if (!end) throw std::invalid_argument("unknown end");
  out.end = *end;
  json.at("stop_reason").get_to(out.stop_reason);
  json.at("message").get_to(out.message);
  json.at("evaluations").get_to(out.evaluations);
  json.at("gradients").get_to(out.gradients);
  json.at("hessians").get_to(out.hessians);
  json.at("starts").get_to(out.starts);
  json.at("distinct_solutions").get_to(out.distinct_solutions);
  json.at("best_point").get_to(out.best_point);
  out.best_kkt_residual = optional_of(json.at("best_kkt_residual"));
  const Json& improvements = json.at("improvements");
  const Json& measured = json.at("measured");
  measured.at("seconds").get_to(out.seconds);
  const auto seconds = measured.at("improvements").get<std::vector<double>>();
  if (seconds.size() != improvements.size()) throw std::invalid_argument("lengths differ");
  for (std::size_t i = 0; i < improvements.size(); ++i) {
    const Json& row = improvements.at(i);
    if (row.size() != 4) throw std::invalid_argument("an improvement has four numbers");
    out.improvements.push_back({row.at(0).get<long>(), row.at(1).get<long>(),
                                row.at(2).get<double>(), row.at(3).get<double>(), seconds[i]});
  }
  return out;
}

}  // namespace

std::string instance_sha256(const BenchmarkInstance& instance) {
  return sha256_hex(io::canonical(io::problem_json(instance.problem)) +
                    sha256_hex(instance.problem.urdf) + to_string(instance.goal));
}

std::string request_to_text(const RunRequest& request) { return request_json(request).dump(); }

RunRequest request_from_text(std::string_view text) {
  try {
    return request_of(Json::parse(text));
  } catch (const std::exception& error) {
    throw InputError({{"request", 0, "not-a-request", error.what()}});
  }
}

std::string record_to_text(const RunRecord& record, const std::string& host) {
  Json json = request_json(record.request);
  json["family"] = record.family;
  json["goal"] = record.goal;
  json["variables"] = record.variables;
  json["equations"] = record.equations;
  json["stillbase"] = STILLBASE_VERSION;
  json["library"] = record.library;
  json["options"] = record.options;
  json["end"] = io::word_of(end_names(), record.end);
  json["stop_reason"] = record.stop_reason;
  json["message"] = record.message;
  json["evaluations"] = record.evaluations;
  json["gradients"] = record.gradients;
  json["hessians"] = record.hessians;
  json["starts"] = record.starts;
  json["distinct_solutions"] = record.distinct_solutions;
  json["best_point"] = numbers_json(record.best_point);
  json["best_kkt_residual"] = optional_json(record.best_kkt_residual);
  json["improvements"] = Json::array();
  Json seconds = Json::array();
  for (const Improvement& point : record.improvements) {
    json["improvements"].push_back(
        {point.evaluations, point.gradients, point.value, point.violation});
    seconds.push_back(point.seconds);
  }
  json["measured"] = {{"host", host}, {"seconds", record.seconds}, {"improvements", seconds}};
  return json.dump();
}

std::vector<RunRecord> read_records(std::string_view text, const std::string& source) {
  std::vector<RunRecord> out;
  std::vector<Finding> findings;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    try {
      out.push_back(record_of(Json::parse(text.substr(0, end))));
    } catch (const std::exception& error) {
      findings.push_back({source, line, "not-a-record", error.what()});
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!findings.empty()) throw InputError(findings);
  return out;
}

BestKnownTable read_best_known(std::string_view text, const std::string& source) {
  BestKnownTable out;
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != "stillbase.best_known") throw std::invalid_argument("wrong format");
    if (json.at("version") != 1) throw std::invalid_argument("unknown version");
    for (const auto& [instance, entry] : json.at("values").items()) {
      BestKnown& best = out[instance];
      entry.at("value").get_to(best.value);
      const Json& certificate = entry.at("certificate");
      certificate.at("max_violation").get_to(best.violation);
      best.kkt_residual = optional_of(certificate.at("kkt_residual"));
      certificate.at("point").get_to(best.point);
      entry.at("optimizer").get_to(best.optimizer);
      entry.at("seed").get_to(best.seed);
      entry.at("budget").get_to(best.budget);
      entry.at("command").get_to(best.command);
      if (!(best.value >= 0)) throw std::invalid_argument(instance + ": value must be >= 0");
      if (!(best.violation <= kReferenceViolation)) {
        throw std::invalid_argument(instance + ": the point violates its constraints");
      }
    }
  } catch (const std::exception& error) {
    throw InputError({{source, 0, "not-best-known", error.what()}});
  }
  return out;
}

std::string best_known_to_json(const BestKnownTable& table) {
  Json json;
  json["format"] = "stillbase.best_known";
  json["version"] = 1;
  json["values"] = Json::object();
  for (const auto& [instance, best] : table) {
    json["values"][instance] = {{"value", best.value},
                                {"certificate",
                                 {{"max_violation", best.violation},
                                  {"kkt_residual", optional_json(best.kkt_residual)},
                                  {"point", numbers_json(best.point)}}},
                                {"optimizer", best.optimizer},
                                {"seed", best.seed},
                                {"budget", best.budget},
                                {"command", best.command}};
  }
  return io::pretty(json);
}

int improve(BestKnownTable& table, const std::vector<RunRecord>& records) {
  constexpr double kBeaten = 1e-10;  // a hundredth of the tightest target
  std::map<std::string, bool> changed;
  for (const RunRecord& record : records) {
    if (record.improvements.empty()) continue;
    const Improvement& last = record.improvements.back();
    if (!(last.violation <= kReferenceViolation)) continue;
    const RunRequest& request = record.request;
    const auto known = table.find(request.instance);
    if (known != table.end() && !(last.value < known->second.value - kBeaten)) continue;
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
