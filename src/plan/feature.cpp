#include <stillbase/plan/feature.hpp>

#include <stdexcept>

namespace stillbase {

const ContactFeature& chosen_feature(const CaptureProblem& problem) {
  for (const ContactFeature& feature : problem.target->features) {
    if (feature.name == problem.variables.feature) return feature;
  }
  throw std::logic_error("no contact feature '" + problem.variables.feature + "'");
}

CaptureProblem at_feature(CaptureProblem problem, const std::string& feature) {
  if (!feature.empty()) problem.variables.feature = feature;
  return problem;
}

}  // namespace stillbase
