#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

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
  ~Descriptor() { close(); }
  int get() const { return fd_; }
  int close() {
    const int result = fd_ >= 0 ? ::close(fd_) : 0;
    fd_ = -1;
    return result;
  }

 private:
  int fd_;
};

/// Removes a file at the end of its life unless it was released.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& path) : path_(path) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (owned_) ::unlink(path_.c_str());
  }
  void release() { owned_ = false; }

 private:
  std::string path_;
  bool owned_ = true;
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
  static std::atomic<unsigned> counter{0};
  const std::string temporary =
      path + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(counter++);
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) throw system_error(path, "cannot write");
  TemporaryFile guard(temporary);
  write_all(file.get(), text, path);
  if (::fsync(file.get()) != 0) throw system_error(path, "cannot flush");
  if (file.close() != 0) throw system_error(path, "cannot write");
  move_into_place(temporary, path, overwrite);
  guard.release();
  flush_folder(folder_of(path));
}

}  // namespace stillbase
