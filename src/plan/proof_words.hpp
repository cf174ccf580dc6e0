// Words of a problem in statements of proofs.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// "a worst case", "a predicted base_angular_momentum", ...
std::string measure_name(const CaptureProblem& problem);

/// Limits that a proof leaves out, of the posture at the contact: "joint rates", ...
std::vector<std::string> uncounted_limits(const CaptureProblem& problem);

}  // namespace stillbase
