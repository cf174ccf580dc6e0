#include <stillbase/core/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <condition_variable>
#include <exception>
#include <mutex>
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

class ThreadCrew::Threads {
 public:
  explicit Threads(int most) : most_(static_cast<std::size_t>(std::max(most, 0))) {
    threads_.reserve(most_);
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;
  ~Threads() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    has_work_.notify_all();
  }

  /// Calls `work`, which does not throw, on this thread and on up to `helpers` others.
  void run(const std::function<void()>& work, int helpers) {
    Job job{work, helpers, std::fegetround()};
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(&job);
      begin_threads();
      if (is_caller_free_) is_left_.notify_all();
    }
    for (int i = 0; i < helpers; ++i) has_work_.notify_one();
    const bool is_outermost = depth == 0;
    ++depth;
    work();
    --depth;
    std::unique_lock lock(mutex_);
    jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
    while (job.helped_by > 0) {
      // Within another call the thread may hold what the other work waits for.
      const auto other = is_outermost ? wanted_job() : jobs_.end();
      if (other != jobs_.end()) {
        help_with(**other, lock);
        std::fesetround(job.rounding);
      } else {
        if (is_outermost) is_caller_free_ = true;
        is_left_.wait(lock);
        if (is_outermost) is_caller_free_ = false;
      }
    }
  }

  /// That of the calling thread; null: none.
  static thread_local Threads* here;
  /// Calls of work() that the calling thread is in.
  static thread_local int depth;

 private:
  struct Job {
    const std::function<void()>& work;
    int wanted;    ///< helpers that have not come yet
    int rounding;  ///< of the thread whose job it is
    int helped_by = 0;
  };

  /// As many as are wanted and idle ones do not do.
  void begin_threads() {
    int wanted = 0;
    for (const Job* job : jobs_) wanted += job->wanted;
    try {
      for (; wanted > idle_ && threads_.size() < most_; ++idle_) {
        threads_.emplace_back([this] { help(); });
      }
    } catch (const std::exception&) {  // system_error, bad_alloc
      // No more threads to be had: the result does not depend on their number.
    }
  }

  std::vector<Job*>::iterator wanted_job() {
    return std::find_if(jobs_.begin(), jobs_.end(), [](const Job* j) { return j->wanted > 0; });
  }

  void help_with(Job& job, std::unique_lock<std::mutex>& lock) {
    --job.wanted;
    ++job.helped_by;
    lock.unlock();
    std::fesetround(job.rounding);
    ++depth;
    job.work();
    --depth;
    lock.lock();
    if (--job.helped_by == 0) is_left_.notify_all();
  }

  void help() {
    here = this;
    std::unique_lock lock(mutex_);
    while (true) {
      has_work_.wait(lock, [this] { return is_over_ || wanted_job() != jobs_.end(); });
      if (is_over_) return;
      --idle_;
      help_with(**wanted_job(), lock);
      ++idle_;
    }
  }

  const std::size_t most_;
  std::mutex mutex_;  // of what follows
  std::condition_variable has_work_, is_left_;
  std::vector<Job*> jobs_;
  int idle_ = 0;                 ///< threads that wait, or are about to
  bool is_caller_free_ = false;  ///< the crew's maker waits for its helpers
  bool is_over_ = false;
  std::vector<std::jthread> threads_;  // the last member: they end first
};

thread_local ThreadCrew::Threads* ThreadCrew::Threads::here = nullptr;
thread_local int ThreadCrew::Threads::depth = 0;

ThreadCrew::ThreadCrew(int jobs) {
  if (jobs <= 1 || Threads::here != nullptr) return;
  threads_ = std::make_unique<Threads>(jobs - 1);
  Threads::here = threads_.get();
}

ThreadCrew::~ThreadCrew() {
  if (threads_) Threads::here = nullptr;
}

int processor_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

int for_each_index(int jobs, int count, const StopCondition& stop,
                   const std::function<void(int)>& work, const std::function<void(int)>& take) {
  IndexQueue queue(count, stop, work, take);
  const int helpers = std::min(jobs, count) - 1;
  if (helpers > 0) {
    const ThreadCrew crew(jobs);
    ThreadCrew::Threads::here->run([&queue] { queue.run(); }, helpers);
  } else {
    queue.run();
  }
  return queue.taken();
}

}  // namespace stillbase
