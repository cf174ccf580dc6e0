// The tables of plan files and of what they share with other results.
#pragma once

#include <string>

#include <stillbase/impact/summary.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/state_file.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

inline const About kOwnUnit = needed("its own");  ///< of a constraint

/// A plan file. @param verification text of the object under `verification`; empty: none. It is
/// written, and not read.
void plan_fields(Table& t, PlanFile& file, const std::string& verification);

// Parts of it.
void certificate_fields(Table& t, const CaptureProblem& problem, Certificate& certificate);
void approach_result_fields(Table& t, const CaptureProblem& problem, Approach& approach);

/// A number per joint.
inline const About kPerJoint = needed("rad (m)");

/// A quaternion of a plan was written by a program: it is a unit quaternion to rounding and is kept
/// bit for bit, or somebody has changed it.
Map written_pose(Pose& pose);

/// Joint positions, base pose and contact time.
void posture_fields(Table& t, const RobotModel& robot, Configuration& configuration);

/// What joints do after the horizon of a simulation.
void after_horizon_fields(Table& t, AfterHorizon& after);
void managed_momentum_fields(Table& t, ManagedMomentum& managed);

/// The impact object of plans, `inspect` and `analyze`, in B.
void impact_object_fields(Table& t, ImpactSummary& impact, const RobotModel& robot);

/// An impulse [f; t] on the hand, in B.
Map impulse_of(Vector6d& F);
/// Angular momentum and its parts.
Map momentum_split(Vector3d& total, Vector3d& base, Vector3d& coupling);

/// A state of the robot; empty: joints of any number and kind.
void state_fields(Table& t, RobotState& state, const RobotModel* robot);

}  // namespace stillbase::io
