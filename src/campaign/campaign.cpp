#include <stillbase/campaign/campaign.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <stillbase/core/child_process.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>

#include "campaign/journal.hpp"

namespace stillbase {
namespace {

namespace fs = std::filesystem;
using namespace campaign;

constexpr const char* kCases = "cases.jsonl";

std::string list_of(const std::string& cases_text) { return sha256_hex(cases_text).substr(0, 16); }

/// Sorted by name, so that a merge does not depend on the order in the folder.
std::vector<std::string> journals_of(const std::string& folder) {
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_journal = name.rfind("journal-", 0) == 0 && entry.path().extension() == ".txt";
    if (is_journal) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Makes the folder, or checks that it belongs to this list of cases.
void prepare_folder(const std::string& folder, const std::string& cases_text) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(folder + ": cannot make the folder: " + error.message());
  const std::string path = (fs::path(folder) / kCases).string();
  if (!fs::exists(path)) {
    try {
      write_file_atomically(path, cases_text, false);
      return;
    } catch (const FileError&) {
      if (!fs::exists(path)) throw;  // else another shard was faster
    }
  }
  if (read_text_file(path) != cases_text) {
    throw InputError({{path, 0, "other-campaign", "the folder belongs to another list of cases"}});
  }
}

}  // namespace

Shard shard_from_text(const std::string& text) {
  int i = 0, n = 0;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, begin + slash, i);
  const auto second = slash < text.size() ? std::from_chars(begin + slash + 1, end, n) : first;
  const bool is_whole = first.ptr == begin + slash && second.ptr == end && slash < text.size();
  if (!is_whole || n < 1 || i < 1 || i > n) {
    throw std::invalid_argument("shard '" + text + "' is not I/N with 1 <= I <= N");
  }
  return {i - 1, n};
}

std::vector<std::string> cases_from_text(const std::string& text, const std::string& path) {
  std::vector<std::string> cases;
  std::vector<Finding> findings;
  std::set<std::string> seen;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    cases.push_back(text.substr(begin, end - begin));
    begin = end + 1;
    const int line = static_cast<int>(cases.size());
    if (cases.back().empty()) findings.push_back({path, line, "empty-case", "an empty line"});
    if (!seen.insert(cases.back()).second) {
      findings.push_back({path, line, "duplicate-case", "the case is there already"});
    }
  }
  if (cases.empty()) findings.push_back({path, 0, "no-cases", "there are no cases"});
  if (!findings.empty()) throw InputError(std::move(findings));
  return cases;
}

CampaignRun run_campaign(const std::string& cases_text, const CampaignOptions& options,
                         const std::function<std::string(const std::string&)>& work) {
  const std::vector<std::string> cases = cases_from_text(cases_text, "cases");
  prepare_folder(options.folder, cases_text);
  const std::string list = list_of(cases_text);
  const std::string name = "journal-" + std::to_string(options.shard.index + 1) + "-of-" +
                           std::to_string(options.shard.count) + ".txt";
  Journal journal((fs::path(options.folder) / name).string(), list);

  std::map<int, CaseStatus> found;
  for (const std::string& path : journals_of(options.folder)) {
    for (const CaseRecord& record : read_journal(path, list).records) {
      if (record.status != CaseStatus::Died) found[record.number] = record.status;
    }
  }
  CampaignRun run;
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(cases.size()); ++i) {
    if (!options.shard.has(i)) continue;
    ++run.cases;
    const auto at = found.find(i);
    if (at == found.end()) {
      open.push_back(i);
      continue;
    }
    ++run.found;
    run.failed += at->second != CaseStatus::Finished;
  }

  ChildOptions children;
  children.jobs = options.jobs;
  children.seconds = options.seconds;
  children.stop = options.stop;
  for (int time = 1; time <= options.tries && !open.empty(); ++time) {
    const std::vector<int> numbers = std::exchange(open, {});
    const auto number = [&](int i) { return numbers[static_cast<std::size_t>(i)]; };
    const auto text = [&](int i) -> const std::string& {
      return cases[static_cast<std::size_t>(number(i))];
    };
    if (options.check_case) children.before = [&](int i) { options.check_case(text(i)); };
    run_in_children(
        static_cast<int>(numbers.size()), children, [&](int i) { return work(text(i)); },
        [&](int i, const ChildOutcome& outcome) {
          const CaseStatus status = outcome.end;
          if (status == CaseStatus::Died) {
            open.push_back(number(i));
            if (time < options.tries) return;
            const std::string tries = " (" + std::to_string(time) + " tries)";
            return journal.append({number(i), status, outcome.message + tries});
          }
          const bool is_good = status == CaseStatus::Finished;
          journal.append({number(i), status, is_good ? outcome.bytes : outcome.message});
          ++run.recorded;
          run.failed += !is_good;
          if (options.on_progress) options.on_progress(run.found + run.recorded, run.cases);
        });
    if (options.stop.reached()) return run;
  }
  run.died = std::move(open);
  std::sort(run.died.begin(), run.died.end());
  return run;
}

MergedCampaign merge_campaign(const std::string& folder) {
  const std::string path = (fs::path(folder) / kCases).string();
  const std::string text = read_text_file(path);
  MergedCampaign merged;
  merged.cases_sha256 = sha256_hex(text);
  merged.cases = cases_from_text(text, path);
  const int count = static_cast<int>(merged.cases.size());
  std::map<int, CaseRecord> records;
  std::set<int> contradictory;
  for (const std::string& journal : journals_of(folder)) {
    const JournalContent content = read_journal(journal, list_of(text));
    merged.damaged += content.damaged;
    for (const CaseRecord& record : content.records) {
      if (record.number >= count) {
        throw InputError({{journal, 0, "no-such-case", std::to_string(record.number)}});
      }
      const auto [at, is_new] = records.insert({record.number, record});
      if (is_new || record.status == CaseStatus::Died) continue;
      if (at->second.status == CaseStatus::Died) {
        at->second = record;
        continue;
      }
      const bool same = at->second.status == record.status && at->second.text == record.text;
      if (same) ++merged.duplicates;
      if (!same) contradictory.insert(record.number);
    }
  }
  for (int i = 0; i < count; ++i) {
    const auto at = records.find(i);
    const bool has_result = at != records.end() && at->second.status != CaseStatus::Died;
    if (!has_result) merged.missing.push_back(i);
  }
  for (auto& entry : records) merged.records.push_back(std::move(entry.second));
  merged.contradictory.assign(contradictory.begin(), contradictory.end());
  return merged;
}

}  // namespace stillbase
