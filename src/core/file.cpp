#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>

namespace stillbase {

namespace {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

FileError system_error(const std::string& path, const std::string& what) {
  return FileError(path + ": " + what + ": " + std::strerror(errno));
}

InputError refused(const std::string& path, const std::string& rule, const std::string& message) {
  return InputError({{path, 0, rule, message}});
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// A temporary file beside `path`, `<path>.tmp.<process>.<number>`. It is locked while this object
/// lives: one that can be locked was left by a process that ended in writing. Removed at the end
/// unless it was released.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& path) {
    static std::atomic<unsigned> counter{0};
    do {
      path_ = path + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(counter++);
      file_.emplace(::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
      // In a container all processes may have one number: the name may be taken.
      if (get() < 0 && errno != EEXIST) throw system_error(path, "cannot write");
    } while (get() < 0 || !is_locked());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (owned_) ::unlink(path_.c_str());
  }
  const std::string& path() const { return path_; }
  int get() const { return file_->get(); }
  void release() { owned_ = false; }

 private:
  /// False: another process found it before it was locked, and removes it. True on file systems
  /// without locks, where nobody removes it.
  bool is_locked() {
    if (::flock(file_->get(), LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
    struct stat status {};
    return ::fstat(file_->get(), &status) != 0 || status.st_nlink > 0;
  }

  std::string path_;
  std::optional<Descriptor> file_;
  bool owned_ = true;
};

/// "<process>.<number>", as the name of a temporary file ends.
bool is_temporary_ending(std::string_view text) {
  const std::size_t dot = text.find('.');
  const auto is_number = [](std::string_view part) {
    return !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return dot != std::string_view::npos && is_number(text.substr(0, dot)) &&
         is_number(text.substr(dot + 1));
}

/// Removes the temporary files that killed processes left beside `path`. What cannot be removed
/// stays.
void clear_temporary_files(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string begin =
      path.substr(slash == std::string::npos ? 0 : slash + 1) + std::string(".tmp.");
  // Not by increment(error), which ends the process where there is no memory.
  try {
    for (const auto& entry : std::filesystem::directory_iterator(folder_of(path))) {
      const std::string name = entry.path().filename().string();
      if (name.rfind(begin, 0) != 0) continue;
      if (!is_temporary_ending(std::string_view(name).substr(begin.size()))) continue;
      const char* const there = entry.path().c_str();
      const Descriptor file(::open(there, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
      if (file.get() < 0 || ::flock(file.get(), LOCK_EX | LOCK_NB) != 0) continue;
      ::unlink(there);
    }
  } catch (const std::filesystem::filesystem_error&) {
    // A folder that cannot be listed.
  }
}

void write_all(int fd, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw system_error(path, "cannot write");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// Puts the finished file in its place. Without `overwrite` the kernel itself must refuse an
// existing target, or two runs could both pass a check made before.
void move_into_place(const std::string& from, const std::string& to, bool overwrite) {
  if (overwrite) {
    if (::rename(from.c_str(), to.c_str()) != 0) throw system_error(to, "cannot write");
    return;
  }
  if (::link(from.c_str(), to.c_str()) != 0) {
    if (errno == EEXIST) throw FileError(to + ": the file exists already");
    throw system_error(to, "cannot write");
  }
  ::unlink(from.c_str());
}

// The rename itself reaches the disk only when the folder is flushed. Some file systems cannot do
// that; the content is whole in any case, so their refusal is not an error.
void flush_folder(const std::string& folder) {
  Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() >= 0) (void)::fsync(directory.get());
}

}  // namespace

std::string read_text_file(const std::string& path, std::size_t max_bytes) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      throw refused(path, "missing-file", "there is no such file");
    }
    throw system_error(path, "cannot open");
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw system_error(path, "cannot read");
  if (S_ISDIR(status.st_mode)) throw refused(path, "not-a-file", "is a folder");

  const auto too_large = [&] {
    return refused(path, "too-large", "more than " + std::to_string(max_bytes) + " bytes");
  };
  if (S_ISREG(status.st_mode) && static_cast<std::uintmax_t>(status.st_size) > max_bytes) {
    throw too_large();
  }
  // The size is also counted while reading: pipes have none and files grow.
  std::string text;
  if (S_ISREG(status.st_mode)) text.reserve(static_cast<std::size_t>(status.st_size));
  char buffer[1 << 16];
  for (;;) {
    const ssize_t count = ::read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw system_error(path, "cannot read");
    if (count == 0) return text;
    if (text.size() + static_cast<std::size_t>(count) > max_bytes) throw too_large();
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

std::size_t first_bad_byte(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned char c = byte(i);
    if (c < 0x80) {
      if ((c < 0x20 && c != '\n' && c != '\r' && c != '\t') || c == 0x7F) return i;
      ++i;
      continue;
    }
    const std::size_t length = c >= 0xF0 ? 4 : c >= 0xE0 ? 3 : 2;
    if (c < 0xC2 || c > 0xF4 || i + length > text.size()) return i;
    unsigned code = length == 4 ? c & 0x07u : length == 3 ? c & 0x0Fu : c & 0x1Fu;
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(i + k) & 0xC0u) != 0x80u) return i;
      code = (code << 6) | (byte(i + k) & 0x3Fu);
    }
    const bool is_overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    if (is_overlong || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return i;
    i += length;
  }
  return std::string_view::npos;
}

void write_file_atomically(const std::string& path, std::string_view text, bool overwrite) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode)) throw FileError(path + ": is not a regular file");
    if (!overwrite) throw FileError(path + ": the file exists already");
  }
  clear_temporary_files(path);
  TemporaryFile file(path);
  write_all(file.get(), text, path);
  if (::fsync(file.get()) != 0) throw system_error(path, "cannot flush");
  move_into_place(file.path(), path, overwrite);
  file.release();
  flush_folder(folder_of(path));
}

}  // namespace stillbase
