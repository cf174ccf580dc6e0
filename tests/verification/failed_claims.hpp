// Failed checks of a verification, for tests that alter plans.
#pragma once

#include <string>

#include <stillbase/audit/audit.hpp>

namespace stillbase {

/// Names of the checks that fail, each followed by a space; without those of the time after the
/// impact.
inline std::string failures(const Plan& plan) {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 200;
  options.prover = nullptr;
  std::string names;
  for (const Claim& claim : judge_plan(plan, options).claims) {
    if (claim.fails()) names += claim.name + " ";
  }
  return names;
}

}  // namespace stillbase
