// The impact object of the file formats: everything about one impact, in B.
#pragma once

#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/cases.hpp>
#include <stillbase/impact/joint_resistance.hpp>
#include <stillbase/impact/jump.hpp>

namespace stillbase {

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

}  // namespace stillbase
