// URDF text to RobotModel.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Largest robot file, deepest nesting of its elements and largest number of links.
inline constexpr std::size_t kMaxUrdfBytes = 1u << 20;
inline constexpr int kMaxUrdfDepth = 64;
inline constexpr int kMaxUrdfLinks = 256;

/// Reads a robot.
///
/// Accepted: trees of revolute, continuous, prismatic and fixed joints. Fixed links are merged into
/// their parents (masses added, centroids averaged, parallel-axis theorem); then every body must
/// have mass > 0 and an inertia tensor that is positive definite and satisfies the triangle
/// inequality of principal moments. Links without <inertial> are frames without mass.
///
/// Revolute and prismatic joints need <limit> with lower, upper, velocity and effort; a continuous
/// joint has no lower and upper (they are ignored there, as URDF says), and no bounds on velocity
/// and effort unless it gives them. Axes are normalised.
///
/// Collision shapes: sphere, box, cylinder, and capsules. URDF has no capsule element: a
/// <collision> whose name ends in "_capsule" and holds a <cylinder> is a capsule, the cylinder of
/// that radius and length with a half sphere on both ends (a reader that does not know this reads
/// the cylinder). Meshes are refused in <collision>.
///
/// Read and not used: <visual>, <material>, <transmission>, <gazebo>, <sensor>, <contact>,
/// <calibration>, <safety_controller>. Every other unknown element or attribute is refused.
///
/// Numbers are plain decimals with a point, finite and at most 1e60 in size.
///
/// @param text URDF in UTF-8; at most kMaxUrdfBytes
/// @param source name of the file for messages
/// @param hand name of the hand link; when empty the only leaf link
/// @throws InputError with every finding of the same stage (form of the text, structure of the
/// tree,
///   physics): file, line, element and rule. When the hand alone is at fault the only rule is
///   "hand-unknown" (no such link) or "hand-missing" (empty, and there are several leaves).
RobotModel read_urdf(std::string_view text, const std::string& source, const std::string& hand);

/// Reads a robot file: read_urdf() of its text.
/// @throws InputError as read_urdf(); FileError when it cannot be read or is too large
RobotModel read_robot(const std::string& path, const std::string& hand = {});

}  // namespace stillbase
