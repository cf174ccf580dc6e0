// Ctrl-C and deadlines, asked for by everything that runs long.
#pragma once

#include <atomic>
#include <chrono>

namespace stillbase {

/// s, a year: beyond it the clock's arithmetic could overflow.
inline constexpr double kLongestTimeLimit = 3e7;

/// When to stop. Copied by value; the flag belongs to the caller and may be null.
struct StopCondition {
  using Clock = std::chrono::steady_clock;
  const std::atomic<bool>* interrupted = nullptr;  ///< set by a signal handler
  Clock::time_point deadline = Clock::time_point::max();

  /// @param seconds >= 0 from now on; from kLongestTimeLimit on there is no deadline
  void set_deadline_after(double seconds) {
    if (!(seconds < kLongestTimeLimit)) return;
    deadline = Clock::now() +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  bool is_interrupted() const { return interrupted != nullptr && interrupted->load(); }
  bool is_late() const { return deadline != Clock::time_point::max() && Clock::now() >= deadline; }
  bool reached() const { return is_interrupted() || is_late(); }
};

}  // namespace stillbase
