// The self-motion at the contact: other postures that hold the hand as well.
#pragma once

#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

/// How good a candidate is, in the order of the search: the measure, or for the predicted value
/// alone its worst case.
double rank_of(const CaptureProblem& problem, const Candidate& candidate);

/// Whether a candidate is at most `factor` times as bad as the best one, by both numbers that rank
/// it.
bool is_good(const CaptureProblem& problem, const Candidate& candidate, const Candidate& best,
             double factor);

/// Points on the self-motion: from each given one a walk in a random direction that keeps all
/// constraints (where the objective vanishes: that, too), as long as the objective stays within
/// `factor` of that of `best`. Constraints hold to 1e-9. Points nearer than 0.2 rad to each other
/// or to `from` are left out.
/// @param from variables to begin with, in turn; @param count walks; 0: none
std::vector<Eigen::VectorXd> self_motion_samples(const CaptureProblem& problem,
                                                 const Formulation& formulation,
                                                 const std::vector<Eigen::VectorXd>& from,
                                                 const Candidate& best, double factor, int count,
                                                 const StopCondition& stop);

}  // namespace stillbase
