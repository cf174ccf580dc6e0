// The impact object that plans, inspect and analyze share.
#pragma once

#include <stillbase/impact/summary.hpp>

#include "io/json.hpp"

namespace stillbase::io {

/// The impact object of the file formats, in B.
/// @throws NotFiniteError
Json impact_json(const ImpactSummary& impact, const RobotModel& robot);

}  // namespace stillbase::io
