#include "long_call.hpp"

#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace stillbase::python {

namespace {

/// How often signals are looked for: Ctrl-C is answered within a tenth of a second.
constexpr std::chrono::milliseconds kBetweenLooks{50};
/// A year: beyond it the clock's arithmetic could overflow.
constexpr double kLongest = 3e7;

}  // namespace

LongCall::LongCall(const std::optional<double>& time_limit) {
  stop_.interrupted = &interrupted_;
  if (!time_limit) return;
  if (!(*time_limit > 0)) throw std::invalid_argument("time_limit: must be > 0 s, or None");
  if (*time_limit < kLongest) {
    stop_.deadline =
        StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                          std::chrono::duration<double>(*time_limit));
  }
}

Progress LongCall::progress(const py::object& function) {
  if (function.is_none()) return {};
  return [this, shared = shared_function(function)](const std::string& what, int done, int total) {
    const py::gil_scoped_acquire locked;
    if (of_python_) return;
    try {
      (*shared)(what, done, total);
    } catch (py::error_already_set&) {
      of_python_ = std::current_exception();
      interrupted_ = true;
    }
  };
}

void LongCall::run(const std::function<void()>& work) {
  std::exception_ptr error;
  {
    const py::gil_scoped_release unlocked;
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
      {
        const py::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) {
          py::error_already_set raised;
          was_key_ = was_key_ || raised.matches(PyExc_KeyboardInterrupt);
          if (!was_key_ && !of_python_) of_python_ = std::make_exception_ptr(raised);
          interrupted_ = true;
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (of_python_) std::rethrow_exception(of_python_);
  if (error) std::rethrow_exception(error);
}

py::object LongCall::finish(py::object result) const {
  if (!was_key_) return result;
  const py::object type = py::module_::import("stillbase._errors").attr("Interrupted");
  PyErr_SetObject(type.ptr(), type(result).ptr());
  throw py::error_already_set();
}

std::shared_ptr<py::object> shared_function(py::object function) {
  return {new py::object(std::move(function)), [](py::object* object) {
            const py::gil_scoped_acquire locked;
            delete object;
          }};
}

}  // namespace stillbase::python
