// The motion of a plan as the page plays it: columns with one element per sample.
//
// times, joints, rates, torques (n each), base (pose), base_rates (6), target (pose), rns (n; the
// rates' part in the angular reaction null space), momenta (norms of base part, coupling part and
// total), distances and closing_speeds (hand to contact feature). SI units.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

#include "io/json.hpp"

namespace stillbase::app {

/// Six significant digits: finer than a screen, a third of the bytes. Null: not finite.
io::Json rounded(double x);
io::Json rounded_list(const Eigen::Ref<const Eigen::VectorXd>& v);
/// [x, y, z, qw, qx, qy, qz], the quaternion with nine digits: the page multiplies poses.
io::Json pose_json(const Pose& pose);

/// The stored samples of the approach, those of the wait every 0.1 s, and beside the columns
/// `clearances` and `pairs`: the closest pair that may not touch, "a with b", and `nearest`: its
/// closest points [on a, on b], each in the frame of what carries it (body of the link, base, T or
/// N), null where they overlap.
/// @pre the plan's problem has the chosen contact feature
io::Json approach_json(const Plan& plan);

/// The time after the impact under one controller, every 20 ms in the first second, every 50 ms
/// later; `controller`, `status`, and `held`: the target stays in the hand.
/// @pre as approach_json()
io::Json after_json(const Plan& plan, const std::string& controller, const StopCondition& stop);

}  // namespace stillbase::app
