// Calls that take long: other Python threads run meanwhile, and Ctrl-C ends them.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <pybind11/pybind11.h>

#include <stillbase/core/interrupt.hpp>

namespace stillbase::python {

namespace py = pybind11;

/// Calls a function of Python with what is being done, how much of it is done, and the total.
using Progress = std::function<void(const std::string&, int, int)>;

/// The work of one call, on a thread of its own, while the calling thread waits for signals.
class LongCall {
 public:
  /// @param time_limit s; empty: none @throws std::invalid_argument unless positive and finite
  explicit LongCall(const std::optional<double>& time_limit);

  const StopCondition& stop() const { return stop_; }
  /// What the library calls as work goes on. An exception of the function ends the work.
  /// @param function of Python, or None
  Progress progress(const py::object& function);
  /// Does the work. @throws what it throws, what the progress function raised, and what a signal
  /// handler raised other than KeyboardInterrupt
  template <class Work>
  auto operator()(const Work& work) {
    std::optional<decltype(work())> result;
    run([&] { result.emplace(work()); });
    return std::move(*result);
  }
  /// Ends the call with its result: an Interrupted that holds it after Ctrl-C.
  py::object finish(py::object result) const;

 private:
  void run(const std::function<void()>& work);

  std::atomic<bool> interrupted_{false};
  StopCondition stop_;
  bool was_key_ = false;          ///< Ctrl-C
  std::exception_ptr of_python_;  ///< raised by a progress function or a signal handler
};

/// An interpreter that ends interrupts the calls of daemon threads first.
void end_long_calls_at_exit();

/// A function of Python that threads may copy and drop without the interpreter's lock.
std::shared_ptr<py::object> shared_function(py::object function);

}  // namespace stillbase::python
