// Solutions of which one joint may have any angle.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// The joint whose angle is free: of a curve that states two ends, of a continuous joint also the
/// middle between them, and whose points differ in that joint alone. Nothing depends on its angle.
/// Empty: of other curves.
std::optional<int> free_joint(const SolutionFamily& family);

/// Removes the curves of a free joint that no candidate is on, and numbers the others anew.
void drop_unlisted_rolls(std::vector<Candidate>& candidates, std::vector<SolutionFamily>& families);

}  // namespace stillbase
