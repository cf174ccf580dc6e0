// What a problem says of a spacecraft that is put together from a base and arms of files.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Root link of a robot that is put together.
inline constexpr const char* kBaseLink = "satellite";

/// What stands for the meshes of `<collision>`.
enum class CollisionMeshes {
  Hull,      ///< one convex hull each
  Decompose  ///< several convex parts where the mesh is concave
};

/// The body that the arms are mounted on, in its own frame: origin at its centroid.
struct BaseBody {
  double mass = 0;                                ///< kg
  Matrix3d inertia = Matrix3d::Zero();            ///< about the centroid, kg m^2
  std::vector<std::pair<Pose, Geometry>> shapes;  ///< for collision checks
};

/// A robot file whose root link is fixed to the base.
struct MountedArm {
  std::string file;                ///< as written in the problem
  std::string prefix;              ///< of the names of its links and joints
  Pose mount;                      ///< of its root link, in the frame of the base body
  std::string hand;                ///< link of the file; empty: another arm has the hand
  std::optional<Pose> hand_frame;  ///< of the hand's frame in that link; empty: the link's own
};

/// What a problem says instead of the file; empty: the file's.
struct JointLimits {
  std::optional<double> lower, upper;  ///< rad or m
  std::optional<double> rate;          ///< rad/s or m/s
  std::optional<double> torque;        ///< of a turning joint, N m
  std::optional<double> force;         ///< of a sliding joint, N
};

/// The drive of a joint as a problem states it, instead of the file's.
struct JointRotor {
  double inertia = 0;     ///< of the rotor about its own axis, kg m^2
  double gear_ratio = 1;  ///< rate of the rotor per rate of the joint, 1 (prismatic: rad/m)
};

/// The parts of a robot as a problem states them. All empty: a robot file alone.
struct RobotParts {
  std::optional<BaseBody> base;
  std::vector<MountedArm> arms;
  std::map<std::string, double> locked;  ///< by joint: rad or m
  std::map<std::string, JointLimits> limits;
  std::map<std::string, JointRotor> rotors;
  CollisionMeshes collision = CollisionMeshes::Hull;  ///< of all files
  std::vector<std::string> package_path;  ///< folders in which packages of meshes are looked for
};

/// Inertia of a homogeneous body about its centroid, kg m^2.
/// @throws std::invalid_argument for a mesh
Matrix3d homogeneous_inertia(double mass, const Geometry& geometry);

}  // namespace stillbase
