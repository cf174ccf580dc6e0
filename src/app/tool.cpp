#include "app/tool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "io/scalars.hpp"

namespace stillbase::app {

namespace {

std::atomic<bool> interrupted{false};
std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

std::atomic<std::int64_t> received_at{0};  ///< ms
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "used in a signal handler");

std::int64_t milliseconds_now() {
  timespec now = {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

/// `timeout` and batch systems send one signal to the process and its group, which is two.
constexpr std::int64_t kSameSignal = 500;  // ms

void on_signal(int number) {
  if (received != 0 && milliseconds_now() - received_at > kSameSignal) _exit(kSignalBase + number);
  if (received != 0) return;
  received_at = milliseconds_now();
  received = number;
  interrupted = true;
}

/// What cannot be said is not said: work goes on without its messages.
void write_stderr(std::string_view text) {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
  (void)std::fflush(stderr);
}

/// The key with which a finding's message begins, "robot.arms"; empty: none.
std::string key_of(const std::string& message) {
  const std::string key = message.substr(0, message.find(':'));
  const bool is_key =
      key.size() < message.size() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '[' || c == ']';
      });
  return is_key ? key : "";
}

}  // namespace

InputError with_lines(const InputError& error) {
  std::vector<Finding> findings = error.findings();
  for (Finding& finding : findings) {
    const std::string key = key_of(finding.message), extension = extension_of(finding.file);
    const bool has_keys = extension == ".yaml" || extension == ".yml" || extension == ".json";
    if (finding.line != 0 || key.empty() || !has_keys) continue;
    try {
      finding.line = line_of_key(finding.file, key);
      if (finding.line == 0) finding.line = line_of_key(finding.file, "format");
    } catch (const std::exception&) {
      // What cannot be read again has no lines: the finding stays as it is.
    }
  }
  return InputError(findings);
}

void open_standard_descriptors() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) (void)!open("/dev/null", O_RDONLY);
  }
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a reader who left is a failed write
  std::signal(SIGXFSZ, SIG_IGN);  // and so is a file that may not grow further
}

StopCondition stop_condition(double time_limit) {
  StopCondition stop;
  stop.interrupted = &interrupted;
  if (time_limit > 0) stop.set_deadline_after(time_limit);
  return stop;
}

int signal_exit_code() {
  const int number = received;
  return number == 0 ? 0 : kSignalBase + number;
}

void check_known(const std::string& option, const std::string& name,
                 const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw CommandLineError(fmt::format("{}: unknown; there are {}{}", option, fmt::join(known, ", "),
                                     io::did_you_mean(name, known)));
}

std::string extension_of(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

RobotModel load_robot(const std::string& path, const std::string& hand,
                      const UrdfOptions& options) {
  try {
    return read_robot(path, hand, options);
  } catch (const InputError& error) {
    // The file is good; the command line has to say which link is the hand.
    if (error.findings().size() == 1 && error.findings().front().rule == "hand-missing") {
      throw CommandLineError(to_string(error.findings().front()) + " (--hand LINK)");
    }
    throw;
  }
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code ignored;
  if (std::filesystem::equivalent(a, b, ignored)) return true;
  const auto full = [&ignored](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path), ignored);
  };
  return full(a) == full(b);
}

void OutputFile::check(const std::vector<std::string>& endings) const {
  if (!is_given()) return;
  const bool is_known =
      std::find(endings.begin(), endings.end(), extension_of(path)) != endings.end();
  if (!endings.empty() && !is_known) {
    throw CommandLineError(
        fmt::format("{}: this command writes {}", path, fmt::join(endings, ", ")));
  }
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

void say(std::string_view line) { write_stderr(fmt::format("{}\n", line)); }

namespace {

/// The word as a shell reads it back.
std::string shell_word(const std::string& word) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-./=,:+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// "40 s", "3 min 20 s", "2 h 5 min"
std::string duration_words(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

}  // namespace

void say_next(const std::vector<std::string>& words) {
  std::string command = "stillbase";
  for (const std::string& word : words) command += " " + shell_word(word);
  say("next: " + command);
}

std::string with_extension(const std::string& path, const std::string& extension) {
  return std::filesystem::path(path).replace_extension(extension).string();
}

std::string toned(Tone tone, const std::string& text) {
  static const bool has_colour = [] {
    const char *no_colour = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
    const bool is_forbidden = no_colour != nullptr && *no_colour != '\0';
    const bool is_dumb = terminal != nullptr && std::string_view(terminal) == "dumb";
    return isatty(STDERR_FILENO) == 1 && !is_forbidden && !is_dumb;
  }();
  if (!has_colour) return text;
  const char* code = tone == Tone::Good ? "32" : tone == Tone::Bad ? "1;31" : "33";
  return fmt::format("\033[{}m{}\033[0m", code, text);
}

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) == 1) {}
ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const std::string& what, int done, int total) {
  if (!is_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (what != what_ || done < first_) {
    what_ = what;
    first_ = done;
    began_ = now;
  } else if (done < total && now - drawn_ < std::chrono::milliseconds(100)) {
    return;
  }
  drawn_ = now;
  std::string left;
  if (done > first_ && done < total) {
    const double seconds = std::chrono::duration<double>(now - began_).count();
    left = fmt::format(", {} left", duration_words(seconds * (total - done) / (done - first_)));
  }
  write_stderr(fmt::format("\r\033[K{} {}/{}{}", what, done, total, left));
  is_shown_ = true;
}

void ProgressLine::clear() {
  if (!is_shown_) return;
  write_stderr("\r\033[K");
  is_shown_ = false;
}

}  // namespace stillbase::app
