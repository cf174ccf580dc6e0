// The same impact with the joints resisting in different ways, side by side.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/summary.hpp>

namespace stillbase {

/// A joint resistance to compare.
struct ComparedResistance {
  JointResistance resistance;
  /// The values are not the problem's: only there to show how large the effect can be.
  bool is_illustrative = false;
};

/// Free, rotor inertia, servo and all joints locked, in this order. The stated resistance takes its
/// model's place; stated rotor inertia or servo values are kept even when the model is another one
/// (sizes n). What is not stated is illustrative, on the scale of the joint's own inertia Hhat_kk
/// at the posture: a rotor inertia of Hhat_kk; a servo that would hold the joint alone critically
/// damped at 10 Hz, over a contact of 10 ms. Locked joints of the stated resistance stay the stated
/// ones.
std::vector<ComparedResistance> resistances_to_compare(const RobotModel& robot,
                                                       const JointVectord& phi,
                                                       const JointResistance& stated);

/// The impulse at a hand with inverse inertia W_h (6x6): resisting joints make the hand heavier, so
/// the impulse of a contact depends on them.
using ImpulseLaw = std::function<ContactImpulse(const Matrix6d& W_h)>;

/// The impact of one law under each resistance (same order).
std::vector<ImpactSummary> compare_resistances(const RobotModel& robot, const JointVectord& phi,
                                               const std::vector<JointResistance>& resistances,
                                               const ImpulseLaw& law,
                                               double case_tolerance = kCaseTolerance);

}  // namespace stillbase
