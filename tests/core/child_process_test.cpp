// Work in children: what they return, and every way to fail.
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <set>
#include <stdexcept>

#include <catch2/catch.hpp>

#include <stillbase/core/child_process.hpp>

#include "core/sanitized.hpp"

namespace stillbase {
namespace {

ChildOutcome outcome_of(const std::function<std::string(int)>& work, ChildOptions options = {}) {
  ChildOutcome out;
  REQUIRE(run_in_children(1, options, work, [&](int, const ChildOutcome& got) { out = got; }) == 1);
  return out;
}

}  // namespace

TEST_CASE("every piece of work is reported once with what it returned, for any number of jobs") {
  for (const int jobs : {1, 3, 50}) {
    ChildOptions options;
    options.jobs = jobs;
    std::multiset<int> seen;
    const int reported = run_in_children(
        20, options, [](int i) { return std::string(static_cast<std::size_t>(i) * 20000, 'x'); },
        [&](int i, const ChildOutcome& outcome) {
          seen.insert(i);
          CHECK(outcome.end == ChildEnd::Finished);
          CHECK(outcome.bytes.size() == static_cast<std::size_t>(i) * 20000);
        });
    CHECK(reported == 20);
    CHECK(seen.size() == 20);
    CHECK(std::set<int>(seen.begin(), seen.end()).size() == 20);
  }
}

TEST_CASE("a child that throws, crashes or leaves is an outcome") {
  const ChildOutcome threw =
      outcome_of([](int) -> std::string { throw std::runtime_error("no such thing"); });
  CHECK(threw.end == ChildEnd::Crashed);
  CHECK(threw.message == "no such thing");

  const ChildOutcome crashed = outcome_of([](int) -> std::string {
    std::signal(SIGSEGV, SIG_DFL);  // the test's own handler would print
    std::raise(SIGSEGV);
    return "";
  });
  CHECK(crashed.end == ChildEnd::Died);
  CHECK_FALSE(crashed.message.empty());
  CHECK(crashed.bytes.empty());

  const ChildOutcome left = outcome_of([](int) -> std::string { ::_exit(3); });
  CHECK(left.end == ChildEnd::Died);
}

TEST_CASE("a child that asks for more memory than its limit is an outcome") {
  if (STILLBASE_SANITIZED) {
    WARN("skipped: no limit of address space under a sanitizer");
    return;
  }
  ChildOptions options;
  options.memory = 1ull << 30;
  const ChildOutcome greedy =
      outcome_of([](int) { return std::string(std::size_t{1} << 33, 'x').substr(0, 10); }, options);
  CHECK(greedy.end == ChildEnd::OutOfMemory);
}

TEST_CASE("a child's memory is counted beyond what its parent has") {
  if (STILLBASE_SANITIZED) {
    WARN("skipped: no limit of address space under a sanitizer");
    return;
  }
  constexpr std::size_t kBytes = std::size_t{4} << 30;  // reserved, not used
  void* const reserved =
      ::mmap(nullptr, kBytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  REQUIRE(reserved != MAP_FAILED);
  ChildOptions options;
  options.memory = 1ull << 30;
  const auto outcome_with = [&](std::size_t bytes) {
    return outcome_of([=](int) { return std::string(bytes, 'x').substr(0, 10); }, options).end;
  };
  CHECK(outcome_with(std::size_t{1} << 28) == ChildEnd::Finished);
  CHECK(outcome_with(std::size_t{1} << 31) == ChildEnd::OutOfMemory);
  ::munmap(reserved, kBytes);
}

TEST_CASE("a busy child is killed after its processor time, one that sleeps is not") {
  ChildOptions options;
  options.seconds = 60;
  options.processor_seconds = 0.1;
  // Threads that are not to answer signals block them.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const ChildOutcome busy = outcome_of(
      [](int) -> std::string {
        std::atomic<int> i{0};
        while (true) ++i;
      },
      options);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  CHECK(busy.end == ChildEnd::TimedOut);
  CHECK(busy.seconds < 50);  // the limit of wall clock did not end it
  const ChildOutcome asleep = outcome_of(
      [](int) -> std::string {
        ::usleep(300'000);
        return "awake";
      },
      options);
  CHECK(asleep.bytes == "awake");
}

TEST_CASE("a child has ended though another process holds its pipe open") {
  ChildOptions options;
  options.seconds = 20;
  const ChildOutcome out = outcome_of(
      [](int) -> std::string {
        if (::fork() == 0) {
          // Whoever reads what the test says waits for the end of all who could say more.
          ::close(STDOUT_FILENO);
          ::close(STDERR_FILENO);
          ::sleep(30);
          ::_exit(0);
        }
        return "done";
      },
      options);
  CHECK(out.end == ChildEnd::Finished);
  CHECK(out.bytes == "done");
}

TEST_CASE("a child that hangs, busy or asleep, is killed at its time limit") {
  ChildOptions options;
  options.seconds = 0.2;
  const ChildOutcome busy = outcome_of(
      [](int) -> std::string {
        std::atomic<int> i{0};
        while (true) ++i;
      },
      options);
  CHECK(busy.end == ChildEnd::TimedOut);
  const ChildOutcome asleep = outcome_of(
      [](int) -> std::string {
        ::sleep(1000);
        return "";
      },
      options);
  CHECK(asleep.end == ChildEnd::TimedOut);
}

TEST_CASE("a pause of all processes counts for no time limit") {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    ::setpgid(0, 0);
    ChildOptions options;
    options.seconds = 2;
    int code = 1;
    const auto work = [&](int) -> std::string {
      (void)!::write(ends[1], "x", 1);
      for (int i = 0; i < 50; ++i) ::usleep(10'000);
      return "done";
    };
    run_in_children(1, options, work, [&](int, const ChildOutcome& outcome) {
      const bool is_right = outcome.end == ChildEnd::Finished && outcome.seconds < 2;
      code = is_right ? 0 : 1;
    });
    ::_exit(code);
  }
  char byte = 0;
  REQUIRE(::read(ends[0], &byte, 1) == 1);
  ::kill(-parent, SIGSTOP);
  ::sleep(4);
  ::kill(-parent, SIGCONT);
  int status = 0;
  ::waitpid(parent, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  for (const int end : ends) ::close(end);
}

TEST_CASE("a stop kills the running children and reports none of them") {
  std::atomic<bool> interrupted{false};
  ChildOptions options;
  options.jobs = 2;
  options.stop.interrupted = &interrupted;
  const int reported = run_in_children(
      10, options,
      [](int i) -> std::string {
        if (i > 0) ::sleep(1000);
        return "first";
      },
      [&](int i, const ChildOutcome&) {
        CHECK(i == 0);
        interrupted = true;
      });
  CHECK(reported == 1);
}

TEST_CASE("an exception of the caller's own function comes out, and no child stays behind") {
  CHECK_THROWS_AS(run_in_children(
                      3, {}, [](int) { return std::string(); },
                      [](int, const ChildOutcome&) { throw std::logic_error("stop here"); }),
                  std::logic_error);
}

TEST_CASE("a piece of work that is refused before its child begins ends the run after the others") {
  ChildOptions options;
  options.jobs = 2;
  options.before = [](int i) {
    if (i == 3) throw std::logic_error("not this one");
  };
  std::set<int> seen;
  const auto work = [](int i) {
    ::usleep(i == 1 ? 300'000 : 0);
    return std::to_string(i);
  };
  CHECK_THROWS_AS(run_in_children(5, options, work,
                                  [&](int i, const ChildOutcome& outcome) {
                                    seen.insert(i);
                                    CHECK(outcome.bytes == std::to_string(i));
                                  }),
                  std::logic_error);
  CHECK(seen == std::set<int>{0, 1, 2});
}

TEST_CASE("a SIGTERM to a child is the parent's to answer") {
  const ChildOutcome out = outcome_of([](int) -> std::string {
    std::raise(SIGTERM);
    return "alive";
  });
  CHECK(out.end == ChildEnd::Finished);
  CHECK(out.bytes == "alive");
}

TEST_CASE("children end with a parent that is killed") {
  // The child keeps one end of a pipe: its other end reads the end of file when the child is dead.
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    ::close(ends[0]);
    const auto work = [&](int) -> std::string {
      (void)!::write(ends[1], "x", 1);
      ::sleep(1000);
      return "";
    };
    run_in_children(1, {}, work, [](int, const ChildOutcome&) {});
    ::_exit(0);
  }
  ::close(ends[1]);
  char byte = 0;
  REQUIRE(::read(ends[0], &byte, 1) == 1);
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  pollfd polled{ends[0], POLLIN, 0};
  CHECK(::poll(&polled, 1, 5000) == 1);  // ms
  ::close(ends[0]);
}

}  // namespace stillbase
