#include <stillbase/core/child_process.hpp>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <utility>
#include <vector>

#include <stillbase/core/error.hpp>

#include "core/sanitized.hpp"

namespace stillbase {

namespace {

using Clock = std::chrono::steady_clock;

// Exit codes of a child; with any other it died.
constexpr int kReturned = 0, kThrew = 81, kNoMemory = 82;
constexpr double kMostSeconds = 1e9;  // of processor time that the system's limit can state
constexpr std::chrono::milliseconds kPoll{50};     // also how soon a limit or a stop is seen
constexpr std::chrono::seconds kShortestPause{1};  // a busy machine delays a process by less

/// Writes all bytes, or gives up when nobody reads.
void write_all(int fd, const std::string& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t n = ::write(fd, bytes.data() + written, bytes.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    written += static_cast<std::size_t>(n);
  }
}

/// Bytes that this process has mapped, as far as the system says.
std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// The signal SIGPROF after some processor time; RLIMIT_CPU knows whole seconds alone.
void end_after(double processor_seconds) {
  if (!(processor_seconds < kMostSeconds)) return;
  ::signal(SIGPROF, SIG_DFL);
  const double whole = std::floor(processor_seconds);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(whole);
  timer.it_value.tv_usec =
      std::max<suseconds_t>(1, static_cast<suseconds_t>(1e6 * (processor_seconds - whole)));
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

/// The kernel kills this process when its parent ends.
void end_with(pid_t parent) {
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (::getppid() != parent) ::_exit(kThrew);  // it ended before
}

/// The life of a child. Leaves by _exit: buffers and handlers of the parent are not its own.
/// @param address_space that it shares with its parent, bytes
[[noreturn]] void live(int fd, const ChildOptions& options, std::uint64_t address_space,
                       const std::function<std::string(int)>& work, int index) {
  const auto cpu = static_cast<rlim_t>(std::ceil(std::min(options.seconds, kMostSeconds))) + 1;
  // The signal of the hard limit, SIGKILL, would hide why the child ended.
  const rlimit cpu_limit{cpu, cpu + 1};
  const std::uint64_t memory = address_space + options.memory;
  const rlimit memory_limit{memory, memory};
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &cpu_limit);
  if (!STILLBASE_SANITIZED) ::setrlimit(RLIMIT_AS, &memory_limit);
  ::setrlimit(RLIMIT_CORE, &no_core);
  // Both reach the whole process group, and are the parent's to answer.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
  if (!STILLBASE_SANITIZED) {  // a sanitizer reports by its own handlers
    for (const int fault : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) ::signal(fault, SIG_DFL);
  }
  sigset_t none;  // the forking thread may have blocked those of the limits
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  end_after(options.processor_seconds);
  int code = kReturned;
  try {
    write_all(fd, work(index));
  } catch (const std::bad_alloc&) {
    code = kNoMemory;
  } catch (const std::exception& error) {
    write_all(fd, error.what());
    code = kThrew;
  } catch (...) {
    code = kThrew;
  }
  ::_exit(code);
}

struct Child {
  pid_t pid = -1;
  int fd = -1;
  int index = 0;
  Clock::time_point begin;
  std::string bytes;
};

double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

/// Waits for a child that has closed its pipe or was killed.
int reap(Child& child) {
  ::close(child.fd);
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

void kill_child(Child& child) {
  ::kill(child.pid, SIGKILL);
  reap(child);
}

ChildOutcome outcome_of(Child& child, double seconds) {
  ChildOutcome out;
  out.seconds = seconds;
  const int status = reap(child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kReturned) {
    out.end = ChildEnd::Finished;
    out.bytes = std::move(child.bytes);
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kNoMemory) {
    out.end = ChildEnd::OutOfMemory;
    out.message = "memory limit";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kThrew) {
    out.message = child.bytes;
  } else if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGPROF)) {
    out.end = ChildEnd::TimedOut;
    out.message = "time limit";
  } else {
    out.end = ChildEnd::Died;
    out.message = WIFSIGNALED(status)
                      ? ::strsignal(WTERMSIG(status))
                      : "left with exit code " + std::to_string(WEXITSTATUS(status));
  }
  return out;
}

/// The running children; whatever happens, none outlives this object.
class Children {
 public:
  Children() = default;
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() {
    for (Child& child : running_) kill_child(child);
  }

  std::vector<Child>& running() { return running_; }

