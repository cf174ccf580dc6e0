#include <stillbase/encounter/contact_window.hpp>

#include <algorithm>
#include <cmath>

#include <boost/math/tools/minima.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase {

namespace {

constexpr double kMostBeside = 1000;    ///< s on either side of the stated window
constexpr double kMostSurveyed = 200;   ///< rad: at 24 views per rad, 4800 of them
constexpr double kViewsPerRadian = 24;  ///< a window of 5 deg has two
constexpr double kLeastViews = 240;
constexpr double kWindowEnd = 1e-9;  ///< s to which the end of a window is found

FeatureView view_at(const CaptureProblem& problem, const TargetMotion& motion,
                    const ContactFeature& feature, double time) {
  const ContactState contact = motion.contact(feature, time);
  const Vector3d to_base = problem.base.position - contact.point;
  FeatureView view;
  view.time = time;
  view.closing_speed = contact.normal.dot(contact.velocity);
  view.distance = to_base.norm();
  view.facing_angle = std::atan2(contact.normal.cross(to_base).norm(), contact.normal.dot(to_base));
  return view;
}

bool is_open(const CaptureProblem& problem, const FeatureView& view) {
  return view.facing_angle < kPi / 2 && view.closing_speed >= problem.constraints.closing_speed_min;
}

/// The instant between two views at which the window opens or closes.
double change_between(const CaptureProblem& problem, const TargetMotion& motion,
                      const ContactFeature& feature, double before, double after) {
  const bool was_open = is_open(problem, view_at(problem, motion, feature, before));
  while (after - before > kWindowEnd) {
    const double middle = 0.5 * (before + after);
    if (!(middle > before && middle < after)) break;
    (is_open(problem, view_at(problem, motion, feature, middle)) == was_open ? before : after) =
        middle;
  }
  return after;
}

/// The least of sign * closing speed in a window, whose views are a few degrees apart: next to the
/// least one of them, or at an end.
double least_speed(const CaptureProblem& problem, const TargetMotion& motion,
                   const ContactFeature& feature, const std::vector<FeatureView>& views,
                   const ContactWindow& window, double sign) {
  const auto speed = [&](double time) {
    return sign * view_at(problem, motion, feature, time).closing_speed;
  };
  double least = std::min(speed(window.from), speed(window.to));
  double at = window.from, step = window.to - window.from;
  for (const FeatureView& view : views) {
    if (view.time < window.from || view.time > window.to) continue;
    if (sign * view.closing_speed < least) {
      least = sign * view.closing_speed;
      at = view.time;
    }
  }
  if (views.size() > 1) step = std::min(step, views[1].time - views[0].time);
  constexpr int kBits = 26;  // half of a double's: the speed is flat there
  return std::min(least,
                  boost::math::tools::brent_find_minima(speed, std::max(window.from, at - step),
                                                        std::min(window.to, at + step), kBits)
                      .second);
}

FeatureWindows windows_of(const CaptureProblem& problem, const TargetMotion& motion,
                          const ContactFeature& feature, double from, double to, int intervals) {
  FeatureWindows out;
  out.feature = feature.name;
  for (int i = 0; i <= intervals; ++i) {
    const double time = i == intervals ? to : from + (to - from) * i / intervals;
    const FeatureView view = view_at(problem, motion, feature, time);
    const bool was = !out.views.empty() && is_open(problem, out.views.back());
    const bool is = is_open(problem, view);
    if (is != was) {
      const double change =
          out.views.empty() ? from
                            : change_between(problem, motion, feature, out.views.back().time, time);
      if (is) {
        out.windows.push_back({change, to});
      } else {
        out.windows.back().to = change;
      }
    }
    out.views.push_back(view);
  }
  for (ContactWindow& window : out.windows) {
    window.least_closing_speed = least_speed(problem, motion, feature, out.views, window, 1);
    window.largest_closing_speed = -least_speed(problem, motion, feature, out.views, window, -1);
  }
  return out;
}

}  // namespace

WindowSurvey survey_contact_windows(const CaptureProblem& problem) {
  WindowSurvey out;
  if (!problem.target || problem.impulse.direction) return out;
  const VariableSpec& variables = problem.variables;
  const TargetState& estimate = problem.target_state;
  const double lower = variables.contact_time_lower, upper = variables.contact_time_upper;
  const double rate = problem.target->is_point_mass ? 0 : estimate.angular_velocity.norm();
  const double beside =
      std::min(kMostBeside, rate > 0 ? 2 * kPi / rate : std::max(upper - lower, 10.0));
  out.from = std::max(std::min(lower, estimate.time), lower - beside);
  out.to = upper + beside;
  if (rate * (out.to - out.from) > kMostSurveyed) out.to = out.from + kMostSurveyed / rate;
  const double horizon =
      std::max(std::abs(out.from - estimate.time), std::abs(out.to - estimate.time)) + 1;
  const TargetMotion motion(*problem.target, estimate, horizon);
  const int intervals = static_cast<int>(
      std::ceil(std::max(kLeastViews, kViewsPerRadian * rate * (out.to - out.from))));
  for (const ContactFeature& feature : problem.target->features) {
    out.features.push_back(windows_of(problem, motion, feature, out.from, out.to, intervals));
  }
  return out;
}

}  // namespace stillbase
