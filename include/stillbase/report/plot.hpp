// Line plots as SVG text: deterministic, self-contained, readable on light and dark pages.
#pragma once

#include <string>
#include <vector>

namespace stillbase {

struct PlotSeries {
  std::string name;                         ///< in the legend
  std::vector<double> y;                    ///< one value per x of the panel; finite
  std::vector<double> low = {}, high = {};  ///< the ends of a band around y; empty: none
};

/// A vertical line with a name, e.g. where a curve crosses zero.
struct PlotMark {
  double x = 0;
  std::string label;
};

struct PlotPanel {
  std::string title;
  std::string x_label, y_label;    ///< with units
  std::vector<double> x;           ///< ascending; finite
  std::vector<PlotSeries> series;  ///< at most 18
  std::vector<PlotMark> marks;
};

/// The panels below each other, with axes, round tick values, a zero line where zero is in range
/// and a legend. Same input, same bytes.
/// @throws std::invalid_argument for series or bands of another length than x, fewer than two
/// points, more than 18 series, or numbers that are not finite
std::string plot_svg(const std::vector<PlotPanel>& panels);

}  // namespace stillbase
