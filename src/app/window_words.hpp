// The contact windows of a problem as table, CSV and plot.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>

namespace stillbase::app {

/// When each contact feature faces the base and closes in, one line each; empty for a problem whose
/// impulse does not follow from the target's motion.
std::string window_words(const CaptureProblem& problem);

/// Closing speed, facing angle and distance of every feature over time.
/// @throws CommandLineError for a problem whose impulse does not follow from the target's motion
std::string window_csv(const CaptureProblem& problem);
/// The same as two panels over time.
std::string window_svg(const CaptureProblem& problem);

}  // namespace stillbase::app
