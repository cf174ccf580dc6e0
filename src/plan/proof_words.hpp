// Words of a problem in statements of proofs.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// Begins the statement of a proof that was not tried for want of a prover.
inline constexpr const char* kNothingProven = "no proof: nothing was proven";
/// The statement where a function of the user is part of the problem.
inline constexpr const char* kUserFunctionsNotEnclosed =
    "no proof: functions of the user are not enclosed";

/// "a worst case", "a predicted base_angular_momentum", ...
std::string measure_name(const CaptureProblem& problem);

}  // namespace stillbase
