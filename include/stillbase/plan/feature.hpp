// The contact feature of a capture problem.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// The contact feature that the problem names.
/// @pre the problem has a target with that feature (the reader has checked it)
const ContactFeature& chosen_feature(const CaptureProblem& problem);

/// The problem with this contact feature chosen; unchanged for an empty name.
CaptureProblem at_feature(CaptureProblem problem, const std::string& feature);

}  // namespace stillbase
