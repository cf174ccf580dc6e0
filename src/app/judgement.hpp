// What `verify` and `audit` share: checks of a plan's inputs, and printing.
#pragma once

#include <optional>
#include <string>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/verification/verification.hpp>

#include "app/tool.hpp"

namespace stillbase::app {

/// Path of the problem file of a plan: as the user states it, as the plan states it, or beside the
/// plan. Empty: it is not there.
/// @param problem_path what the user states; empty: nothing
std::optional<std::string> problem_file_of(const PlanFile& file, const std::string& plan_path,
                                           const std::string& problem_path);

/// Puts the checks of fingerprints and input files first.
/// @param problem_path problem file of the plan; empty: the one that the plan names
void add_input_checks(const PlanFile& file, const std::string& plan_path,
                      const std::string& problem_path, Verification& verification);

/// Repeats the search of a plan and compares every byte of its content: then what only the search
/// knows holds, or the first parts that differ are named. Not possible for a plan that a limit
/// ended.
/// @param jobs threads, see PlannerOptions
void add_repeated_search(const PlanFile& file, int jobs, Verification& verification);

/// How a verification is published.
struct Publication {
  OutputFile output;
  bool as_json = false;    ///< on stdout also beside a file
  bool shows_all = false;  ///< every check in full; else those that hold as one line per group
  std::string what = {};   ///< kind of the checks
};

/// Writes the verification file and prints the problem, the verdict, the checks that fail or could
/// not be made in full, those that hold by group, those of the search record that are open as one
/// line, and what the controllers do.
void publish_verification(const Plan& plan, const Verification& verification,
                          const std::string& text, const Publication& publication);

}  // namespace stillbase::app
