// The normalised copy of a problem.
#pragma once

#include <stillbase/plan/problem.hpp>

#include "io/json.hpp"

namespace stillbase::io {

/// Every field of the problem in the order of the file format.
Json problem_json(const CaptureProblem& problem);

}  // namespace stillbase::io
