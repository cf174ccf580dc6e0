// A search for the solutions of a small problem, apart from the planner's and from its proof:
// Newton by `reference` from evenly spread starts.
#pragma once

#include <string>
#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

struct Recount {
  std::string not_done;  ///< why the problem is none of those; empty: it is
  /// The equations leave freedom, so the objective's zeros were looked for.
  bool asks_for_zero = false;
  std::vector<Configuration> solutions;  ///< distinct; base position as stated
  int starts = 0;
};

/// Configurations within the bounds that meet the hand's equations, the wanted case and the
/// inequalities, limits on rates, singular values and clearances among them, and, where these
/// equations leave freedom, make the objective zero; isolated ones. For problems with one to three
/// variables among joints, base angle about an axis and time.
Recount search_solutions(const Context& context);

/// Whether a configuration is a zero of the predicted objective on a curve of them: the equations
/// leave freedom, and together with the zero one direction. Only what is certain counts, and only
/// objectives of one angular quantity.
bool is_on_curve_of_zeros(const CaptureProblem& problem, const Configuration& at);

/// The hand's distance from its point (3, m) and the sines of the turn of its axes (3), in B; zero
/// where nothing is asked.
Vector6d hand_rows(const CaptureProblem& problem, const ContactEvent& event,
                   const Configuration& at, const reference::Dynamics& dynamics);

/// Closing speed, bounds of the base position, which way the hand faces: with a little to spare.
bool keeps_inequalities(const CaptureProblem& problem, const ContactEvent& event,
                        const Configuration& at, const reference::Dynamics& dynamics);

/// How far the hand is from what is asked of it at a configuration: m, and sines of angles.
double hand_residual(const CaptureProblem& problem, const ContactEvent& event,
                     const Configuration& at, const reference::Dynamics& dynamics);

}  // namespace stillbase::verification
