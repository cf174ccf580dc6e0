// Messages of CCSDS in keyword-value notation.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/export/export.hpp>

namespace stillbase {

namespace {

using Nanoseconds = long long;
constexpr Nanoseconds kSecond = 1'000'000'000;

/// Digits [begin, begin + count) of a date.
int digits_at(const std::string& text, std::size_t begin, std::size_t count) {
  int value = -1;
  const char* const first = text.data() + begin;
  const auto [stop, error] = std::from_chars(first, first + count, value);
  return stop == first + count && error == std::errc() ? value : -1;
}

/// Nanoseconds since 1970-01-01T00:00:00 of a calendar without leap seconds.
/// @throws std::invalid_argument for a text that is no date
Nanoseconds parse_date(const std::string& text) {
  using namespace std::chrono;
  const auto refuse = [&text]() -> Nanoseconds {
    throw std::invalid_argument("'" + text + "' is no date; write 2026-03-01T12:00:00");
  };
  const bool has_form = text.size() >= 19 && text[4] == '-' && text[7] == '-' && text[10] == 'T' &&
                        text[13] == ':' && text[16] == ':';
  if (!has_form) return refuse();
  const int y = digits_at(text, 0, 4), m = digits_at(text, 5, 2), d = digits_at(text, 8, 2);
  const int hour = digits_at(text, 11, 2), minute = digits_at(text, 14, 2),
            second = digits_at(text, 17, 2);
  if (y < 0 || m < 0 || d < 0) return refuse();
  const year_month_day day{year{y}, month{static_cast<unsigned>(m)},
                           std::chrono::day{static_cast<unsigned>(d)}};
  const bool is_time =
      hour >= 0 && hour < 24 && minute >= 0 && minute < 60 && second >= 0 && second < 60;
  // Beyond these years the nanoseconds and those of a long plan would not fit.
  if (!day.ok() || !is_time || y < 1900 || y > 2200) return refuse();
  Nanoseconds fraction = 0;
  if (text.size() > 19) {
    const std::string part = text.substr(20);
    const bool is_fraction = text[19] == '.' && !part.empty() && part.size() <= 9 &&
                             part.find_first_not_of("0123456789") == std::string::npos;
    if (!is_fraction) return refuse();
    fraction = std::stoll((part + "00000000").substr(0, 9));
  }
  const Nanoseconds days = sys_days(day).time_since_epoch().count();
  return ((days * 24 + hour) * 60 + minute) * 60 * kSecond + second * kSecond + fraction;
}

std::string date_text(Nanoseconds since_1970) {
  using namespace std::chrono;
  const Nanoseconds day_length = 86400 * kSecond;
  Nanoseconds days_since = since_1970 / day_length, within = since_1970 % day_length;
  if (within < 0) {
    within += day_length;
    --days_since;
  }
  const year_month_day day{sys_days(days(days_since))};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:09}", static_cast<int>(day.year()),
                     static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()),
                     within / (3600 * kSecond), within / (60 * kSecond) % 60, within / kSecond % 60,
                     within % kSecond);
}

/// A value of printable ASCII.
void check_value(const std::string& what, const std::string& value) {
  const bool is_printable =
      std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (value.empty() || value.size() > 100 || !is_printable || value.front() == ' ') {
    throw std::invalid_argument(what + " '" + value + "': must be 1 to 100 printable characters");
  }
}

/// A name of the plan; what is not printable ASCII becomes '_'.
std::string object_name(const std::string& name) {
  std::string text = name.empty() ? "UNKNOWN" : name.substr(0, 100);
  for (char& c : text) c = c > ' ' && c <= '~' ? c : '_';
  return text;
}

/// The motion of one body.
struct BodyMotion {
  std::string name, origin, axes;
  struct State {
    Pose pose;              ///< T_N*
    Vector3d velocity;      ///< in N, m/s
    Vector3d angular_rate;  ///< in the body axes, rad/s
    Nanoseconds at = 0;
  };
  std::vector<State> states;
};

