// Hand and target with a spring and a damper between them, a second time: in the target's axes.
#pragma once

#include <stillbase/reference/reference.hpp>

namespace stillbase::reference {

/// A body that nothing but the contact acts on.
struct BodyMotion {
  Pose pose;                                           ///< T_NT, its centroid
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the centroid in N, m/s
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();      ///< in T, rad/s
};

/// The hand's origin against the plane through a point of the target. While the gap g = n . p is
/// negative, p and u being place and velocity of the hand seen from the target, the hand is pushed
/// with f = max(0, -stiffness g - damping n . u) along n, and against the tangential velocity t
/// with friction f |t| / max(|t|, slip_rate).
struct SpringContact {
  double mass = 0;                                    ///< of the target, kg
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< in T, kg m^2; zero: a point mass
  double stiffness = 0;                               ///< N/m
  double damping = 0;                                 ///< N s/m
  double friction = 0;
  double slip_rate = 1e-4;                            ///< m/s
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< in T, m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< n, outward, in T
  /// Drives that hold the posture until the first contact is over: n each, or empty.
  Eigen::VectorXd servo_stiffness, servo_damping, servo_posture;
};

/// The contact at one instant.
struct ContactPush {
  double gap = 0;                                         ///< g, m
  double push = 0;                                        ///< f before the cut at zero, N
  Eigen::Vector3d force = Eigen::Vector3d::Zero();        ///< on the hand where f acts, in N, N
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();    ///< derivative of the rate of T where no
                                                          ///< force acts, in T, rad/s^2
  Eigen::Vector3d moment_rate = Eigen::Vector3d::Zero();  ///< what the force adds to it
};

/// @param hand, hand_velocity in N
ContactPush contact_push(const SpringContact& contact, const BodyMotion& body,
                         const Eigen::Vector3d& hand, const Eigen::Vector3d& hand_velocity);

/// The damping (N s/m) with which a contact gives back the part `restitution` of the closing speed:
/// the motion of the reduced mass against spring and damper is integrated until the force is zero.
/// @param restitution in (0, 1]
/// @param effective_mass kg
double damping_for(double restitution, double stiffness, double effective_mass);

}  // namespace stillbase::reference
