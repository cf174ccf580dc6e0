// The impact object that plans, inspect and analyze share, and one joint-space list.
#pragma once

#include <stillbase/impact/summary.hpp>

#include "io/field_reader.hpp"
#include "io/json.hpp"

namespace stillbase::io {

/// The impact object of the file formats, in B.
/// @throws std::invalid_argument for a number that is not finite
Json impact_json(const ImpactSummary& impact, const RobotModel& robot);

/// Reads it back. Findings go to the context.
ImpactSummary read_impact_object(ReadContext& context, const Node& node, const std::string& path,
                                 const RobotModel& robot);

/// A list of n numbers in joint order; `out` keeps its value when it is not one.
void read_joint_list(MapReader& map, const std::string& key, int n, JointVectord& out);

}  // namespace stillbase::io
