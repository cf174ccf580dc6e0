// Files of the benchmark: suites (`format: stillbase.suite`), requests and records of runs as JSON
// Lines, best known values.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/benchmark/record.hpp>
#include <stillbase/benchmark/suite.hpp>

namespace stillbase {

/// Reads a suite with the problem files that it names; their paths are relative to the suite's.
/// Strict as read_problem().
/// @throws InputError, FileError
SuiteSpec read_suite(const std::string& path);

/// Fingerprint of everything that makes up an instance: problem, robot text and goal.
std::string instance_sha256(const BenchmarkInstance& instance);

/// One request as one line without newline, and back.
std::string request_to_text(const RunRequest& request);
/// @throws InputError for a text that is no request
RunRequest request_from_text(std::string_view text);

/// One record as one line without newline. Numbers read back exactly; what differs from run to run
/// of the same command is under `measured`.
/// @param host what the run was measured on, in words
std::string record_to_text(const RunRecord& record, const std::string& host);

/// The records of a text with one per line.
/// @param source name for messages
/// @throws InputError with every line that is no record
std::vector<RunRecord> read_records(std::string_view text, const std::string& source);

/// Lowest value seen of an instance, with what proves it.
struct BestKnown {
  double value = 0;
  double violation = 0;       ///< at most kReferenceViolation
  double kkt_residual = -1;   ///< of the point; negative: not known
  std::vector<double> point;  ///< variables of the instance's program
  std::string optimizer;      ///< label of who found it
  std::uint64_t seed = 0;
  long budget = 0;
  std::string command;  ///< that finds it again
};
using BestKnownTable = std::map<std::string, BestKnown>;  ///< by instance

/// @throws InputError
BestKnownTable read_best_known(std::string_view text, const std::string& source);
std::string best_known_to_json(const BestKnownTable& table);

/// What the records of a folder are measured against: `bench.json`.
struct BenchReferences {
  double gradient_cost = 1;              ///< in evaluations
  std::map<std::string, double> values;  ///< by instance
};
/// @throws InputError
BenchReferences read_bench_references(std::string_view text, const std::string& source);
std::string bench_references_to_json(const BenchReferences& references);

/// Enters what the records reached where it is new or lower than the table's value.
/// @param by least difference that counts; default: a hundredth of the tightest target
/// @return number of entries that changed
int improve(BestKnownTable& table, const std::vector<RunRecord>& records, double by = 1e-10);

}  // namespace stillbase
