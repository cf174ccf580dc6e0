#include <stillbase/core/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace stillbase {

namespace {

/// The next index for whoever asks, and what was worked on in order.
class IndexQueue {
 public:
  IndexQueue(int count, const StopCondition& stop, const std::function<void(int)>& work,
             const std::function<void(int)>& take)
      : stop_(stop),
        work_(work),
        take_(take),
        states_(static_cast<std::size_t>(std::max(count, 0)), State::Waiting) {}

  void run() {
    while (!failed_ && !stop_.reached()) {
      const std::size_t i = next_++;
      if (i >= states_.size()) return;
      std::exception_ptr failure;
      try {
        work_(static_cast<int>(i));
      } catch (...) {
        failure = std::current_exception();
        failed_ = true;
      }
      const std::lock_guard lock(mutex_);
      states_[i] = failure ? State::Failed : State::Done;
      if (failure && i < failed_at_) {
        failure_ = failure;
        failed_at_ = i;
      }
      take_what_is_done();
    }
  }

  /// Indices are handed out in order, and each that was is worked on: of what failed nothing lower
  /// is missing.
  int taken() const {
    if (failure_) std::rethrow_exception(failure_);
    return static_cast<int>(taken_);
  }

 private:
  enum class State : char { Waiting, Done, Failed };

  void take_what_is_done() {
    for (; taken_ < states_.size() && states_[taken_] == State::Done; ++taken_) {
      if (!take_) continue;
      try {
        take_(static_cast<int>(taken_));
      } catch (...) {
        states_[taken_] = State::Failed;
        failure_ = std::current_exception();
        failed_at_ = taken_;
        failed_ = true;
        return;
      }
    }
  }

  const StopCondition stop_;
  const std::function<void(int)>& work_;
  const std::function<void(int)>& take_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  // of what follows
  std::vector<State> states_;
  std::size_t taken_ = 0;
  std::exception_ptr failure_;
  std::size_t failed_at_ = static_cast<std::size_t>(-1);
};

}  // namespace

int processor_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

int for_each_index(int jobs, int count, const StopCondition& stop,
                   const std::function<void(int)>& work, const std::function<void(int)>& take) {
  IndexQueue queue(count, stop, work, take);
  {
    std::vector<std::jthread> helpers;
    try {
      for (int i = 1; i < std::min(jobs, count); ++i) {
        helpers.emplace_back([&queue] { queue.run(); });
      }
    } catch (const std::system_error&) {
      // No more threads to be had: the result does not depend on their number.
    }
    queue.run();
  }
  return queue.taken();
}

}  // namespace stillbase
