// What a verification says against a plan, for tests that spoil plans.
#pragma once

#include <string>

#include <stillbase/audit/audit.hpp>

namespace stillbase {

/// Names of the claims that fail, each followed by a space; the time after the impact is left out.
inline std::string failures(const Plan& plan) {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 200;
  std::string names;
  for (const Claim& claim : judge_plan(plan, options).claims) {
    if (!claim.pass) names += claim.name + " ";
  }
  return names;
}

}  // namespace stillbase
