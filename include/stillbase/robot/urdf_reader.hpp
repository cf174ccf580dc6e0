// URDF text to RobotModel.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/robot/assembled_robot.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Largest robot file, deepest nesting of its elements and largest number of links.
inline constexpr std::size_t kMaxUrdfBytes = 4u << 20;
inline constexpr int kMaxUrdfDepth = 64;
inline constexpr int kMaxUrdfLinks = 1024;

/// What a caller can do without.
struct UrdfOptions {
  /// The base body may have no mass or no inertia: an arm that has yet to be mounted. H is singular
  /// then.
  bool may_lack_base = false;
  /// Of several leaf links the hand is the one behind the most movable joints (the first of those
  /// in file order), and a remark says so.
  bool may_lack_hand = false;
  /// Folders in which packages of meshes are looked for, before those of ROS_PACKAGE_PATH.
  std::vector<std::string> package_path = {};
  /// What read_robot() puts around meshes.
  CollisionMeshes collision = CollisionMeshes::Hull;
};

/// Reads a robot. Strict where physics needs it; what does not concern mechanics is left out, with
/// a remark of RobotModel::remarks.
///
/// Accepted: trees of revolute, continuous, prismatic and fixed joints. Fixed links are merged into
/// their parents (masses added, centroids averaged, parallel-axis theorem); then every body must
/// have mass > 0 and an inertia tensor that is positive definite and satisfies the triangle
/// inequality of principal moments, to within the digits that the file gives. Moments of zero,
/// those of a point mass or a rod without thickness, are remarked upon where the joint of the body
/// has an inertia to move all the same; those of the base are refused. What an `<inertial>` does
/// not state is 0, and links without it are frames without mass. Those of them above a floating or
/// planar joint are left out, and so are three or more slides and turns between links without mass,
/// two of them slides, that stand for such a joint above the first link with mass. A `world` that
/// no joint names is left out; a parent `world` need not be stated.
///
/// Revolute and prismatic joints need `<limit>`; its lower and upper are 0 when they are not
/// stated, as URDF says, and velocity and effort 0, which is remarked upon: no motion can be
/// planned with it. The same holds for a velocity or effort that is negative or no number. A lower
/// above the upper is taken for the upper. A joint without range that moves no mass is fixed. A
/// continuous joint has no lower and upper (they are ignored there), and no bounds on velocity and
/// effort unless it has a `<limit>`. Axes are normalised.
///
/// Collision shapes: sphere, box, cylinder, capsule (length without caps). A `<collision>` whose
/// name ends in "_capsule" and holds a `<cylinder>` is a capsule, the cylinder of that radius and
/// length with a half sphere on both ends (a reader that does not know this reads the cylinder).
///
/// Meshes in `<collision>` become convex hulls: read_robot() reads their files, read_urdf() takes
/// the `<hull>` elements beside a `<mesh>` that a merged file has. Without either the link has no
/// shape there, which is remarked upon.
///
/// Joints that follow others (`<mimic>`) are no joints of the model: see Coupling.
///
/// Remarked upon once per kind, with the number of times and the first line: elements, attributes
/// and text that are not read (`<gazebo>`, `<transmission>`, `<ros2_control>`, safety controllers,
/// axes of fixed joints, ...), shapes without size or of no known kind, sizes and coefficients of
/// friction that are negative or no numbers, limits of zero, an element that is stated twice alike,
/// `<limit>` and `<dynamics>` that are stated again (the first is read), a `<robot>` without a name
/// or of another version.
///
/// Numbers of masses and places are plain decimals with a point, finite and at most 1e60 in size;
/// others are refused. In `<limit>` larger ones, which some programs write for "none", are no
/// limit: a turning joint without ends is continuous. An `<origin>` may state quat_xyzw in place of
/// rpy.
///
/// @param text URDF in UTF-8, in UTF-16 with a byte order mark, or in the ISO 8859-1 that it
/// declares; at most kMaxUrdfBytes
/// @param source name of the file for messages
/// @param hand name of the hand link; when empty the only leaf link
/// @throws InputError with every finding of the same stage (form of the text, structure of the
/// tree,
///   physics): file, line, element and rule. When the hand alone is at fault the only rule is
///   "hand-unknown" (no such link) or "hand-missing" (empty, and there are several leaves).
RobotModel read_urdf(std::string_view text, const std::string& source, const std::string& hand,
                     const UrdfOptions& options = {});

/// Reads a robot file: read_urdf() of its text, with hulls around the meshes that it names by
/// package://, file:// or a path. Packages are looked for upwards from the file, then in
/// `package_path` and ROS_PACKAGE_PATH. Hulls have at most 64 vertices, hold every vertex of their
/// mesh, and a remark names those that are much larger than their mesh. With
/// CollisionMeshes::Decompose a concave mesh becomes at most 12 parts of at most 32 vertices each,
/// which together hold its triangles.
/// @throws InputError as read_urdf(); FileError when it cannot be read or is too large
RobotModel read_robot(const std::string& path, const std::string& hand = {},
                      const UrdfOptions& options = {});

}  // namespace stillbase
