// A configuration beside those that the search found, with everything that a plan states about it.
#pragma once

#include <vector>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

struct CertifiedCandidate {
  Candidate candidate;
  Certificate certificate;
  std::vector<ConstraintValue> constraints;
};

/// Evaluates and certifies the configuration of the variables x.
/// @param problem as it is at the contact
/// @param candidate, certificate of the candidate that it replaces or stands beside; what does not
///   depend on the configuration is kept
CertifiedCandidate certify_candidate(const CaptureProblem& problem, const Eigen::VectorXd& x,
                                     const Candidate& candidate, const Certificate& certificate);

}  // namespace stillbase
