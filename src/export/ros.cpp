#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/export/export.hpp>

namespace stillbase {

namespace {

/// A number that every YAML reader takes for a floating-point one: with a point, also before "e".
std::string yaml_number(double x) {
  std::string text = fmt::format("{}", x);
  if (text.find('.') != std::string::npos) return text;
  const std::size_t exponent = std::min(text.find('e'), text.size());
  return text.insert(exponent, ".0");
}

std::string yaml_list(const JointVectord& values) {
  std::string text;
  for (const double x : values) text += (text.empty() ? "" : ", ") + yaml_number(x);
  return "[" + text + "]";
}

/// A name in a comment: without line ends and other control characters.
std::string comment_text(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < ' ' ? '_' : c;
  return text;
}

std::string yaml_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

std::string ros_trajectory(const Plan& plan) {
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  std::string text =
      "# trajectory_msgs/msg/JointTrajectory: approach of the plan '" +
      comment_text(plan.problem.name) +
      "'\n"
      "# positions rad (prismatic joints m), velocities rad/s (m/s), accelerations rad/s^2\n"
      "# (m/s^2), effort N m (N): of the joints themselves, in no frame\n";
  text += fmt::format(
      "# time_from_start: since {} s of the plan; contact at {} s of the plan\n"
      "header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: \"\"\njoint_names: [",
      samples.front().time, plan.configuration.contact_time);
  const auto& joints = plan.problem.robot.joints;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    text += (k > 0 ? ", " : "") + yaml_text(joints[k].name);
  }
  text += "]\npoints:\n";
  long long before = -1;
  for (const TrajectorySample& sample : samples) {
    const long long nanoseconds = std::llround((sample.time - samples.front().time) * 1e9);
    if (nanoseconds <= before) {
      throw InputError({{plan.problem.name, 0, "times",
                         fmt::format("approach.times: {} s is not a nanosecond after the sample "
                                     "before it",
                                     sample.time)}});
    }
    before = nanoseconds;
    text += fmt::format(
        "  - positions: {}\n    velocities: {}\n    accelerations: {}\n    effort: {}\n"
        "    time_from_start: {{sec: {}, nanosec: {}}}\n",
        yaml_list(sample.phi), yaml_list(sample.phidot), yaml_list(sample.phiddot),
        yaml_list(sample.tau), nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000);
  }
  return text;
}

}  // namespace stillbase
