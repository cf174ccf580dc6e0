// Verification files: the verdict on a plan as JSON.
#pragma once

#include <string>

#include <stillbase/verification/verification.hpp>

namespace stillbase {

/// Text of a verification (`format: stillbase.verification`). A claim that could not be evaluated
/// has the value null.
/// @param content_sha256 fingerprint of the plan's content as it was read
/// @throws std::invalid_argument for any other number that is not finite
std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256);

}  // namespace stillbase
