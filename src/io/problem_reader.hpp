// The problem as a parsed tree to plain data.
#pragma once

#include <optional>
#include <string>

#include <stillbase/plan/problem.hpp>

#include "io/field_reader.hpp"

namespace stillbase::io {

/// Where the files that a problem names come from.
struct ProblemSources {
  std::optional<std::string> urdf = {};  ///< text of the robot file; empty: read it
  std::optional<std::string> folder =
      {};  ///< relative paths start here; empty: nothing may be read
};

/// Reads a problem map. Findings go to the context; the result means something only when there are
/// none.
/// @param path of the map inside its file, "" for a problem file
CaptureProblem read_problem_map(const Node& node, ReadContext& context, const std::string& path,
                                const ProblemSources& sources);

/// A section; absent it is an empty map, so that its keys are known and its defaults stand.
MapReader section(MapReader& map, const std::string& key);

/// A word or a number; not for null.
bool is_scalar(const Node* node);

// One function per section (*_section*.cpp). `map` is that of the whole problem.

void read_impact_section(MapReader& map, CaptureProblem& problem);
void read_variables_section(MapReader& map, CaptureProblem& problem);
void read_objective_section(MapReader& map, CaptureProblem& problem);
void read_hand_section(MapReader& map, CaptureProblem& problem);
void read_constraints_section(MapReader& map, CaptureProblem& problem);
void read_uncertainty_section(MapReader& map, CaptureProblem& problem);
void read_search_section(MapReader& map, CaptureProblem& problem);
void read_approach_section(MapReader& map, CaptureProblem& problem);
void read_post_impact_section(MapReader& map, CaptureProblem& problem);
void read_obstacles_section(MapReader& map, CaptureProblem& problem);

/// One number per joint: a list of n, a map that names every joint, or, when `may_be_uniform`, one
/// number for all. Angles and lengths go by the kind of the joint.
/// @param revolute, prismatic the dimension at a joint of that kind
void read_joint_values(MapReader& map, const std::string& key, const RobotModel& robot,
                       Dimension revolute, Dimension prismatic, const Range& range,
                       bool may_be_uniform, Need need, JointVectord& out);

/// Flags per joint: `all`, `none` or a list of names.
void read_joint_flags(MapReader& map, const std::string& key, const RobotModel& robot, Need need,
                      std::vector<bool>& out);

/// The keys that the model of a joint resistance needs.
void read_resistance_values(MapReader& map, const RobotModel& robot, JointResistance& resistance);

std::vector<std::string> joint_names(const RobotModel& robot);
std::vector<std::string> link_names(const RobotModel& robot);

/// Findings that need several sections at once.
void check_problem(MapReader& map, const CaptureProblem& problem);
/// The same of what is minimised: asked once the cone of directions is known.
void check_objective(MapReader& map, const CaptureProblem& problem);

}  // namespace stillbase::io
