// Numbers in words and units for people.
#pragma once

#include <string>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase::app {

inline constexpr double kDegrees = 180 / kPi;  ///< per radian

/// "(1, 2, 3)" with 4 significant digits.
std::string vector_words(const Vector3d& v);
/// "joint_1 -80 deg, slide 0.2 m"
std::string posture_words(const RobotModel& robot, const JointVectord& phi);
/// "position (0, 0, 0) m, rotated by 55 deg about (0, 1, 0)"
std::string pose_words(const Pose& pose);
/// "base rate at most 1 deg/s after 10 s, attitude change at most 20 deg (defaults)"
std::string limit_words(const PostImpactSpec& spec);
/// Whether a problem that states no limits after the impact has these.
bool has_default_limits(const PostImpactSpec& spec);
/// "0 (below 1e-9)" for what is zero but for rounding in any unit used.
std::string size_words(double x, int digits = 3);
inline constexpr double kZeroSize = 1e-9;
/// The next number with three digits, for what is said as a value that is enough. @pre x > 0
double rounded_up(double x);
/// "joints still move at 0.11 rad/s at the horizon of 10 s: joint_2 reaches its stop at 18.3 s"
std::string after_horizon_words(const AfterHorizon& after, double horizon);
/// Whether sensors have errors in the rates that a momentum is known from.
bool have_rate_errors(const SensorSpec& sensor);
/// "all but 1 % of the momentum is taken after 24 s", or of sensors with errors how far they tell.
std::string rest_words(const SensorSpec& sensor, double time);
/// "1 body", "3 bodies"
std::string count_words(long count, const std::string& one, const std::string& many);

}  // namespace stillbase::app
