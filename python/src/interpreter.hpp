// The lock of the interpreter, given up and taken, and calls of Python with it. Where the
// interpreter ends, Python unwinds the stack of a daemon thread that asks for the lock
// (pthread_exit), through destructors that may not throw and objects that may only be dropped with
// the lock. Such a thread stands still here until the process is gone, as it does from Python 3.14
// on.
#pragma once

#include <chrono>
#include <optional>
#include <thread>

#include <cxxabi.h>
#include <pybind11/pybind11.h>

namespace stillbase::python {

/// Calls what may ask for the lock. No object of Python may be dropped while it is unwound.
template <class Function>
auto stand_still_at_exit(const Function& function) {
  try {
    return function();
  } catch (const abi::__forced_unwind&) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
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
    stand_still_at_exit([this] { PyEval_RestoreThread(state_); });
  }

  PyThreadState* state_;
};

/// Calls a function with the lock, from any thread.
template <class Function>
auto with_interpreter(const Function& function) {
  std::optional<pybind11::gil_scoped_acquire> lock;
  stand_still_at_exit([&lock] { lock.emplace(); });
  return function();
}

/// Calls a function of Python, with the lock. @throws pybind11::error_already_set what it raises
inline pybind11::object call(const pybind11::object& function, const pybind11::tuple& arguments) {
  PyObject* const result =
      stand_still_at_exit([&] { return PyObject_CallObject(function.ptr(), arguments.ptr()); });
  if (result == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::object>(result);
}

}  // namespace stillbase::python
