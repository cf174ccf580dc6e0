#include "app/window_words.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <stillbase/encounter/contact_window.hpp>
#include <stillbase/report/plot.hpp>

#include "app/tool.hpp"
#include "app/words.hpp"
#include "core/escape.hpp"

namespace stillbase::app {

namespace {

constexpr std::size_t kMostSeries = 18;  ///< of a plot

/// Which of the two conditions fails where the window never opens.
std::string never_words(const CaptureProblem& problem, const FeatureWindows& feature) {
  double largest = -kInfinity, nearest = kInfinity;
  for (const FeatureView& view : feature.views) {
    if (view.facing_angle < kPi / 2) largest = std::max(largest, view.closing_speed);
    nearest = std::min(nearest, view.facing_angle);
  }
  if (largest == -kInfinity) {
    return fmt::format("never: it points at least {:.4g} deg away from the base",
                       nearest * kDegrees);
  }
  return fmt::format(
      "never: while it faces the base it closes in at {:.4g} m/s at most, {:.4g} m/s "
      "are asked for",
      largest, problem.constraints.closing_speed_min);
}

WindowSurvey survey_to_draw(const CaptureProblem& problem) {
  WindowSurvey survey;
  try {
    survey = survey_contact_windows(problem);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(fmt::format("-o: no contact windows: {}", error.what()));
  }
  if (survey.features.empty()) {
    throw CommandLineError(
        "-o: no contact windows: the problem states its direction of the impulse, or its target "
        "has no features");
  }
  return survey;
}

/// Of the features that the search may choose; none where nothing can be said.
std::vector<FeatureWindows> chosen_windows(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  WindowSurvey survey;
  try {
    survey = survey_contact_windows(problem);
  } catch (const std::invalid_argument&) {
    return {};
  }
  std::erase_if(survey.features, [&](const FeatureWindows& windows) {
    const std::string& name = windows.feature;
    return variables.features.empty()
               ? name != variables.feature
               : std::find(variables.features.begin(), variables.features.end(), name) ==
                     variables.features.end();
  });
  return survey.features;
}

}  // namespace

std::optional<NamedWindow> next_contact_window(const CaptureProblem& problem, double time) {
  std::optional<NamedWindow> first;
  for (const FeatureWindows& feature : chosen_windows(problem)) {
    for (const ContactWindow& window : feature.windows) {
      if (window.to <= time || (first && first->from <= window.from)) continue;
      first = {feature.feature, window.from, window.to};
    }
  }
  return first;
}

bool always_recedes(const CaptureProblem& problem) {
  const std::vector<FeatureWindows> features = chosen_windows(problem);
  const VariableSpec& variables = problem.variables;
  for (const FeatureWindows& feature : features) {
    const std::vector<FeatureView>& views = feature.views;
    const double step = views[1].time - views[0].time;
    for (const FeatureView& view : views) {
      const bool is_beside = view.time < variables.contact_time_lower - step ||
                             view.time > variables.contact_time_upper + step;
      if (!is_beside && view.closing_speed > 0) return false;
    }
  }
  return !features.empty();
}

std::string window_words(const CaptureProblem& problem) {
  WindowSurvey survey;
  try {
    survey = survey_contact_windows(problem);
  } catch (const std::invalid_argument& error) {
    return fmt::format("contact windows: none computed: {}\n", error.what());
  }
  if (survey.features.empty()) return "";
  const VariableSpec& variables = problem.variables;
  const bool is_range = variables.contact_time_lower < variables.contact_time_upper;
  std::string text = fmt::format(
      "contact windows from {:.6g} to {:.6g} s (variables.contact_time: {:.6g}{} s), while a "
      "feature "
      "faces the stated base and closes in at {:.4g} m/s or more:\n",
      survey.from, survey.to, variables.contact_time_lower,
      is_range ? fmt::format(" to {:.6g}", variables.contact_time_upper) : "",
      problem.constraints.closing_speed_min);
  for (const FeatureWindows& feature : survey.features) {
    if (feature.windows.empty()) {
      text += fmt::format("  {}: {}\n", feature.feature, never_words(problem, feature));
    }
    for (const ContactWindow& window : feature.windows) {
      text += fmt::format("  {}: {:.3f} to {:.3f} s, closing at {:.4g} to {:.4g} m/s\n",
                          feature.feature, window.from, window.to, window.least_closing_speed,
                          window.largest_closing_speed);
    }
  }
  return text;
}

std::string window_csv(const CaptureProblem& problem) {
  const WindowSurvey survey = survey_to_draw(problem);
  std::string text = "time_s";
  for (const FeatureWindows& feature : survey.features) {
    for (const char* const column : {"_closing_m_s", "_facing_deg", "_distance_m"}) {
      text += ',' + csv_field(feature.feature + column);
    }
  }
  text += '\n';
  for (std::size_t i = 0; i < survey.features.front().views.size(); ++i) {
    text += fmt::format("{}", survey.features.front().views[i].time);
    for (const FeatureWindows& feature : survey.features) {
      const FeatureView& view = feature.views[i];
      text +=
          fmt::format(",{},{},{}", view.closing_speed, view.facing_angle * kDegrees, view.distance);
    }
    text += '\n';
  }
  return text;
}

std::string window_svg(const CaptureProblem& problem) {
  const WindowSurvey survey = survey_to_draw(problem);
  PlotPanel speed, facing;
  speed.title = "Closing speed of the contact features: " + problem.name;
  speed.y_label = "m/s";
  facing.title = "Angle between normal and line to the base";
  facing.y_label = "deg";
  speed.x_label = facing.x_label = "time, s";
  for (const FeatureView& view : survey.features.front().views) speed.x.push_back(view.time);
  facing.x = speed.x;
  for (const FeatureWindows& feature : survey.features) {
    if (speed.series.size() == kMostSeries) break;
    PlotSeries& v = speed.series.emplace_back(PlotSeries{feature.feature, {}});
    PlotSeries& angle = facing.series.emplace_back(PlotSeries{feature.feature, {}});
    for (const FeatureView& view : feature.views) {
      v.y.push_back(view.closing_speed);
      angle.y.push_back(view.facing_angle * kDegrees);
    }
  }
  for (PlotPanel* panel : {&speed, &facing}) {
    panel->marks = {{problem.variables.contact_time_lower, "earliest contact"},
                    {problem.variables.contact_time_upper, "latest contact"}};
    if (panel->marks[0].x == panel->marks[1].x) panel->marks.resize(1);
    // A survey that was cut short may end before.
    std::erase_if(panel->marks, [&](const PlotMark& mark) { return mark.x > panel->x.back(); });
  }
  return plot_svg({speed, facing});
}

}  // namespace stillbase::app
