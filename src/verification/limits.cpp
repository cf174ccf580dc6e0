#include "verification/limits.hpp"

#include <cmath>

#include <stillbase/core/constants.hpp>

#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

Eigen::VectorXd single(double value) { return Eigen::VectorXd::Constant(1, value); }

Ends at_least(double least) { return {least, kInfinity}; }

Ends within(double most) { return {-most, most}; }

/// A given impulse has a closing speed only where the target's motion does.
bool has_closing_speed(const CaptureProblem& problem) {
  const VariableSpec& free = problem.variables;
  const bool varies =
      !problem.impulse.direction && free.contact_time_upper > free.contact_time_lower;
  return varies || problem.impulse.source != ImpulseSource::Given;
}

bool has_joint_rates(const CaptureProblem& problem) {
  const ConstraintSpec& wanted = problem.constraints;
  return wanted.joint_rate_scale || wanted.joint_rate_max.size() > 0;
}

double joint_rate_limit(const CaptureProblem& problem, int joint) {
  const ConstraintSpec& wanted = problem.constraints;
  if (wanted.joint_rate_max.size() == problem.robot.n()) return wanted.joint_rate_max[joint];
  if (!wanted.joint_rate_scale) return kInfinity;
  return problem.robot.joints[joint].max_velocity * *wanted.joint_rate_scale;
}

}  // namespace

const std::vector<LimitRecord>& limit_records() {
  static const std::vector<LimitRecord> kRecords = {
      {.name = "closing_speed",
       .unit = "m/s",
       .is_always_listed = true,
       .is_set = has_closing_speed,
       .range = [](const CaptureProblem& p,
                   int) { return at_least(p.constraints.closing_speed_min); },
       .values =
           [](const Situation& at) {
             return single(closing_speed(at.problem, at.event, at.event.n));
           }},
      {.name = "contact_push",
       .unit = "N s",
       .is_set = [](const CaptureProblem& p) { return p.impulse.contact == ContactLaw::Sticking; },
       .range = [](const CaptureProblem&, int) { return at_least(0); },
       .values =
           [](const Situation& at) { return single(at.event.n.dot(at.impulse().head<3>())); }},
      {.name = "joint_rate_",
       .unit = "rad/s",
       .is_of_joints = true,
       .is_set = has_joint_rates,
       .range = [](const CaptureProblem& p,
                   int joint) { return within(joint_rate_limit(p, joint)); },
       .values = [](const Situation& at) { return at.response.impact(at.impulse()).Delta_phidot; },
       .check = "joint_rate_limits",
       .words = "furthest beyond its rate limit right after the impact: "},
      {.name = "arrival_rate_",
       .unit = "rad/s",
       .is_of_joints = true,
       .is_set = [](const CaptureProblem& p) { return p.hand_motion.moves(); },
       .range = [](const CaptureProblem& p,
                   int joint) { return within(arrival_rate_limit(p, joint)); },
       .values =
           [](const Situation& at) {
             const auto& before = at.response.before;
             return before ? before->phidot : Eigen::VectorXd();
           }},
      {.name = "coupling_singular_value",
       .unit = "kg m^2",
       .is_set =
           [](const CaptureProblem& p) { return p.constraints.coupling_singular_value_min > 0; },
       .range = [](const CaptureProblem& p,
                   int) { return at_least(p.constraints.coupling_singular_value_min); },
       .values = [](const Situation& at) { return single(coupling_singular_value(at.response)); },
       .check = "coupling_singular_value",
       .words = "smallest one of the coupling matrix"},
      {.name = "jacobian_singular_value",
       .unit = "m",
       .is_set =
           [](const CaptureProblem& p) { return p.constraints.jacobian_singular_value_min > 0; },
       .range = [](const CaptureProblem& p,
                   int) { return at_least(p.constraints.jacobian_singular_value_min); },
       .values =
           [](const Situation& at) {
             const double length = at.problem.constraints.jacobian_length;
             return single(jacobian_singular_value(at.response, length));
           },
       .check = "jacobian_singular_value",
       .words = "smallest one of the generalized Jacobian"},
  };
  return kRecords;
}

std::vector<ContactLimit> numbers_of(const LimitRecord& record, const Situation& situation) {
  const CaptureProblem& problem = situation.problem;
  const Eigen::VectorXd values = record.values(situation);
  std::vector<ContactLimit> out;
  for (int k = 0; k < values.size(); ++k) {
    out.push_back({record.name, record.unit, "", record.range(problem, k), values[k],
                   record.is_always_listed});
    if (!record.is_of_joints) continue;
    const Joint& joint = problem.robot.joints[k];
    out.back().joint = joint.name;
    out.back().name += joint.name;
    if (joint.is_prismatic()) out.back().unit = "m/s";
  }
  return out;
}

std::vector<ContactLimit> limits_of(const LimitRecord& record, const Situation& situation) {
  if (!record.is_set(situation.problem)) return {};
  std::vector<ContactLimit> out = numbers_of(record, situation);
  std::erase_if(out, [](const ContactLimit& limit) {
    return !std::isfinite(limit.range.lower) && !std::isfinite(limit.range.upper);
  });
  return out;
}

}  // namespace stillbase::verification
