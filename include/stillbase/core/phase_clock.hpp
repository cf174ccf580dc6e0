// Where the time of a long run goes: seconds by phase.
#pragma once

#include <chrono>
#include <ctime>
#include <map>
#include <string>

namespace stillbase {

/// Seconds by the name of a phase. While one phase is within another only the inner one counts, so
/// that phases add up to the time between the first and the last of them. For the thread that leads
/// the work: helpers enter no phases, their processor time counts where the leader is.
class PhaseClock {
 public:
  struct Seconds {
    double wall = 0;
    double processor = 0;  ///< of all threads of the process
  };

  /// From construction to destruction. A null clock measures nothing.
  class [[nodiscard]] Phase {
   public:
    Phase(PhaseClock* clock, const char* name)
        : clock_(clock), outer_(clock == nullptr ? nullptr : clock->name_) {
      if (clock_ != nullptr) clock_->go_on_with(name);
    }
    ~Phase() {
      if (clock_ != nullptr) clock_->go_on_with(outer_);
    }
    Phase(const Phase&) = delete;
    Phase& operator=(const Phase&) = delete;

   private:
    PhaseClock* clock_;
    const char* outer_;
  };

  /// Adds what was measured elsewhere.
  void add(const std::string& name, const Seconds& further) {
    Seconds& seconds = seconds_[name];
    seconds.wall += further.wall;
    seconds.processor += further.processor;
  }
  /// Of the phases that have ended, and of open ones up to the last change.
  const std::map<std::string, Seconds>& seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// @param name null: no phase
  void go_on_with(const char* name) {
    const Clock::time_point wall = Clock::now();
    const std::clock_t processor = std::clock();
    if (name_ != nullptr) {
      Seconds& seconds = seconds_[name_];
      seconds.wall += std::chrono::duration<double>(wall - wall_).count();
      seconds.processor += static_cast<double>(processor - processor_) / CLOCKS_PER_SEC;
    }
    name_ = name;
    wall_ = wall;
    processor_ = processor;
  }

  const char* name_ = nullptr;
  Clock::time_point wall_;
  std::clock_t processor_ = 0;
  std::map<std::string, Seconds> seconds_;
};

}  // namespace stillbase
