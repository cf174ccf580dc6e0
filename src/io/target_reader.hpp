// Bodies that are not the robot: target, its motion, obstacles.
#pragma once

#include <stillbase/target/prediction.hpp>
#include <stillbase/target/target.hpp>

#include "io/field_reader.hpp"

namespace stillbase::io {

/// {sphere: {radius}}, {capsule: {radius, length}}, {cylinder: {radius, length}}, {box: {size}} or
/// {convex_mesh: {vertices, faces}}.
std::optional<Geometry> read_geometry(ReadContext& context, const Node& node,
                                      const std::string& path);

/// The keys of a body (name, model, mass, inertia, shapes, features); the caller finishes the map.
TargetBody read_target_body(MapReader& map);

/// A target file, `format: stillbase.target`.
TargetBody read_target_file(const Node& node, ReadContext& context);

/// The map `target.state`.
/// @param deviations set when the state says how well it is known
TargetState read_target_state(ReadContext& context, const Node& node, const std::string& path,
                              std::optional<EstimateDeviations>& deviations);

/// format and version, stated first in every file.
void read_format(MapReader& map, const std::string& format);

}  // namespace stillbase::io
