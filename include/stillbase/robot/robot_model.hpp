// The constant part of a robot: a tree of rigid bodies on a free-floating base, one hand frame.
//
// Frames. Base frame B: origin at the centroid of the base body (the root link with every link
// rigidly fixed to it), axes parallel to the root link's. Body k (moved by joint k) has the frame
// of joint k: origin on the joint axis, **z along the joint axis**. A revolute joint turns the body
// by phi_k about z, a prismatic joint moves it by phi_k along z. Joint order: depth-first in file
// order, so a parent's index is always smaller than its child's.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/core/types.hpp>

namespace stillbase {

inline constexpr int kBase = -1;  ///< body index of the base

enum class JointType { Revolute, Continuous, Prismatic };

/// The axes of one frame in another, which never change. Products with axes that are those of the
/// other frame in another order or with other signs, without rounding, need no multiplications:
/// whenever axes are assigned it is found out whether each has one entry alone.
class ConstantAxes {
 public:
  ConstantAxes() : ConstantAxes(Matrix3d::Identity()) {}
  /// @param R a rotation, which may be assigned like a matrix
  template <class Derived>
  ConstantAxes(const Eigen::MatrixBase<Derived>& R) : R_(R) {  // NOLINT: implicit
    find_rows();
  }

  const Matrix3d& matrix() const { return R_; }
  /// Each axis is one of the other frame's, or its opposite.
  bool are_permuted() const { return rows_[0] >= 0; }
  /// @param j 0 to 2 @pre are_permuted() @return where column j of the matrix has its only entry
  int row(int j) const { return rows_[static_cast<std::size_t>(j)]; }

 private:
  void find_rows();

  Matrix3d R_;
  std::array<signed char, 3> rows_;
};

/// A joint connects body `parent` to the body that it moves.
struct Joint {
  std::string name;
  JointType type = JointType::Revolute;
  int parent = kBase;               ///< body index, kBase for the base
  ConstantAxes R;                   ///< axes of the joint's frame at zero in the parent's frame
  Vector3d p = Vector3d::Zero();    ///< origin of the joint's frame in the parent's frame, m
  double lower = -kInfinity;        ///< rad or m
  double upper = kInfinity;         ///< rad or m
  double max_velocity = kInfinity;  ///< rad/s or m/s
  double max_effort = kInfinity;    ///< N m or N
  double viscous_friction = 0;      ///< URDF damping, N m s/rad
  double coulomb_friction = 0;      ///< URDF friction, N m
  double rotor_inertia = 0;         ///< of the drive about its own axis, kg m^2
  double gear_ratio = 1;  ///< rate of the rotor per rate of the joint, 1 (prismatic: rad/m)
  /// What the drive adds to the diagonal of H_phi: gear_ratio^2 rotor_inertia, kg m^2 or kg.
  ///
  /// The rotor's spin about its axis relative to the link that carries it; its mass belongs to that
  /// link. Neglected is that the spin also moves with the base and with the joints before this one,
  /// which is 1 / gear_ratio of it: momentum and bias forces are those without rotors.
  double reflected_inertia() const { return gear_ratio * gear_ratio * rotor_inertia; }
  bool is_prismatic() const { return type == JointType::Prismatic; }
};

/// A rigid body after merging of fixed links.
struct Body {
  std::string name;                       ///< of the moving link (for the base: the root link)
  std::vector<std::string> merged_links;  ///< links rigidly fixed to it, in file order
  double mass = 0;                        ///< kg, > 0
  Vector3d centroid = Vector3d::Zero();   ///< in the body frame, m (base: 0 by definition of B)
  Matrix3d inertia = Matrix3d::Zero();    ///< about the centroid, body axes, kg m^2
};

struct Sphere {
  double radius;
};
struct Capsule {
  double radius, length;
};  ///< along z, centred; length without the caps
struct Cylinder {
  double radius, length;
};  ///< along z, centred
struct Box {
  Vector3d size;
};  ///< full edge lengths, centred
struct ConvexMesh {
  std::vector<Vector3d> vertices;
  std::vector<std::vector<int>> faces;  ///< counter-clockwise seen from outside
};
using Geometry = std::variant<Sphere, Capsule, Cylinder, Box, ConvexMesh>;

/// A collision shape fixed to a body.
struct CollisionShape {
  int body = kBase;  ///< body index
  std::string link;  ///< link of the file that it came from
  Pose pose;         ///< shape frame in the body frame
  Geometry geometry;
};

/// A link of the file, movable or fixed, as a frame on its body.
struct LinkFrame {
  std::string name;
  int body = kBase;
  Pose pose;           ///< link frame in the body frame
  std::string parent;  ///< parent link in the file; empty for the root
};

/// How the joint of one body moves: its position is ratio * phi[joint] + offset.
struct Coupling {
  int joint = 0;  ///< index into RobotModel::joints
  double ratio = 1;
  double offset = 0;  ///< rad or m
};

/// Joints that follow others (URDF's `<mimic>`) are no coordinates: phi, limits and matrices have
/// one entry per joint that moves by itself (n). With phi_b the positions of all bodies' joints,
/// phi_b = G phi + g with constant G, so the dynamics are those of the tree after the congruence
/// H_phi = G' H_b G, c_phi = G' c_b.
struct RobotModel {
  std::string name;
  Body base;
  std::vector<Joint> joints;        ///< n: those that move by themselves
  std::vector<Body> bodies;         ///< moved by the joints of tree(), parents first
  std::vector<Joint> coupled_tree;  ///< empty without couplings: see tree()
  std::vector<Coupling> couplings;  ///< one per body; empty: joint k moves body k alone
  std::vector<LinkFrame> links;     ///< every link of the file, in file order
  std::vector<CollisionShape> shapes;
  std::string hand;  ///< name of the hand link
  int hand_body = kBase;
  Matrix3d R_hand = Matrix3d::Identity();  ///< axes of the hand frame in its body's frame
  Vector3d p_hand = Vector3d::Zero();      ///< origin of the hand frame in its body's frame, m
  std::vector<bool> moves_hand;            ///< per body: its joint lies between base and hand
  /// What of the file was not read or had to be assumed, one per kind; nothing is wrong with it.
  std::vector<Finding> remarks;

  int n() const { return static_cast<int>(joints.size()); }
  /// The joint that moves each body; its `parent` is a body index below its own.
  const std::vector<Joint>& tree() const { return couplings.empty() ? joints : coupled_tree; }
  bool is_coupled() const { return !couplings.empty(); }
  int num_bodies() const { return static_cast<int>(bodies.size()); }
  /// Index into `joints` of what moves body k.
  int coordinate(int k) const {
    return couplings.empty() ? k : couplings[static_cast<std::size_t>(k)].joint;
  }
  double total_mass() const;
};

/// Index of the joint with this name, or -1.
int find_joint(const RobotModel& robot, const std::string& name);

/// The frame of the link with this name, or nullptr.
const LinkFrame* find_link(const RobotModel& robot, const std::string& name);

/// The same robot with another link as its hand.
/// @throws std::invalid_argument when there is no such link.
RobotModel with_hand(RobotModel robot, const std::string& link);

/// Links that have no child link. `inspect` takes the only one as hand.
std::vector<std::string> leaf_links(const RobotModel& robot);

}  // namespace stillbase
