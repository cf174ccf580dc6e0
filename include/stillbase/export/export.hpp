// What a plan says, as files of other programs. Units and frames are stated in every file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// One instant of the approach, with the target as it is predicted then.
struct TrajectorySample {
  double time = 0;                         ///< s
  JointVectord phi, phidot, phiddot, tau;  ///< n: rad (m) and derivatives, N m (N)
  Pose base;                               ///< T_NB
  Vector6d Omega = Vector6d::Zero();       ///< of the base in B: linear m/s, angular rad/s
  std::optional<TargetState> target;       ///< by the nominal motion; empty without a target
};

/// The approach of a plan at its samples, the contact included. Accelerations and torques are those
/// at the begin of the segment that starts at each sample.
/// @throws InputError (rule "no-approach") for a plan without an approach path
std::vector<TrajectorySample> approach_samples(const Plan& plan);

/// The samples as comma-separated values, one line each; names of columns end in the unit, and name
/// the frame of vectors.
std::string trajectory_csv(const Plan& plan);

/// The joint trajectory as a message `trajectory_msgs/msg/JointTrajectory` of ROS 2 in YAML, as
/// `ros2 topic pub` takes it. Times are those since the first sample, in whole nanoseconds.
std::string ros_trajectory(const Plan& plan);

enum class EphemerisBody { Robot, Target };

/// What messages of CCSDS state beside the motion.
struct EphemerisOptions {
  EphemerisBody body = EphemerisBody::Robot;
  /// TAI at time 0 of the plan, which knows no calendar: "YYYY-MM-DDThh:mm:ss[.d...]".
  std::string epoch = "2000-01-01T12:00:00";
  std::string frame = "PLAN_N";        ///< name of the inertial frame N
  std::string center = "PLAN_ORIGIN";  ///< name of its origin
  std::string creation_date;           ///< UTC, as the epoch
};

/// Attitude during the approach as an Attitude Ephemeris Message 2.0 (CCSDS 504.0-B-2), in keyword
/// notation: quaternion from N to the body axes (B, T), scalar last, and angular velocity in the
/// body axes in deg/s. Consecutive quaternions have positive products.
/// @throws InputError (rule "no-target") for the target of a plan without one
/// @throws std::invalid_argument for options that the message cannot hold
std::string attitude_ephemeris(const Plan& plan, const EphemerisOptions& options);

/// Motion during the approach as an Orbit Ephemeris Message 2.0 (CCSDS 502.0-B-2) in keyword
/// notation, in km and km/s: origin of B (centroid of the base body), or centroid of the target.
/// Errors as attitude_ephemeris().
std::string orbit_ephemeris(const Plan& plan, const EphemerisOptions& options);

/// A file of MATLAB (level 5, not compressed) with the variables
/// - `plan`: the plan file as a structure. Lists of numbers are columns, lists of lists matrices
/// with
///   a row each, lists of objects structure arrays, null is empty;
/// - `trajectory`: the samples as matrices with a row each; quaternions are w, x, y, z;
/// - `members`: unit, frame, shape and meaning of every member of `plan`;
/// - `about`: conventions in words.
std::string matlab_file(const Plan& plan);

/// A robot as URDF. Every link keeps its name and frame; the mass of links that do not move against
/// each other is that of one of them. Read back it gives the same model but for rounding.
/// @throws InputError (rule "mesh") for a collision mesh, which URDF has in a file of its own
std::string robot_urdf(const RobotModel& robot);

}  // namespace stillbase
