#include "io/json_impact.hpp"

#include "io/fields/plan.hpp"

namespace stillbase::io {

Json impact_json(const ImpactSummary& impact, const RobotModel& robot) {
  ImpactSummary copy = impact;
  TableWriter writer;
  impact_object_fields(writer, copy, robot);
  return writer.json;
}

}  // namespace stillbase::io
