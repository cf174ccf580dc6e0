#include "campaign/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>

namespace stillbase::campaign {
namespace {

constexpr std::size_t kMaxJournalBytes = std::size_t{16} << 30;
constexpr std::size_t kDigits = 16;
constexpr std::array kStatuses = {CaseStatus::Finished, CaseStatus::Crashed, CaseStatus::TimedOut,
                                  CaseStatus::OutOfMemory, CaseStatus::Died};

std::string checksum(std::string_view text) { return sha256_hex(text).substr(0, kDigits); }

FileError system_error(const std::string& path, const char* what) {
  return FileError(path + ": " + what + ": " + std::strerror(errno));
}

/// Removes and returns the first word of the text.
std::string_view word(std::string_view& text) {
  const std::size_t space = std::min(text.find(' '), text.size());
  const std::string_view head = text.substr(0, space);
  text.remove_prefix(std::min(space + 1, text.size()));
  return head;
}

std::optional<CaseRecord> record_from(std::string_view line, std::string& list) {
  const std::string_view stated = word(line);
  if (stated.size() != kDigits || checksum(line) != stated) return std::nullopt;
  list = word(line);
  CaseRecord record;
  const std::string_view number = word(line), status = word(line);
  const auto end = std::from_chars(number.data(), number.data() + number.size(), record.number);
  if (end.ec != std::errc() || record.number < 0) return std::nullopt;
  for (const CaseStatus candidate : kStatuses) {
    if (to_string(candidate) != status) continue;
    record.status = candidate;
    record.text = line;
    return record;
  }
  return std::nullopt;
}

}  // namespace

JournalContent read_journal(const std::string& path, const std::string& list) {
  const std::string text = read_text_file(path, kMaxJournalBytes);
  JournalContent content;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    std::string record_list;
    auto record = record_from(std::string_view(text).substr(begin, end - begin), record_list);
    begin = end + 1;
    if (!record) {
      ++content.damaged;
      continue;
    }
    if (record_list != list) {
      throw InputError({{path, 0, "other-campaign", "contains records of another list of cases"}});
    }
    content.records.push_back(std::move(*record));
  }
  content.incomplete_bytes = text.size() - begin;
  return content;
}

Journal::Journal(const std::string& path, const std::string& list) : path_(path), list_(list) {
  const std::string lock_path = path + ".lock";
  lock_ = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) throw system_error(lock_path, "cannot open");
  // A lock of the process: unlike flock() it does not live on in children that a kill leaves
  // behind.
  struct flock whole = {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(lock_, F_SETLK, &whole) != 0) {
    ::close(lock_);
    throw FileError(path + ": another run works on this shard");
  }
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) {
    const FileError error = system_error(path, "cannot open");
    ::close(lock_);
    throw FileError(error);
  }
  const std::size_t incomplete = read_journal(path, list).incomplete_bytes;
  const off_t size = ::lseek(file_, 0, SEEK_END);
  if (incomplete > 0 && ::ftruncate(file_, size - static_cast<off_t>(incomplete)) != 0) {
    const FileError error = system_error(path, "cannot cut off an incomplete record");
    ::close(file_);
    ::close(lock_);
    throw FileError(error);
  }
}

Journal::~Journal() {
  ::close(file_);
  ::close(lock_);
}

void Journal::append(const CaseRecord& record) {
  std::string body = list_ + " " + std::to_string(record.number) + " " + to_string(record.status) +
                     " " + record.text;
  for (char& c : body) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  const std::string line = checksum(body) + " " + body + "\n";
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t n = ::write(file_, line.data() + written, line.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw system_error(path_, "cannot write");
    written += static_cast<std::size_t>(n);
  }
  if (::fdatasync(file_) != 0) throw system_error(path_, "cannot flush");
}

}  // namespace stillbase::campaign
