// Results of long calls.
#pragma once

#include <memory>

#include <stillbase/io/plan_file.hpp>

#include "convert.hpp"
#include "objects.hpp"

namespace stillbase::python {

struct PlanResult {
  PlanFile file;
  std::shared_ptr<Problem> problem;  ///< with the user's functions where it was planned here
};

/// @param problem empty: that of the plan file
std::shared_ptr<PlanResult> make_plan_result(PlanFile file,
                                             std::shared_ptr<Problem> problem = nullptr);

/// R_NB of each element as [w, x, y, z], (k, 4): Eigen keeps w last, so they are copied.
template <class T, class GetPose>
py::array quaternions_of(const std::vector<T>& list, const GetPose& pose_of) {
  py::array_t<double> out({list.size(), std::size_t{4}});
  double* at = out.mutable_data();
  for (const T& item : list) {
    const Eigen::Quaterniond& q = pose_of(item).orientation;
    for (const double x : {q.w(), q.x(), q.y(), q.z()}) *at++ = x;
  }
  return out;
}

}  // namespace stillbase::python
