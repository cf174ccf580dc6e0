// Robots of the simulation tests, written down from their published numbers or drawn at random.
#pragma once

#include <stillbase/core/random.hpp>
#include <stillbase/robot/robot_model.hpp>
#include <stillbase/simulation/plant.hpp>

namespace stillbase::test {

/// The paper's example, Table I. Reading 'A': joint 1 at (1.4, 0), 'B': at (1.4, 1.2). Out-of-plane
/// inertias are free (nothing planar depends on them).
RobotModel planar_two_link(char reading);

/// Redundant planar arm (Vyas et al. 2022): base 100 kg, three links.
RobotModel planar_three_link();

/// The example arm of SPART: rank 2 of the angular coupling matrix in every posture.
RobotModel spart_3dof();

/// A tree of n joints without limits; bodies of 1 to 10 kg. Every third joint is prismatic when
/// asked for: they fly off in free motion, so the tests choose.
RobotModel random_robot(Random& random, int n, bool prismatic);

/// Random attitude and posture, rates up to `rate`.
PlantState random_state(Random& random, int n, double rate);

inline constexpr double kDegree = 3.14159265358979323846 / 180;

}  // namespace stillbase::test
