// Is the search record of a plan right? The audit judges what a plan states beside its chosen
// configuration: candidates, continua of solutions, enclosures and bounds, counts of the search.
//
// Like `verification`, it recomputes by `reference` and calls no function of the planner. It
// repeats a stated proof where the program has proofs; a search of its own, from other starts,
// looks for what the proof may have missed.
#pragma once

#include <stillbase/verification/verification.hpp>

namespace stillbase {

/// Audits the search record of a plan. The checks are of the groups Audit and SearchRecord,
/// and of the group Inputs, which the audit needs as well. Never throws for what a plan says: a
/// check that cannot be evaluated fails, with the reason in its detail.
[[nodiscard]] Verification audit_plan(const Plan& plan, const VerifyOptions& options = {});

/// Verification and audit of a plan in one list: verify_plan(), then the checks that audit_plan()
/// adds.
[[nodiscard]] Verification judge_plan(const Plan& plan, const VerifyOptions& options = {});

}  // namespace stillbase
