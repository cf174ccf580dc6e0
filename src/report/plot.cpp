#include <stillbase/report/plot.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "core/escape.hpp"

namespace stillbase {

namespace {

constexpr int kWidth = 760;
constexpr int kPanelHeight = 300;
constexpr int kLeft = 78, kRight = 176, kTop = 34, kBottom = 52;
/// Distinguishable for colour-blind readers (Okabe and Ito, 2008), in this order; further series
/// repeat them with dashes.
const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
const char* kDashes[] = {"", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 3\""};
constexpr std::size_t kMostSeries = std::size(kColours) * std::size(kDashes);
constexpr int kLegendRow = 22;

std::string stroke(std::size_t series) {
  return fmt::format("stroke=\"{}\"{}", kColours[series % std::size(kColours)],
                     kDashes[series / std::size(kColours)]);
}

/// A panel grows with its legend.
int height_of(const PlotPanel& panel) {
  const int legend = kTop + kBottom + kLegendRow * static_cast<int>(panel.series.size());
  return std::max(kPanelHeight, legend);
}

/// Step of 1, 2 or 5 times a power of ten that cuts the range into at most `most` parts.
double tick_step(double range, int most) {
  const double power = std::pow(10, std::floor(std::log10(range / most)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (range / (factor * power) <= most) return factor * power;
  }
  return 10 * power;
}

struct Axis {
  double low, high;  // of the data
  double from, to;   // in pixels
  double pixel(double value) const { return from + (value - low) / (high - low) * (to - from); }
};

std::vector<double> ticks(const Axis& axis, double step) {
  std::vector<double> out;
  for (double k = std::ceil(axis.low / step - 1e-9); k * step <= axis.high + 1e-9 * step; ++k) {
    out.push_back(k == 0 ? 0.0 : k * step);
  }
  return out;
}

/// Angles over 170 deg have ticks at multiples of 30 or 45 deg.
double angle_or_round_step(const PlotPanel& panel, double range) {
  if (panel.x_label.find("deg") != std::string::npos && range > 170) return range > 300 ? 45 : 30;
  return tick_step(range, 8);
}

void check(const PlotPanel& panel) {
  const auto finite = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  if (panel.x.size() < 2 || panel.series.empty() || panel.series.size() > kMostSeries) {
    throw std::invalid_argument("a panel needs two points and one to 18 series");
  }
  bool good = finite(panel.x);
  for (const PlotSeries& series : panel.series) {
    good = good && series.y.size() == panel.x.size() && finite(series.y);
    good = good && series.low.size() == series.high.size() && finite(series.low);
    good =
        good && (series.low.empty() || series.low.size() == panel.x.size()) && finite(series.high);
  }
  if (!good) throw std::invalid_argument("panel '" + panel.title + "': lengths or numbers are off");
}

std::string line(const char* kind, double x1, double y1, double x2, double y2,
                 const std::string& more = {}) {
  return fmt::format(
      "<line class=\"{}\" {}x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind,
      more.empty() ? "" : more + " ", x1, y1, x2, y2);
}

std::string text_at(const char* kind, double x, double y, const std::string& text,
                    const char* anchor = "start") {
  return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                     kind, x, y, anchor, escape_markup(text));
}

std::string panel_svg(const PlotPanel& panel, int top) {
  check(panel);
  double low = 0, high = 0;
  for (const PlotSeries& series : panel.series) {
    for (const std::vector<double>* values : {&series.y, &series.low, &series.high}) {
      for (const double value : *values) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  }
  if (high == low) high = low + 1;
  const double margin = 0.05 * (high - low);
  const Axis x{panel.x.front(), panel.x.back(), kLeft, kWidth - kRight};
  const Axis y{low < 0 ? low - margin : 0, high + margin,
               static_cast<double>(top + height_of(panel) - kBottom),
               static_cast<double>(top + kTop)};

  std::string out = text_at("title", kLeft, top + 20, panel.title);
  for (const double tick : ticks(y, tick_step(y.high - y.low, 6))) {
    const double py = y.pixel(tick);
    out += line(tick == 0 ? "zero" : "grid", x.from, py, x.to, py);
    out += text_at("tick", kLeft - 8, py + 4, fmt::format("{:g}", tick), "end");
  }
  for (const double tick : ticks(x, angle_or_round_step(panel, x.high - x.low))) {
    const double px = x.pixel(tick);
    out += line("grid", px, y.from, px, y.to);
    out += text_at("tick", px, y.from + 18, fmt::format("{:g}", tick), "middle");
  }
  for (const PlotMark& mark : panel.marks) {
    const double px = x.pixel(mark.x);
    out += line("mark", px, y.from, px, y.to);
    out += text_at("tick", px + 3, y.to + 12, mark.label);
  }
  out +=
      text_at("label", (x.from + x.to) / 2, top + height_of(panel) - 14, panel.x_label, "middle");
  out += fmt::format(
      "<text class=\"label\" transform=\"translate(18,{:.1f}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      (y.from + y.to) / 2, escape_markup(panel.y_label));
  const auto points = [&](const std::vector<double>& values, std::size_t k) {
    return fmt::format("{:.1f},{:.1f}", x.pixel(panel.x[k]), y.pixel(values[k]));
  };
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const PlotSeries& series = panel.series[i];
    if (series.low.empty()) continue;
    out += fmt::format("<polygon class=\"band\" opacity=\".12\" fill=\"{}\" points=\"",
                       kColours[i % std::size(kColours)]);
    const std::size_t count = series.low.size();
    for (std::size_t k = 0; k < count; ++k) out += (k == 0 ? "" : " ") + points(series.low, k);
    for (std::size_t k = count; k-- > 0;) out += " " + points(series.high, k);
    out += "\"/>\n";
  }
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const PlotSeries& series = panel.series[i];
    out += fmt::format("<polyline {} points=\"", stroke(i));
    for (std::size_t k = 0; k < series.y.size(); ++k) {
      out += (k == 0 ? "" : " ") + points(series.y, k);
    }
    out += "\"/>\n";
    const int row = top + kTop + 14 + kLegendRow * static_cast<int>(i);
    out += line("key", x.to + 16, row, x.to + 40, row, stroke(i));
    out += text_at("label", x.to + 46, row + 4, series.name);
  }
  return out;
}

}  // namespace

std::string plot_svg(const std::vector<PlotPanel>& panels) {
  int height = 0;
  for (const PlotPanel& panel : panels) height += height_of(panel);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\">\n"
      "<style>text{{font-family:sans-serif;fill:#333}}.title{{font-size:14px;font-weight:bold}}"
      ".label{{font-size:13px}}.tick{{font-size:11px}}.grid{{stroke:#ddd}}.zero{{stroke:#333}}"
      ".mark{{stroke:#888;stroke-dasharray:4 3}}polyline{{fill:none;stroke-width:2}}"
      ".key{{stroke-width:2}}</style>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kWidth, height);
  int top = 0;
  for (const PlotPanel& panel : panels) {
    out += panel_svg(panel, top);
    top += height_of(panel);
  }
  return out + "</svg>\n";
}

}  // namespace stillbase
