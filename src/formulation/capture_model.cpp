// The kernel on double.
#include "formulation/capture_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/error.hpp>

#include "formulation/capture_model_kernel.hpp"

namespace stillbase {

STILLBASE_INSTANTIATE_CAPTURE_MODEL(double);

PostureImpact<double> CaptureModel::hand(const Placement<double>& at) const {
  return evaluate_hand<double>(problem.robot, at.phi);
}

CaptureModel::CaptureModel(const CaptureProblem& p, const EncounterModel& known)
    : problem(p),
      layout(p),
      resistance(prepare_resistance(p.resistance, p.robot.n())),
      encounter(known),
      nominal(nominal_scenario(encounter)) {
  const auto refuse = [&p](const std::string& rule, const std::string& message) {
    throw InputError({Finding{p.source, 0, rule, message}});
  };
  if (layout.size == 0)
    refuse("no-variables",
           "variables: nothing is free to be planned; free joints, base_attitude, base_position or "
           "contact_time, or use `stillbase analyze`");
  if (!p.uncertainty.residual_velocity) return;
  if (!encounter.follows_target() || encounter.magnitude_is_given()) {
    refuse("not-used",
           "uncertainty.residual_velocity: is that of a target whose motion makes the impulse");
  }
  try {
    residual.emplace(p);
  } catch (const std::invalid_argument& error) {
    refuse("out-of-range", std::string("uncertainty.residual_velocity: ") + error.what());
  }
}

Configuration CaptureModel::configuration(const Eigen::VectorXd& x) const {
  Configuration out;
  out.feature = problem.variables.feature;
  write_configuration(x, out);
  return out;
}

void CaptureModel::write_configuration(const Eigen::VectorXd& x, Configuration& out) const {
  out.phi = layout.joint_positions(problem, x);
  out.base = problem.base;
  out.base.orientation = layout.attitude_of(problem, x);
  out.contact_time = layout.contact_time(problem, x);
  const bool follows = problem.variables.base_position != PositionFreedom::Fixed;
  const std::optional<Vector3d>& stated = encounter.hand_point;
  const bool stated_in_N = stated && encounter.hand_frame == Frame::Inertial;
  if (follows && (encounter.hand_follows_target() || stated_in_N)) {
    const Vector3d point = stated ? *stated : place<double>(x).contact.point;
    const auto kinematics = compute_kinematics<double>(problem.robot, out.phi);
    out.base.position = point - out.base.orientation * kinematics.r_bh;
  }
}

double CaptureModel::horizon_from(double estimate_time) const {
  constexpr double kRounding = 1e-6;  // s: a target needs some horizon in any case
  const VariableSpec& variables = problem.variables;
  const double longest = std::max(std::abs(variables.contact_time_upper - estimate_time),
                                  std::abs(variables.contact_time_lower - estimate_time));
  return longest + problem.uncertainty.contact_time + kRounding;
}

void CaptureModel::reserve_motion(double rotation) {
  latest_motion.emplace();
  latest_motion->body = *problem.target;
  latest_motion->reserve(rotation);
  set_target_state(problem.target_state);
}

void CaptureModel::set_target_state(const TargetState& estimate) {
  latest_motion->restart(estimate, horizon_from(estimate.time));
  problem.target_state = estimate;
}

}  // namespace stillbase
