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

std::vector<std::string> uncounted_limits(const CaptureProblem& problem) {
  const ConstraintSpec& limits = problem.constraints;
  std::vector<std::string> out;
  if (limits.joint_rate_scale || limits.joint_rate_max.size() > 0) out.push_back("joint rates");
  if (limits.coupling_singular_value_min > 0 || limits.jacobian_singular_value_min > 0) {
    out.push_back("singular values");
  }
  if (limits.clearance) out.push_back("clearances");
  return out;
}

}  // namespace stillbase
