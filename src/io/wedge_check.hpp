// A wedge (cone_plane) stands for all directions only where everything stays in its plane.
#pragma once

#include <stillbase/plan/problem.hpp>

#include "io/field_reader.hpp"

namespace stillbase::io {

/// Finds what leaves the plane of the wedge: arm, base, impulse, target, or an error of the
/// target's estimate.
/// @pre the problem's sections are good and fit together
void check_wedge(MapReader& map, const CaptureProblem& problem);

}  // namespace stillbase::io
