// The same solution held in another way: at another roll of a free last joint, or whole turns away.
// The impact is the same. Distances from joint limits, the path there and what the last body's
// shapes touch may differ.
#pragma once

#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

#include "planner/candidates.hpp"

namespace stillbase {

/// Takes the configuration of each candidate that is the nearest to the start posture, of those
/// whole turns apart. The search states the one in the middle of the joints' limits.
void take_nearest_turns(const CaptureProblem& problem, SearchResult& found);

/// Configurations whole turns away, by the shortest way from the start posture; see other_turns().
std::vector<Configuration> other_turns_of(const CaptureProblem& problem, const SearchResult& found,
                                          std::size_t candidate, std::size_t most);

/// Configurations at the roll of the start posture, and at others evenly over the range of the free
/// joint, the nearest to it first; none of a candidate without a free roll.
std::vector<Configuration> other_rolls_of(const CaptureProblem& problem, const SearchResult& found,
                                          std::size_t candidate, std::size_t most);

/// The variables of a candidate in another form.
Eigen::VectorXd variables_of_form(const CaptureProblem& problem, const SearchResult& found,
                                  std::size_t candidate, const Configuration& form);

/// Whether the masses that a joint turns are the same at each of its angles: it carries one body,
/// which has its centroid on the axis and equal moments about it.
bool turns_like_a_top(const RobotModel& robot, int joint);

/// Puts another form in place of each candidate that touches something or breaks a limit after the
/// impact, where one does neither: the first of at most `other_turns` and `other_rolls`, of at most
/// `max_approaches` candidates. Those behind the first one that does neither stay as they are.
void take_forms_that_hold(const CaptureProblem& problem, const CollisionJudge& collisions,
                          const PlannerOptions& options, AfterImpactJudge& after,
                          SearchResult& found);

}  // namespace stillbase