BodyMotion body_motion(const Plan& plan, const EphemerisOptions& options) {
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  const bool is_robot = options.body == EphemerisBody::Robot;
  if (!is_robot && !plan.problem.target) {
    throw InputError({{plan.problem.name, 0, "no-target", "the plan has no target body"}});
  }
  BodyMotion motion = is_robot ? BodyMotion{object_name(plan.problem.robot.name),
                                            "centroid of the base body",
                                            "frame B of the plan, axes of the base's root link",
                                            {}}
                               : BodyMotion{object_name(plan.problem.target->name),
                                            "centroid of the target",
                                            "frame T of the plan, axes of the target",
                                            {}};
  const Nanoseconds epoch = parse_date(options.epoch);
  for (const TrajectorySample& sample : samples) {
    if (!(std::abs(sample.time) < 1e9)) {
      throw InputError(
          {{plan.problem.name, 0, "times",
            fmt::format("approach.times: {} s is out of reach of a date", sample.time)}});
    }
    BodyMotion::State state;
    state.at = epoch + std::llround(sample.time * 1e9);
    if (!motion.states.empty() && state.at <= motion.states.back().at) {
      throw InputError({{plan.problem.name, 0, "times",
                         fmt::format("approach.times: {} s is not a nanosecond after the sample "
                                     "before it",
                                     sample.time)}});
    }
    if (is_robot) {
      state.pose = sample.base;
      state.velocity = sample.base.orientation * Vector3d(sample.Omega.head<3>());
      state.angular_rate = sample.Omega.tail<3>();
    } else {
      const TargetState& target = *sample.target;
      state.pose = target.pose;
      state.velocity = target.linear_velocity;
      state.angular_rate = target.pose.orientation.conjugate() * target.angular_velocity;
    }
    motion.states.push_back(state);
  }
  return motion;
}

std::string pair_line(const std::string& key, const std::string& value) {
  return fmt::format("{:<20} = {}\n", key, value);
}

/// What both messages say of the object and the frames.
std::string metadata_comments(const BodyMotion& motion, const Plan& plan,
                              const EphemerisOptions& options) {
  return "COMMENT " + options.frame + " is the inertial frame N of the plan, with the origin " +
         options.center +
         ".\nCOMMENT The plan states neither their place in space nor a calendar: its time 0 s is\n"
         "COMMENT " +
         options.epoch + " TAI here, and the contact at " +
         fmt::format("{} s.\n", plan.configuration.contact_time) +
         "COMMENT Position: " + motion.origin + ". Body axes: " + motion.axes + ".\n";
}

std::string times(const BodyMotion& motion) {
  return pair_line("TIME_SYSTEM", "TAI") +
         pair_line("START_TIME", date_text(motion.states.front().at)) +
         pair_line("STOP_TIME", date_text(motion.states.back().at));
}

/// A message up to the first keyword in which the two kinds differ.
std::string opening(const std::string& version_key, const std::string& units,
                    const BodyMotion& motion, const Plan& plan, const EphemerisOptions& options) {
  check_value("the frame", options.frame);
  check_value("the center", options.center);
  (void)parse_date(options.creation_date);
  return pair_line(version_key, "2.0") + "COMMENT stillbase export of the plan '" +
         object_name(plan.problem.name) + "'\n" +
         pair_line("CREATION_DATE", options.creation_date) + pair_line("ORIGINATOR", "STILLBASE") +
         "META_START\n" + metadata_comments(motion, plan, options) + "COMMENT " + units + "\n" +
         pair_line("OBJECT_NAME", motion.name) + pair_line("OBJECT_ID", "UNKNOWN") +
         pair_line("CENTER_NAME", options.center);
}

}  // namespace

std::string attitude_ephemeris(const Plan& plan, const EphemerisOptions& options) {
  const BodyMotion motion = body_motion(plan, options);
  std::string text =
      opening("CCSDS_AEM_VERS", "Quaternion Q1 Q2 Q3 QC (1), angular velocity in deg/s.", motion,
              plan, options) +
      pair_line("REF_FRAME_A", options.frame) + pair_line("REF_FRAME_B", "SC_BODY_1") +
      times(motion) + pair_line("ATTITUDE_TYPE", "QUATERNION/ANGVEL") +
      pair_line("ANGVEL_FRAME", "SC_BODY_1") + "META_STOP\nDATA_START\n";
  Eigen::Vector4d before(0, 0, 0, 1);
  for (const BodyMotion::State& state : motion.states) {
    Eigen::Vector4d q = state.pose.orientation.coeffs();  // x, y, z, w
    if (q.dot(before) < 0) q = -q;
    before = q;
    const Vector3d rate = state.angular_rate * (180 / kPi);
    text += fmt::format("{} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e}\n",
                        date_text(state.at), q[0], q[1], q[2], q[3], rate[0], rate[1], rate[2]);
  }
  return text + "DATA_STOP\n";
}

std::string orbit_ephemeris(const Plan& plan, const EphemerisOptions& options) {
  const BodyMotion motion = body_motion(plan, options);
  std::string text =
      opening("CCSDS_OEM_VERS", "Position in km, velocity in km/s.", motion, plan, options) +
      pair_line("REF_FRAME", options.frame) + times(motion) + "META_STOP\n";
  for (const BodyMotion::State& state : motion.states) {
    const Vector3d r = state.pose.position / 1000, v = state.velocity / 1000;
    text += fmt::format("{} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e} {:.15e}\n", date_text(state.at),
                        r[0], r[1], r[2], v[0], v[1], v[2]);
  }
  return text;
}

}  // namespace stillbase
