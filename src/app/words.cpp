#include "app/words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/simulation/simulate.hpp>

#include "io/defaults.hpp"

namespace stillbase::app {

namespace {

/// Rounding errors are zero, which has no sign. @param scale largest number beside x
double tidy(double x, double scale) {
  return std::abs(x) <= std::max(1e-15, 1e-12 * scale) ? 0 : x;
}

/// The same of what is printed as zero with so many digits behind the point.
double without_zeros_sign(double x, int digits) {
  return std::abs(x) < 0.5 * std::pow(10, -digits) ? 0 : x;
}

}  // namespace

std::string vector_words(const Vector3d& v) {
  const double scale = v.cwiseAbs().maxCoeff();
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", tidy(v.x(), scale), tidy(v.y(), scale),
                     tidy(v.z(), scale));
}

std::string posture_words(const RobotModel& robot, const JointVectord& phi) {
  std::string text;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    if (k > 0) text += ", ";
    text +=
        joint.is_prismatic()
            ? fmt::format("{} {:.4f} m", joint.name, without_zeros_sign(phi[k], 4))
            : fmt::format("{} {:.2f} deg", joint.name, without_zeros_sign(phi[k] * kDegrees, 2));
  }
  return text.empty() ? "no joints" : text;
}

std::string pose_words(const Pose& pose) {
  const Vector3d rotation = rotation_log(pose.orientation);
  std::string text = "position " + vector_words(pose.position) + " m";
  if (rotation.norm() > 1e-9) {
    text += fmt::format(", rotated by {:.2f} deg about {}", rotation.norm() * kDegrees,
                        vector_words(rotation.normalized()));
  }
  return text;
}

bool has_default_limits(const PostImpactSpec& spec) {
  return !spec.controllers.empty() && spec.residual_base_rate_max == io::kDefaultBaseRate &&
         spec.attitude_change_max == io::kDefaultAttitudeChange;
}

std::string limit_words(const PostImpactSpec& spec) {
  return fmt::format(
      "base rate at most {:.4g} deg/s after {:.4g} s, attitude change at most {:.4g} "
      "deg{}",
      spec.residual_base_rate_max * kDegrees, spec.horizon, spec.attitude_change_max * kDegrees,
      has_default_limits(spec) ? " (defaults)" : "");
}

std::string size_words(double x, int digits) {
  if (x == 0) return "0";
  return x < kZeroSize ? "0 (below 1e-9)" : fmt::format("{:.{}g}", x, digits);
}

double rounded_up(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 2);
  return std::ceil(x / unit * (1 - 1e-12)) * unit;
}

std::string after_horizon_words(const AfterHorizon& after, double horizon) {
  if (after.stop_time && *after.stop_time <= horizon) {
    return fmt::format(
        "{} reaches its stop {:.4g} s after the impact, before the horizon of {:.4g} s",
        after.joint, *after.stop_time, horizon);
  }
  if (!after.moves) return fmt::format("the joints rest at the horizon of {:.4g} s", horizon);
  return fmt::format("joints still move at {} rad/s at the horizon of {:.4g} s: {}",
                     size_words(after.joint_rate), horizon,
                     after.stop_time ? fmt::format("{} reaches its stop {:.4g} s after the impact",
                                                   after.joint, *after.stop_time)
                                     : fmt::format("none reaches a stop within ten horizons"));
}

bool have_rate_errors(const SensorSpec& sensor) {
  return sensor.base_rate_error > 0 || sensor.joint_rate_error > 0;
}

std::string rest_words(const SensorSpec& sensor, double time) {
  if (have_rate_errors(sensor)) {
    return fmt::format("at rest as far as the sensors tell after {:.4g} s", time);
  }
  return fmt::format("all but {:.4g} % of the momentum is taken after {:.4g} s", 100 * kAtRest,
                     time);
}

std::string count_words(long count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace stillbase::app
