#include "app/output.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>

namespace stillbase::app {

void OutputFile::check() const {
  if (!is_given()) return;
  std::error_code ignored;
  const std::filesystem::path target(path);
  if (std::filesystem::exists(target, ignored)) {
    if (!std::filesystem::is_regular_file(target, ignored)) {
      throw FileError(path + ": not a regular file");
    }
    if (!force) throw FileError(path + ": exists already; --force replaces it");
  }
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw FileError(path + ": there is no folder " + folder.string());
  }
  if (access(folder.c_str(), W_OK) != 0) {
    throw FileError(path + ": the folder " + folder.string() + " cannot be written");
  }
}

void OutputFile::write(std::string_view text) const {
  if (is_given()) {
    write_file_atomically(path, text, force);
  } else {
    write_stdout(text);
  }
}

void write_stdout(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw FileError("standard output cannot be written");
  }
}

void say(std::string_view line) { fmt::print(stderr, "{}\n", line); }

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) == 1) {}
ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const std::string& what, int done, int total) {
  if (!is_terminal_) return;
  fmt::print(stderr, "\r\033[K{} {}/{}", what, done, total);
  std::fflush(stderr);
  is_shown_ = true;
}

void ProgressLine::clear() {
  if (!is_shown_) return;
  fmt::print(stderr, "\r\033[K");
  is_shown_ = false;
}

}  // namespace stillbase::app
