// Resistance of the joints drawn at random: free, with added inertia, or locked.
#pragma once

#include <stillbase/core/random.hpp>
#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

inline ImpactResistance random_resistance(Random& random, int n) {
  ImpactResistance resistance{JointVectord::Zero(n), {}};
  const int kind = random.index(3);
  for (int k = 0; k < n; ++k) {
    if (kind == 1) resistance.added_inertia[k] = random.uniform(0, 1);
    if (kind == 2) resistance.locked.push_back(random.index(2) == 1);
  }
  return resistance;
}

}  // namespace stillbase
