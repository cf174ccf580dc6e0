// Benchmark suites (`format: stillbase.suite`): bench/suite.yaml is the shipped one.
#pragma once

#include <string>

#include <stillbase/benchmark/suite.hpp>

namespace stillbase {

/// Reads a suite with the problem files that it names; their paths are relative to the suite's.
/// Strict as read_problem().
/// @throws InputError, FileError
SuiteSpec read_suite(const std::string& path);

}  // namespace stillbase
