// stillbase plan --pareto: two quantities against each other instead of a plan.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>

#include "app/tool.hpp"

namespace stillbase::app {

/// @param quantities two of the objective's quantities, "A,B"
/// @return the exit code
/// @throws CommandLineError for other words, or another extension of the file than .json, .csv,
/// .svg
int run_pareto(const CaptureProblem& problem, const std::string& quantities, double time_limit,
               const OutputFile& output, bool json);

}  // namespace stillbase::app
