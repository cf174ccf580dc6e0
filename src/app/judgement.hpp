// What `verify` and `audit` share: checks of a plan's inputs, and printing.
#pragma once

#include <string>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/verification/verification.hpp>

#include "app/tool.hpp"

namespace stillbase::app {

/// Puts the checks of fingerprints and input files first.
/// @param problem_path problem file of the plan; empty: the one that the plan names
void add_input_checks(const PlanFile& file, const std::string& plan_path,
                      const std::string& problem_path, Verification& verification);

/// Writes the verification file, and prints the problem, the checks by group, what the controllers
/// do, and whether all checks hold and how many could not be made.
/// @param as_json on stdout also beside a file
/// @param what kind of the checks
void publish_verification(const Plan& plan, const Verification& verification,
                          const std::string& text, const OutputFile& output, bool as_json,
                          const std::string& what);

}  // namespace stillbase::app
