// The result of `replan`: a stream of estimates played to a replanner.
#pragma once

#include <string>
#include <vector>

#include <stillbase/planner/replanner.hpp>

#include "io/fields/table.hpp"

namespace stillbase::io {

struct ReplanUpdate {
  double time = 0;  ///< of the estimate, s
  ReplanResult result;
};

struct ReplanRecord {
  std::string problem;  ///< its name
  std::string objective, unit;
  RobotModel robot;
  Configuration start;       ///< of the plan
  std::string after_impact;  ///< what is said of the last posture's time after the impact
  bool with_seconds = false;
  std::vector<ReplanUpdate> updates;
};
void replan_fields(Table& t, ReplanRecord& record);

/// The constraint that is nearest to its limit, equations left out; null: there is none.
const ConstraintValue* tightest_constraint(const ReplanResult& result);

}  // namespace stillbase::io
