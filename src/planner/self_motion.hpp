// The self-motion at the contact: other postures with the same hand pose.
#pragma once

#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/planner/planner.hpp>

namespace stillbase {

/// What ranks a candidate: the measure, or the worst case over the cone where the measure is the
/// nominal value. Smaller is better.
double rank_of(const CaptureProblem& problem, const Candidate& candidate);

/// Ranks up to this are zeros, which differ by rounding alone.
constexpr double kZeroRank = 1e-9;

/// Whether value and rank of a candidate are at most `factor` times those of the best one.
bool is_good(const CaptureProblem& problem, const Candidate& candidate, const Candidate& best,
             double factor);

/// Points on the self-motion at the contact. Each is the end of a walk in a random direction that
/// keeps all constraints to 1e-9, a vanishing objective included, as long as the objective stays
/// within `factor` of that of `best`. Points near each other or near `from` are left out.
/// @param from variables at which the walks begin, one after the other
/// @param count number of walks
std::vector<Eigen::VectorXd> self_motion_samples(const CaptureProblem& problem,
                                                 const Formulation& formulation,
                                                 const std::vector<Eigen::VectorXd>& from,
                                                 const Candidate& best, double factor, int count,
                                                 const StopCondition& stop,
                                                 const SelfMotionOptions& options = {});

}  // namespace stillbase
