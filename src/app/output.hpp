// Where results and messages go: data to stdout or a file, everything for people to stderr.
#pragma once

#include <string>
#include <string_view>

namespace stillbase::app {

/// The file given with -o, if any, and whether it may replace one.
struct OutputFile {
  std::string path;
  bool force = false;

  bool is_given() const { return !path.empty(); }
  /// Before long work: can the file be written?
  /// @throws FileError when it exists without --force, or its folder does not
  void check() const;
  /// Writes the file, or stdout when none is given.
  /// @throws FileError
  void write(std::string_view text) const;
};

/// Writes to stdout.
/// @throws FileError when stdout takes no more
void write_stdout(std::string_view text);

/// A line for people on stderr.
void say(std::string_view line);

/// One line on stderr that is rewritten as work goes on; nothing unless stderr is a terminal.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const std::string& what, int done, int total);
  void clear();

 private:
  bool is_terminal_;
  bool is_shown_ = false;
};

}  // namespace stillbase::app
