#include "long_call.hpp"

#include <cmath>
#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include "interpreter.hpp"

namespace stillbase::python {

namespace {

/// How often signals are looked for: Ctrl-C is answered within a tenth of a second.
constexpr std::chrono::milliseconds kBetweenLooks{50};
/// What an interpreter that ends leaves the calls of daemon threads.
constexpr std::chrono::seconds kToEnd{2};

/// The calls that go on in a process.
class RunningCalls {
 public:
  /// Of this process: a child of fork() has none of its parent's.
  static RunningCalls& here() {
    // Never deleted: daemon threads may outlive static objects.
    static std::atomic<RunningCalls*> current{new RunningCalls};
    RunningCalls* known = current;
    if (known->process_ == getpid()) return *known;
    auto* const fresh = new RunningCalls;
    if (current.compare_exchange_strong(known, fresh)) return *fresh;
    delete fresh;
    return *known;
  }

  void add(std::atomic<bool>& interrupted) {
    const std::lock_guard lock(mutex_);
    if (ending_ && *ending_ != std::this_thread::get_id()) interrupted = true;
    all_.insert(&interrupted);
  }
  void remove(std::atomic<bool>& interrupted) {
    const std::lock_guard lock(mutex_);
    all_.erase(&interrupted);
    changed_.notify_all();
  }
  /// Interrupts all of them, and later ones of other threads, and waits for their end.
  void end() {
    std::unique_lock lock(mutex_);
    ending_ = std::this_thread::get_id();
    for (std::atomic<bool>* interrupted : all_) *interrupted = true;
    changed_.wait_for(lock, kToEnd, [this] { return all_.empty(); });
  }

 private:
  const pid_t process_ = getpid();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::atomic<bool>*> all_;
  std::optional<std::thread::id> ending_;
};

/// One of them.
class RunningCall {
 public:
  explicit RunningCall(std::atomic<bool>& interrupted) : interrupted_(interrupted) {
    calls_.add(interrupted_);
  }
  RunningCall(const RunningCall&) = delete;
  RunningCall& operator=(const RunningCall&) = delete;
  ~RunningCall() { calls_.remove(interrupted_); }

 private:
  RunningCalls& calls_ = RunningCalls::here();
  std::atomic<bool>& interrupted_;
};

}  // namespace

LongCall::LongCall(const std::optional<double>& time_limit) {
  stop_.interrupted = &interrupted_;
  if (!time_limit) return;
  if (!(*time_limit > 0)) throw std::invalid_argument("time_limit: must be > 0 s, or None");
  stop_.set_deadline_after(*time_limit);
}

Progress LongCall::progress(const py::object& function) {
  if (function.is_none()) return {};
  return [this, shared = shared_function(function)](const std::string& what, int done, int total) {
    with_interpreter([&] {
      if (of_python_) return;
      try {
        call(*shared, py::make_tuple(what, done, total));
      } catch (py::error_already_set&) {
        of_python_ = std::current_exception();
        interrupted_ = true;
      }
    });
  };
}

void LongCall::run(const std::function<void()>& work) {
  std::exception_ptr error;
  {
    Unlocked unlocked;
    const RunningCall running(interrupted_);
    std::mutex mutex;
    std::condition_variable changed;
    bool is_done = false;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        error = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      is_done = true;
      changed.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!changed.wait_for(lock, kBetweenLooks, [&] { return is_done; })) {
      lock.unlock();
      unlocked.locked([this] {
        if (stand_still_at_exit(&PyErr_CheckSignals) == 0) return;
        py::error_already_set raised;
        was_key_ = was_key_ || raised.matches(PyExc_KeyboardInterrupt);
        if (!was_key_ && !of_python_) of_python_ = std::make_exception_ptr(raised);
        interrupted_ = true;
      });
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (of_python_) std::rethrow_exception(of_python_);
  if (error) std::rethrow_exception(error);
}

void end_long_calls_at_exit() {
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const Unlocked unlocked;
    RunningCalls::here().end();
  }));
}

py::object LongCall::finish(py::object result) const {
  if (!was_key_) return result;
  const py::object type = py::module_::import("stillbase._errors").attr("Interrupted");
  PyErr_SetObject(type.ptr(), type(result).ptr());
  throw py::error_already_set();
}

std::shared_ptr<py::object> shared_function(py::object function) {
  return {new py::object(std::move(function)), [](py::object* object) {
            with_interpreter([object] {
              PyObject* const held = object->release().ptr();
              delete object;
              stand_still_at_exit([held] { Py_XDECREF(held); });
            });
          }};
}

}  // namespace stillbase::python
