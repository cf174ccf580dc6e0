#include "app/interruption.hpp"

#include <atomic>
#include <chrono>
#include <csignal>

#include "app/exit_code.hpp"

namespace stillbase::app {

namespace {

std::atomic<bool> interrupted{false};
std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

void on_signal(int number) {
  received = number;
  interrupted = true;
}

}  // namespace

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

StopCondition stop_condition(double time_limit) {
  StopCondition stop;
  stop.interrupted = &interrupted;
  // Beyond a year the clock's arithmetic could overflow: no limit.
  if (time_limit > 0 && time_limit < 3e7) {
    stop.deadline =
        StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                          std::chrono::duration<double>(time_limit));
  }
  return stop;
}

int signal_exit_code() {
  const int number = received;
  return number == 0 ? 0 : kSignalBase + number;
}

}  // namespace stillbase::app
