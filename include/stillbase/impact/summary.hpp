// The impact object of the file formats: everything about one impact, in B.
#pragma once

#include <optional>

#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/cases.hpp>
#include <stillbase/impact/joint_resistance.hpp>
#include <stillbase/impact/jump.hpp>

namespace stillbase {

template <class S>
struct RigidContact;  // contact_response.hpp

/// The robot right before a contact with a hand that moves, in B, and what that changes.
struct MotionBefore {
  Vector6d Omega = Vector6d::Zero();          ///< of the base, without momentum of the robot
  JointVectord phidot;                        ///< n
  Vector6d hand_velocity = Vector6d::Zero();  ///< [v; omega] of the hand
  /// Of the target's point at the hand and of the target, minus those of the hand.
  Vector6d relative_velocity = Vector6d::Zero();
  Vector3d base = Vector3d::Zero();  ///< Htilde_omega omega of the robot alone, N m s
  /// Beside a hand at rest in the same posture: the impulse, and the base part after it.
  Vector6d Fbar_at_rest = Vector6d::Zero();
  Vector3d base_at_rest = Vector3d::Zero();
};

struct ImpactSummary {
  Vector6d Fbar = Vector6d::Zero();         ///< impulse [f; t] at the hand, N s, N m s
  Vector6d Delta_Omega = Vector6d::Zero();  ///< m/s, rad/s
  JointVectord Delta_phidot;                ///< n
  JointVectord Delta_phidot_rns;            ///< n, part in the angular reaction null space
  JointVectord Delta_phidot_orthogonal;     ///< n
  // Momenta right after the impact; of a robot at rest before it those gained.
  Vector3d total = Vector3d::Zero();     ///< L_g, N m s
  Vector3d base = Vector3d::Zero();      ///< Htilde_omega omega
  Vector3d coupling = Vector3d::Zero();  ///< Htilde_omegaphi phidot
  CaseJudgement judgement;
  double rank_tolerance = kRankTolerance;
  int rank = 0;              ///< of Htilde_omegaphi
  double closing_speed = 0;  ///< m/s
  JointResistance resistance;
  std::optional<MotionBefore> before;  ///< empty: the robot is at rest before the impact

  /// Velocities right after the impact, [v; omega] of the base and the joint rates (n).
  Vector6d Omega_after() const {
    return before ? Vector6d(before->Omega + Delta_Omega) : Delta_Omega;
  }
  JointVectord phidot_after() const {
    return before ? JointVectord(before->phidot + Delta_phidot) : Delta_phidot;
  }
};

/// Everything about the impulse Fbar at the posture phi.
ImpactSummary summarize_impact(const RobotModel& robot, const JointVectord& phi,
                               const JointResistance& resistance, const Vector6d& Fbar,
                               double closing_speed, double case_tolerance = kCaseTolerance);

/// Everything about a sticking contact or a latch of a robot without momentum. After a latch the
/// momenta, the rank and the split of the joint velocities are those of robot + target, and the
/// case is judged relative to |I_t omega_t| + m_r |s| |v_t| (see contact_response.hpp).
/// @param contact its law and target
/// @throws std::invalid_argument for a latch where the hand is fixed to the base
ImpactSummary summarize_contact(const RobotModel& robot, const JointVectord& phi,
                                const JointResistance& resistance,
                                const RigidContact<double>& contact, double closing_speed,
                                double case_tolerance = kCaseTolerance);

}  // namespace stillbase
