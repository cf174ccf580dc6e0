// The inequalities of a case problem over a box.
#pragma once

#include <span>

#include "proof/zero_problem.hpp"

namespace stillbase::proof {

enum class Kept { Yes, No, Open };

/// Whether the side conditions hold at every point of a box (Yes), at none (No).
/// @param x values of the variables over the box
Kept keeps_side_conditions(const ZeroProblem& problem, std::span<const Dual> x);

}  // namespace stillbase::proof
