// The roll of the last joint about the hand's axis, where nothing depends on it: solutions that
// differ in it alone are one.
#pragma once

#include <functional>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/plan/free_roll.hpp>

#include "search/solution.hpp"

namespace stillbase {

struct RollOptions {
  int angles = 16;           ///< evenly over the range, at which all constraints have to hold
  int measured = 4;          ///< of them, evenly, at which the measure is evaluated
  double same = 1e-8;        ///< values over the objective's typical size
  double same_other = 1e-4;  ///< distance of the other variables of solutions that are one
};

/// Ends of the angle of the joint that carries the hand, where objective and measure stay the same
/// and all constraints hold from one end to the other: its limits with their margin; of a
/// continuous joint a whole turn.
/// @param value of the measure at x, 1/2 |y|^2 in typical sizes; empty: it is the nominal one
/// @param jobs threads; several may then call value()
/// @return a curve with the two ends (and the middle of a turn); empty: the angle is not free
std::optional<SolutionFamily> roll_through(
    const CaptureProblem& problem, const Formulation& formulation, const Eigen::VectorXd& x,
    const std::function<double(const Eigen::VectorXd&)>& value, int jobs,
    const RollOptions& options = {});

/// Puts one solution in place of all that differ in a free roll alone, and its roll behind
/// `families`. The one that stays has the start posture's angle, or the nearest one within the
/// range at which it touches nothing; where there is none, its best member's.
/// @param is_free whether a configuration touches nothing; may be empty
/// @param jobs as roll_through()
void join_rolls(const CaptureProblem& problem, const Formulation& formulation,
                const std::function<double(const Eigen::VectorXd&)>& value,
                const std::function<bool(const Configuration&)>& is_free, const StopCondition& stop,
                int jobs, std::vector<Solution>& solutions, std::vector<SolutionFamily>& families,
                const RollOptions& options = {});

}  // namespace stillbase
