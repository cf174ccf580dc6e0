// How near a posture is to one in which the joint rates of a hand that moves are undetermined.
#pragma once

#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// Of the Jacobian from joint rates to the decided components of the hand's velocity, the robot
/// without momentum: its least singular value over the largest, [0, 1]; 1 for a hand at rest.
double match_condition(const Situation& at);

}  // namespace stillbase::verification
