#include "io/json_problem.hpp"

#include <stillbase/io/problem_file.hpp>

#include "io/fields/sections.hpp"

namespace stillbase {

namespace io {

Json problem_json(const CaptureProblem& problem) {
  CaptureProblem copy = problem;  // tables name fields of data that may change
  TableWriter writer;
  problem_fields(writer, copy, {});
  return writer.json;
}

}  // namespace io

std::string problem_to_json(const CaptureProblem& problem) {
  return io::pretty(io::problem_json(problem));
}

}  // namespace stillbase
