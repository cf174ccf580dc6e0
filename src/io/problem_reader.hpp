// The problem from a parsed tree to plain data, and back to JSON.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>

#include "io/field_reader.hpp"
#include "io/fields/sections.hpp"

namespace stillbase::io {

/// Reads a problem map. Findings go to the context; the result means something only when there are
/// none.
/// @param path of the map inside its file, "" for a problem file
CaptureProblem read_problem_map(const Node& node, ReadContext& context, const std::string& path,
                                const ProblemSources& sources);

/// The normalised copy: every field of the problem in the order of the file format.
Json problem_json(const CaptureProblem& problem);

/// Findings that take several sections at once, which are good by themselves. Puts the half-angle
/// in place that follows from the covariance of the estimate.
void check_sections(MapReader& map, CaptureProblem& problem);
/// Those that a sticking contact or a latch makes.
void check_rigid_contact(MapReader& map, const CaptureProblem& problem);
/// Those of momentum that the wheels hold before the contact.
void check_wheel_preset(MapReader& map, const CaptureProblem& problem);
/// Those of a hand that moves before the contact.
void check_hand_motion(MapReader& map, const CaptureProblem& problem);

/// Why the nominal value of a quantity cannot be minimised; empty: it can.
std::string objection_to_nominal(const CaptureProblem& problem, ObjectiveQuantity quantity);

}  // namespace stillbase::io
