// The samples of an approach as named columns.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <stillbase/export/export.hpp>

namespace stillbase {

/// A quantity of the samples: names of its components with unit and frame, and their values.
struct SampleColumns {
  std::string name;                 ///< "base_position"
  std::string unit, frame;          ///< frame empty: none
  std::vector<std::string> labels;  ///< of the components, without the unit
  std::vector<std::string> units;   ///< of each component, "rad"
  std::function<Eigen::VectorXd(const TrajectorySample&)> values;
};

/// In the order of the files. Those of the target only where there is one.
std::vector<SampleColumns> sample_columns(const Plan& plan);

}  // namespace stillbase
