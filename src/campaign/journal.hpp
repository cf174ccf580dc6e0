// The append-only file of a shard's records.
//
// Line: <checksum> <list> <number> <status> <text>. The checksum is the first 16 hex digits of the
// SHA-256 of what follows it; <list> is the first 16 digits of the SHA-256 of the list of cases. A
// line that was cut off when the process was killed has no newline or a wrong checksum.
#pragma once

#include <string>
#include <vector>

#include <stillbase/campaign/campaign.hpp>

namespace stillbase::campaign {

struct JournalContent {
  std::vector<CaseRecord> records;
  int damaged = 0;                   ///< whole lines with a wrong checksum
  std::size_t incomplete_bytes = 0;  ///< after the last newline
};

/// @throws InputError for a record of another list of cases
JournalContent read_journal(const std::string& path, const std::string& list);

/// Appends to a journal. A lock file beside it, released with the process, admits one at a time.
class Journal {
 public:
  /// Removes an incomplete last line.
  /// @throws FileError
  Journal(const std::string& path, const std::string& list);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  /// The record is on the disk when this returns.
  void append(const CaseRecord& record);

 private:
  std::string path_, list_;
  int lock_ = -1, file_ = -1;
};

}  // namespace stillbase::campaign
