// The paper's Figs. 6 to 8 of a run.
#pragma once

#include <string>
#include <vector>

#include <stillbase/report/plot.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase::app {

/// Three panels as in the figures: (a) base attitude, (b) momenta, (c) joint rate and its parts. As
/// in the paper they begin 0.1 s before the impact, with the robot at rest; the impact is at t = 0.
/// Attitude and momenta are shown along the axis of the total angular momentum (planar robots: z).
/// @param trace from right after the impact on
std::vector<PlotPanel> figure_panels(const std::string& controller,
                                     const std::vector<TraceSample>& trace);

}  // namespace stillbase::app
