// What the C interface hides behind its handles, and how exceptions become a status.
#pragma once

#include <stillbase/stillbase.h>

#include <exception>
#include <memory>
#include <string>

#include <stillbase/plan/plan.hpp>
#include <stillbase/planner/replanner.hpp>

struct stillbase_robot {
  stillbase::RobotModel model;
};

struct stillbase_problem {
  stillbase::CaptureProblem data;
};

struct stillbase_plan {
  stillbase::Plan data;
  std::string status, json;
};

struct stillbase_replanner {
  stillbase::Replanner data;
  int joints;
};

namespace stillbase::c {

/// A wrong argument of a C function.
class ArgumentError : public std::exception {
 public:
  explicit ArgumentError(std::string text) : text_(std::move(text)) {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

/// Keeps the text for stillbase_error(). @return the status
stillbase_status fail(stillbase_status status, const char* text) noexcept;
/// The status of the exception that is being handled.
stillbase_status fail_with_current_exception() noexcept;

/// Does the work of a function of the interface; its exceptions become a status.
template <class Work>
stillbase_status guarded(const Work& work) noexcept {
  try {
    work();
    return STILLBASE_OK;
  } catch (...) {
    return fail_with_current_exception();
  }
}

/// @throws ArgumentError for NULL. @param name for the message
template <class T>
T& needed(T* pointer, const char* name) {
  if (pointer == nullptr) throw ArgumentError(std::string(name) + ": is NULL");
  return *pointer;
}

/// `size` finite numbers. @throws ArgumentError
Eigen::Map<const Eigen::VectorXd> numbers(const double* data, Eigen::Index size, const char* name);

/// @throws ArgumentError when an answer is not finite: the numbers given are beyond what can be
/// computed
template <class Matrix>
void demand_finite(const Matrix& answer) {
  if (!answer.allFinite()) {
    throw ArgumentError("the numbers are so large that the answer is not finite");
  }
}

/// Copies to an output of the caller; NULL: it is not wanted.
template <class Vector>
void copy_to(double* out, const Vector& from) {
  if (out != nullptr) Eigen::Map<Eigen::VectorXd>(out, from.size()) = from;
}

/// @throws ArgumentError for numbers that are not finite and a quaternion without unit norm
Configuration configuration_of(const stillbase_contact& contact, const double* phi, int n);
void write_configuration(const Configuration& configuration, stillbase_contact* contact,
                         double* phi);
void write_impact(const ImpactSummary& summary, stillbase_impact* impact, double* Delta_phidot);

}  // namespace stillbase::c
