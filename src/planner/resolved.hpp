// A configuration that did not come out of the search, with all that a plan says about it.
#pragma once

#include <vector>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

struct Resolved {
  Candidate candidate;
  Certificate certificate;
  std::vector<ConstraintValue> constraints;
};

/// Evaluated and certified as what it is.
/// @param problem as it is at the contact; @param x variables
/// @param candidate, certificate what else is kept of the candidate that it stands for or beside
Resolved resolve(const CaptureProblem& problem, const Eigen::VectorXd& x,
                 const Candidate& candidate, const Certificate& certificate);

}  // namespace stillbase