  void begin(int index, const ChildOptions& options, const std::function<std::string(int)>& work) {
    int ends[2];
    if (::pipe(ends) != 0) throw FileError(std::string("no pipe: ") + std::strerror(errno));
    // Programs that another thread starts are not to hold the pipe open.
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    const pid_t parent = ::getpid();
    const std::uint64_t held = address_space();
    const pid_t pid = ::fork();
    if (pid < 0) {
      ::close(ends[0]);
      ::close(ends[1]);
      throw FileError(std::string("no process: ") + std::strerror(errno));
    }
    if (pid == 0) {
      end_with(parent);
      ::close(ends[0]);
      for (const Child& other : running_) ::close(other.fd);
      live(ends[1], options, held, work, index);
    }
    ::close(ends[1]);
    running_.push_back({pid, ends[0], index, Clock::now(), {}});
  }

  /// Reads what has come within a short while. True for the children whose pipe is at its end, or
  /// who have ended and left nothing in it: a child that another thread forked may hold its pipe
  /// open.
  std::vector<bool> listen() {
    std::vector<pollfd> polled;
    for (const Child& child : running_) polled.push_back({child.fd, POLLIN, 0});
    const std::vector<bool> had_ended = those_ended();
    ::poll(polled.data(), polled.size(), static_cast<int>(kPoll.count()));
    std::vector<bool> ended(running_.size(), false);
    for (std::size_t i = 0; i < running_.size(); ++i) {
      if (polled[i].revents == 0) {
        ended[i] = had_ended[i];
        continue;
      }
      char buffer[65536];
      const ssize_t n = ::read(running_[i].fd, buffer, sizeof(buffer));
      if (n > 0) running_[i].bytes.append(buffer, static_cast<std::size_t>(n));
      ended[i] = n == 0 || (n < 0 && errno != EINTR && errno != EAGAIN);
    }
    return ended;
  }

 private:
  /// True for the children that have ended.
  std::vector<bool> those_ended() const {
    std::vector<bool> list;
    for (const Child& child : running_) {
      siginfo_t info{};
      const int status =
          ::waitid(P_PID, static_cast<id_t>(child.pid), &info, WEXITED | WNOHANG | WNOWAIT);
      list.push_back(status == 0 && info.si_pid == child.pid);
    }
    return list;
  }

  std::vector<Child> running_;
};

/// Leaves a pause of this process out of the time of its children, which most likely had it as
/// well.
/// @param before, now instants between which the children were listened to once
void leave_out_pause(std::vector<Child>& running, Clock::time_point before, Clock::time_point now) {
  const Clock::duration pause = now - before - kPoll;
  if (pause < kShortestPause) return;
  // A child that began within the pause has no age yet.
  for (Child& child : running) child.begin = std::min(child.begin + pause, now);
}

}  // namespace

std::string to_string(ChildEnd end) {
  switch (end) {
    case ChildEnd::Finished:
      return "finished";
    case ChildEnd::Crashed:
      return "crashed";
    case ChildEnd::TimedOut:
      return "timed_out";
    case ChildEnd::OutOfMemory:
      return "out_of_memory";
    case ChildEnd::Died:
      return "died";
  }
  return "unknown";
}

int run_in_children(int count, const ChildOptions& options,
                    const std::function<std::string(int)>& work,
                    const std::function<void(int, const ChildOutcome&)>& done) {
  Children children;
  std::vector<Child>& running = children.running();
  int next = 0, reported = 0;
  Clock::time_point now = Clock::now();
  std::exception_ptr refusal;  // of `before`
  while (!options.stop.reached() && (next < count || !running.empty())) {
    while (next < count && static_cast<int>(running.size()) < std::max(1, options.jobs)) {
      try {
        if (options.before) options.before(next);
      } catch (...) {
        refusal = std::current_exception();
        count = next;
        break;
      }
      children.begin(next++, options, work);
    }
    const std::vector<bool> ended = children.listen();
    const Clock::time_point before = std::exchange(now, Clock::now());
    leave_out_pause(running, before, now);
    for (std::size_t i = running.size(); i-- > 0;) {
      const double seconds = seconds_between(running[i].begin, now);
      const bool late = seconds > options.seconds;
      if (!ended[i] && !late) continue;
      Child child = std::move(running[i]);
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
      ChildOutcome outcome;
      if (ended[i]) {
        outcome = outcome_of(child, seconds);
      } else {
        kill_child(child);
        outcome = {ChildEnd::TimedOut, "", "time limit", seconds};
      }
      ++reported;
      done(child.index, outcome);
    }
  }
  if (refusal) std::rethrow_exception(refusal);
  return reported;
}

}  // namespace stillbase
