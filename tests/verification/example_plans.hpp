// Plans made by a small planner of the tests, right or with one sign wrong.
//
// The planner computes with the dense matrices of `reference`, some with a wrong sign on purpose,
// and states in a plan what follows from them by its own formulas.
#pragma once

#include <stillbase/plan/plan.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase::verification_test {

/// The sign that a planner has wrong.
enum class Flip {
  None,
  LinearCoupling,   ///< H_vphi: the printed sign of (1)
  AngularCoupling,  ///< H_omegaphi
  LinearAngular,    ///< H_vomega
  HandLever,        ///< moment of the impulse about the base
  HandJacobian,     ///< first column of J_phi
  SystemCentroid,   ///< r_gb instead of r_bg
  BaseDrift,        ///< base motion of the approach
  ClosingSpeed      ///< v_hand - v_target
};

/// A 7-joint arm on a cube waits for a tumbling client of 50 kg.
Plan arm_plan(Flip flip = Flip::None, BaseMode base_mode = BaseMode::Floating);

/// Reading A of the paper's robot, straight, hit by the point mass along the arm: case C2.
Plan straight_plan();

/// Without the time after the impact, over few directions.
inline VerifyOptions quick() {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 200;
  return options;
}

/// Length of the path by eight chords per segment.
double chord_length(const Approach& approach);

}  // namespace stillbase::verification_test
