// What the subcommands share: exit codes, signals, input and output.
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/robot/urdf_reader.hpp>

namespace stillbase::app {

/// What the shell learns. The numbers are a promise to scripts.
enum ExitCode : int {
  kDone = 0,
  kInternalError = 1,
  kCommandLine = 2,
  kInputRefused = 3,
  kInfeasible = 4,
  kVerificationFailed = 5,
  kLimit = 6,
  kFileFailed = 7,
  kCampaignIncomplete = 8,
  kNoApproach = 9,
  kSignalBase = 128  ///< + number of the signal
};

/// What an exit code means; those of signals share a line.
struct ExitMeaning {
  std::string codes, text;
};
std::vector<ExitMeaning> exit_meanings();

/// The same findings; those of a problem or plan file that name a key (`variables.joints: ...`) and
/// no line have the line of that key, of the section that lacks it, or of `format` for the file.
InputError with_lines(const InputError& error);

/// A command line that no parser can know to be wrong: exit code 2.
class CommandLineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens the descriptors 0 to 2 where they are closed, or the first file that is opened would
/// become one of them and take the messages. Writing to what is opened here fails.
void open_standard_descriptors();

/// From now on SIGINT and SIGTERM stop the work at the next good place; what was finished is saved.
/// A second signal ends the program at once, unless it comes together with the first: `timeout` and
/// batch systems send one to the process and one to its group. Writing to a closed pipe is an
/// error.
void catch_signals();

/// The stop condition that they set.
/// @param time_limit s from now; not positive: none
StopCondition stop_condition(double time_limit = 0);

/// 130 or 143 after a signal, else 0.
int signal_exit_code();

/// @param option what was given, with its name: "--optimizer ipopt"
/// @throws CommandLineError unless the name is one of the known ones; it suggests the nearest one
void check_known(const std::string& option, const std::string& name,
                 const std::vector<std::string>& known);

/// Extension with its dot, lower case.
std::string extension_of(const std::string& path);

/// Reads a robot file.
/// @param hand name of the hand link; empty: the only leaf link
/// @throws CommandLineError when `hand` is empty and there are several leaf links
/// @throws InputError, FileError
RobotModel load_robot(const std::string& path, const std::string& hand,
                      const UrdfOptions& options = {});

/// Whether both paths lead to one file, which need not exist; false when one is empty.
bool is_same_file(const std::string& a, const std::string& b);

/// The file given with -o, if any, and whether it may replace one.
struct OutputFile {
  std::string path;
  bool force = false;

  bool is_given() const { return !path.empty(); }
  /// Before long work: can the file be written?
  /// @param endings extensions that the command can write, ".json"; empty: any
  /// @throws CommandLineError when the file has another extension
  /// @throws FileError when it exists without --force, or its folder does not
  void check(const std::vector<std::string>& endings = {}) const;
  /// Writes the file, or stdout when none is given.
  /// @throws FileError
  void write(std::string_view text) const;
};

/// Writes to stdout.
/// @throws FileError when stdout takes no more
void write_stdout(std::string_view text);

/// A line for people on stderr.
void say(std::string_view line);

/// The last line of a summary: the command to type next.
/// @param words of the command, without "stillbase"; each is quoted for the shell where it needs it
void say_next(const std::vector<std::string>& words);

/// The path with another extension: "plan.json" to "plan.html".
std::string with_extension(const std::string& path, const std::string& extension);

enum class Tone { Good, Bad, Open };

/// The text in colour when stderr is a terminal and the environment does not forbid it (NO_COLOR
/// not empty, TERM=dumb); else as it is.
std::string toned(Tone tone, const std::string& text);

/// One line on stderr that is rewritten as work goes on, with the time left; nothing unless stderr
/// is a terminal. The time left is that of the step, from the pace since it began.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const std::string& what, int done, int total);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool is_terminal_;
  bool is_shown_ = false;
  std::string what_ = {};  ///< the step that is under way
  int first_ = 0;          ///< done when it began
  Clock::time_point began_ = {}, drawn_ = {};
};

}  // namespace stillbase::app
