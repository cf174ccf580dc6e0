// A list of cases, evaluated by processes on one or many machines. Each finished case is a line in
// a journal, and merging checks that each is there exactly once.
//
// A case is one line of text that states everything that its worker needs. Its number
// is that of its line, from 0. The folder of a campaign holds `cases.jsonl` (a copy of the list)
// and one journal per shard. A journal only grows. Each record is one line with its checksum,
// flushed to the disk before the next case begins: killed at any moment, a run loses no finished
// case and repeats only those that were being worked on, at most one per worker. A case that was
// stopped leaves no record. One whose worker died is tried again; when it dies every time, its
// record says so, the campaign is incomplete, and the next run tries it again. Results do not
// depend on workers, shards or order, provided that the same case always gives the same result.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <stillbase/core/child_process.hpp>

namespace stillbase {

/// Cases index, index + count, ... (index from 0; on the command line I/N counts from 1).
struct Shard {
  int index = 0, count = 1;
  bool has(int number) const { return number % count == index; }
};

/// "2/4" -> {1, 4}.
/// @throws std::invalid_argument unless 1 <= I <= N
Shard shard_from_text(const std::string& text);

/// The lines of a list of cases.
/// @param path for messages
/// @throws InputError for an empty list, empty lines or duplicate cases
std::vector<std::string> cases_from_text(const std::string& text, const std::string& path);

using CaseStatus = ChildEnd;  ///< how the process of a case ended

/// What is known of a case that was worked on to its end, good or bad, or whose worker died.
struct CaseRecord {
  int number = 0;
  CaseStatus status = CaseStatus::Finished;
  std::string text;  ///< result of the worker, or why there is none; one line
};

struct CampaignOptions {
  std::string folder;
  Shard shard;
  int jobs = 1;           ///< worker processes
  double seconds = 3600;  ///< time limit of a case
  /// Of a case whose worker died, per run. A machine that was short of memory once seldom is so
  /// three times, after all other cases are done.
  int tries = 3;
  StopCondition stop;
  /// Called with the text of a case in this process before its worker begins; may be empty. A case
  /// for which it throws leaves no record, and no further case begins.
  std::function<void(const std::string&)> check_case;
  /// Called after each record (finished cases, cases of the shard); may be empty.
  std::function<void(int, int)> on_progress;
};

struct CampaignRun {
  int cases = 0;               ///< of the shard
  int found = 0;               ///< finished before this run
  int recorded = 0;            ///< by this run
  int failed = 0;              ///< of all these: crashed, timed out or out of memory
  std::vector<int> died = {};  ///< numbers of cases whose worker died at every try
  bool is_complete() const { return found + recorded == cases; }
};

/// Evaluates the cases of a shard that no journal of the folder has yet. Work that throws, hangs or
/// runs out of memory is a record with that status.
/// @param work from the text of a case to its result (one line); runs in a process of its own
/// @throws FileError when the folder cannot be written, or another run works on the shard
/// @throws InputError when the folder belongs to another list of cases
/// @throws what `options.check_case` throws, after the running cases have been recorded
CampaignRun run_campaign(const std::string& cases_text, const CampaignOptions& options,
                         const std::function<std::string(const std::string&)>& work);

struct MergedCampaign {
  std::string cases_sha256;  ///< of the list
  std::vector<std::string> cases;
  std::vector<CaseRecord> records;  ///< by number, each once
  std::vector<int> missing;         ///< numbers without a record, or whose worker died
  int duplicates = 0;               ///< further records that say the same
  std::vector<int> contradictory;   ///< numbers with records that differ
  int damaged = 0;                  ///< lines of journals that do not fit their checksum
  bool is_complete() const { return missing.empty() && contradictory.empty(); }
};

/// Everything that the journals of a folder hold.
/// @throws InputError when the folder holds no campaign
MergedCampaign merge_campaign(const std::string& folder);

}  // namespace stillbase
