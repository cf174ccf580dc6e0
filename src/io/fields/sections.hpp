// The tables of the formats, one function per section. A table of a section takes the whole problem
// where its fields need the robot or other sections, which are stated before it.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include <stillbase/benchmark/suite.hpp>
#include <stillbase/core/constants.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/plan/problem.hpp>

#include "io/fields/values.hpp"

namespace stillbase {
class RobotAssembly;
struct UnlockedRobot;
}  // namespace stillbase

namespace stillbase::io {

/// Where the files that a problem names come from.
struct ProblemSources {
  std::optional<std::string> urdf = {};    ///< text of the robot file; empty: read it
  std::optional<std::string> folder = {};  ///< relative paths start here; empty: nothing is read
  UnlockedRobot* unlocked = nullptr;       ///< set where joints are locked; may be null
};

void problem_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources);

void robot_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources);
void target_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources);
void impact_fields(Table& t, CaptureProblem& problem);
/// The motion of the hand before the contact.
void contact_fields(Table& t, CaptureProblem& problem);
void variables_fields(Table& t, CaptureProblem& problem);
void objective_fields(Table& t, CaptureProblem& problem);
void uncertainty_fields(Table& t, CaptureProblem& problem);
void approach_fields(Table& t, CaptureProblem& problem);
void post_impact_fields(Table& t, PostImpactSpec& post_impact);
void fields(Table& t, Obstacle& obstacle);

/// Standard deviations of the estimate of a target.
void fields(Table& t, EstimateDeviations& deviations);

/// {ixx, iyy, izz, ixy, ixz, iyz} of a body that is possible.
void inertia_fields(Table& t, Matrix3d& inertia);

/// The parts of a robot that is put together: the base's body, arms, locked joints, limits.
void base_body_fields(Table& t, std::optional<BaseBody>& body, bool& is_homogeneous);
void fields(Table& t, MountedArm& arm);
/// @param assembly knows the joints; null: any joint, in SI units
Value locked_of(std::map<std::string, double>& locked, const RobotAssembly* assembly);
Value limits_of(std::map<std::string, JointLimits>& limits, const RobotAssembly* assembly);
Value rotors_of(std::map<std::string, JointRotor>& rotors);

/// The keys of a body: name, model, mass, inertia, shapes, features.
void target_body_fields(Table& t, TargetBody& body);
/// A target file.
void target_file_fields(Table& t, TargetBody& body);

void campaign_fields(Table& t, CampaignSpec& spec);
/// @param folder in which the files that the suite names are read; empty: none is read
void suite_fields(Table& t, SuiteSpec& suite, const std::optional<std::string>& folder);

constexpr int kMany = std::numeric_limits<int>::max();  ///< no limit of a count
constexpr int kManyTimes = 1'000'000'000;

}  // namespace stillbase::io
