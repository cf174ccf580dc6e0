// The append-only file of a shard's records.
//
// Line: <first 16 hex digits of the SHA-256 of the rest> <bag> <number> <status> <text>, bag the
// first 16 digits of the bag's fingerprint. A line that a kill has torn has no newline or a wrong
// checksum.
#pragma once

#include <string>
#include <vector>

#include <stillbase/campaign/campaign.hpp>

namespace stillbase::campaign {

struct JournalContent {
  std::vector<CaseRecord> records;
  int damaged = 0;             ///< whole lines with a wrong checksum
  std::size_t torn_bytes = 0;  ///< after the last newline
};

/// @throws InputError for a record of another bag
JournalContent read_journal(const std::string& path, const std::string& bag);

/// Appends to a journal; only one process at a time may (a lock beside it, gone with the process).
class Journal {
 public:
  /// Cuts off what a kill has torn.
  /// @throws FileError
  Journal(const std::string& path, const std::string& bag);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  /// On the disk when it returns.
  void append(const CaseRecord& record);

 private:
  std::string path_, bag_;
  int lock_ = -1, file_ = -1;
};

}  // namespace stillbase::campaign
