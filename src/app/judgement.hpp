// What `verify` and `audit` share: checks of a plan's inputs, and printing.
#pragma once

#include <string>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase::app {

/// Puts the checks of fingerprints and input files first.
/// @param problem_path problem file of the plan; empty: the one that the plan names
void add_input_checks(const PlanFile& file, const std::string& plan_path,
                      const std::string& problem_path, Verification& verification);

/// The problem, and the checks by group, one line each.
void print_checks(const Plan& plan, const Verification& verification);

/// One line: whether all checks hold, and how many could not be made.
/// @param what kind of the checks
void print_verdict(const Verification& verification, const std::string& what);

}  // namespace stillbase::app
