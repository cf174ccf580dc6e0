#include "plan/proof_words.hpp"

#include <fmt/format.h>

#include <stillbase/plan/scenario.hpp>

namespace stillbase {

std::string measure_name(const CaptureProblem& problem) {
  const std::string quantity = objective_name(problem);
  switch (problem.measure.kind) {
    case RiskMeasure::Nominal:
      return "a predicted " + quantity;
    case RiskMeasure::WorstCase:
      return "a worst case";
    case RiskMeasure::Expectation:
      return fmt::format("an expected {} ({} samples)", quantity, problem.measure.samples);
    case RiskMeasure::Cvar:
      return fmt::format("a CVaR of {} ({} samples)", quantity, problem.measure.samples);
  }
  return "";
}

}  // namespace stillbase
