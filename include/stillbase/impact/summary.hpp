// The impact object of the file formats: everything about one impact, in B.
#pragma once

#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/cases.hpp>
#include <stillbase/impact/joint_resistance.hpp>
#include <stillbase/impact/jump.hpp>

namespace stillbase {

template <class S>
struct RigidContact;  // contact_response.hpp

struct ImpactSummary {
  Vector6d Fbar = Vector6d::Zero();         ///< impulse [f; t] at the hand, N s, N m s
  Vector6d Delta_Omega = Vector6d::Zero();  ///< m/s, rad/s
  JointVectord Delta_phidot;                ///< n
  JointVectord Delta_phidot_rns;            ///< n, part in the angular reaction null space
  JointVectord Delta_phidot_orthogonal;     ///< n
  Vector3d total = Vector3d::Zero();        ///< Delta L_g, N m s
  Vector3d base = Vector3d::Zero();         ///< Htilde_omega Delta omega
  Vector3d coupling = Vector3d::Zero();     ///< Htilde_omegaphi Delta phidot
  CaseJudgement judgement;
  double rank_tolerance = kRankTolerance;
  int rank = 0;              ///< of Htilde_omegaphi
  double closing_speed = 0;  ///< m/s
  JointResistance resistance;
};

/// Everything about the impulse Fbar at the posture phi.
ImpactSummary summarize_impact(const RobotModel& robot, const JointVectord& phi,
                               const JointResistance& resistance, const Vector6d& Fbar,
                               double closing_speed, double case_tolerance = kCaseTolerance);

/// Everything about a sticking contact or a latch of a robot at rest. After a latch the momenta,
/// the rank and the split of the joint velocities are those of robot + target, and the case is
/// judged relative to |I_t omega_t| + m_r |s| |v_t| (see contact_response.hpp).
/// @param contact its law and target
/// @throws std::invalid_argument for a latch where the hand is fixed to the base
ImpactSummary summarize_contact(const RobotModel& robot, const JointVectord& phi,
                                const JointResistance& resistance,
                                const RigidContact<double>& contact, double closing_speed,
                                double case_tolerance = kCaseTolerance);

}  // namespace stillbase
