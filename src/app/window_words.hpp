// The contact windows of a problem as table, CSV and plot.
#pragma once

#include <optional>
#include <string>

#include <stillbase/plan/problem.hpp>

namespace stillbase::app {

/// When each contact feature faces the base and closes in, one line each; empty for a problem whose
/// impulse does not follow from the target's motion.
std::string window_words(const CaptureProblem& problem);

struct NamedWindow {
  std::string feature;
  double from = 0, to = 0;  ///< s
};
/// The first contact window of a feature of `variables.feature` that ends after this time, s; empty
/// also where none is computed.
std::optional<NamedWindow> next_contact_window(const CaptureProblem& problem, double time);
/// Whether no feature of `variables.feature` closes in during `variables.contact_time`: a hand at
/// rest is met by none, wherever it is.
bool always_recedes(const CaptureProblem& problem);

/// Closing speed, facing angle and distance of every feature over time.
/// @throws CommandLineError for a problem whose impulse does not follow from the target's motion
std::string window_csv(const CaptureProblem& problem);
/// The same as two panels over time.
std::string window_svg(const CaptureProblem& problem);

}  // namespace stillbase::app
