// What the planner's tolerance leaves of an enclosed solution.
#pragma once

#include <vector>

#include "proof/zero_problem.hpp"

namespace stillbase::proof {

/// Boxes that hold every configuration which the planner takes for one of the enclosed solutions:
/// its constraints leave a residual, and nearly double solutions move far for it.
/// @param solutions each with exactly one solution of the problem's equations
/// @return one per solution; empty where one is too near to others
std::vector<JointBox> reach_of_solutions(const ZeroProblem& problem,
                                         const std::vector<JointBox>& solutions);

}  // namespace stillbase::proof
