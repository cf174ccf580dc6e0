// Normal numbers by both of Box and Muller's formulas: half the work of as many Random::normal().
#pragma once

#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>

namespace stillbase {

/// Adds to each value a number of mean 0 and this standard deviation. Draws nothing for none.
template <class Vector>
void add_normals(Random& random, double deviation, Vector&& values) {
  if (deviation == 0) return;
  for (Eigen::Index i = 0; i < values.size(); i += 2) {
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));  // 1 - u is in (0, 1]
    const double angle = 2 * kPi * random.uniform();
    values[i] += deviation * radius * std::cos(angle);
    if (i + 1 < values.size()) values[i + 1] += deviation * radius * std::sin(angle);
  }
}

}  // namespace stillbase
