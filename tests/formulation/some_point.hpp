// Points of a formulation's variables, one of a low-discrepancy sequence per index.
#pragma once

#include <stillbase/core/random.hpp>
#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

inline Eigen::VectorXd some_point(const Formulation& formulation, int index,
                                  std::uint64_t sequence = 3) {
  return formulation.start_point(
      low_discrepancy_point(index, formulation.num_variables(), sequence));
}

}  // namespace stillbase
