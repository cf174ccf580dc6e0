// The lock of the interpreter, given up and taken. Where the interpreter has ended meanwhile, Python
// unwinds the stack of a daemon thread that asks for the lock (pthread_exit), through destructors
// that may not throw and handlers that may not keep it. Such a thread stands still here until the
// process is gone, as it does from Python 3.14 on.
#pragma once

#include <chrono>
#include <optional>
#include <thread>

#include <cxxabi.h>
#include <pybind11/pybind11.h>

namespace stillbase::python {

[[noreturn]] inline void stand_still() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Gives up the lock until its end: other Python threads run.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;
  ~Unlocked() { lock(); }

  /// Takes the lock for one call in between, of a function that does not throw.
  template <class Function>
  void locked(const Function& function) {
    lock();
    function();
    state_ = PyEval_SaveThread();
  }

 private:
  void lock() {
    try {
      PyEval_RestoreThread(state_);
    } catch (const abi::__forced_unwind&) {
      stand_still();
    }
  }

  PyThreadState* state_;
};

/// Calls a function with the lock, from any thread.
template <class Function>
auto with_interpreter(const Function& function) {
  std::optional<pybind11::gil_scoped_acquire> lock;  // outlives what is unwound
  try {
    lock.emplace();
    return function();
  } catch (const abi::__forced_unwind&) {
    stand_still();
  }
}

}  // namespace stillbase::python
