#include "verification/own_motion.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reference/controlled_motion.hpp"

namespace stillbase::verification {
namespace {

using Law = reference::ControlLaw;

std::optional<Law::Kind> law_of(ControllerKind kind) {
  switch (kind) {
    case ControllerKind::None:
      return Law::Kind::Free;
    case ControllerKind::JointDamping:
      return Law::Kind::JointDamping;
    case ControllerKind::JointDampingLiteral:
      return Law::Kind::JointDampingLiteral;
    case ControllerKind::Rns:
      return Law::Kind::Rns;
    case ControllerKind::RnsDamped:
      return Law::Kind::RnsDamped;
    case ControllerKind::RnsHandback:
    case ControllerKind::Detumble:
      break;
  }
  return std::nullopt;
}

/// What the second code lacks of a run; empty: nothing.
std::string missing(const PostImpactSpec& spec, const SimulationOptions& options,
                    const Controller& controller, const AfterContact& run) {
  if (!law_of(controller.kind)) return "the controller moves momentum to the wheels";
  if (run.encounter) return "the contact is compliant";
  if (spec.joint_friction || controller.friction_compensation) return "joints have friction";
  if (!spec.sensor.are_exact()) return "sensors have errors";
  if (spec.thrusters.exist()) return "thrusters act";
  if (!spec.wheels.preset.isZero(0)) return "wheels hold momentum before the contact";
  const bool knows_another = options.controller_robot || spec.model.target_mass_scale != 1;
  if (run.is_held && knows_another) return "the controller knows another held target";
  for (const LimitEvent& event : run.simulation.summary.limits) {
    if (event.kind != LimitKind::Torque) return "a joint is at its rate limit or at a stop";
  }
  return {};
}

/// Distance of two states: m and rad of poses and joints; velocities relative to the run's largest.
class Deviation {
 public:
  explicit Deviation(const std::vector<TraceSample>& trace) {
    for (const TraceSample& sample : trace) {
      base_size_ = std::max(base_size_, sample.state.Omega.norm());
      joint_size_ = std::max(joint_size_, sample.state.phidot.norm());
    }
  }

  void take(const TraceSample& sample, const reference::Motion& own) {
    const PlantState& state = sample.state;
    const std::string at = fmt::format("{:.3g} s", sample.time);
    const PoseError pose = pose_error(state.base, own.base);
    largest_.take(pose.position, "base position at " + at);
    largest_.take(pose.angle, "base attitude at " + at);
    largest_.take(apart(state.phi, own.state.phi), "joint positions at " + at);
    largest_.take(apart(state.Omega, own.state.Omega) / base_size_, "base velocity at " + at);
    largest_.take(apart(state.phidot, own.state.phidot) / joint_size_, "joint rates at " + at);
  }

  const Largest& largest() const { return largest_; }

 private:
  static double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return (a - b).lpNorm<Eigen::Infinity>();
  }

  /// Rates of rounding size stay of rounding size.
  double base_size_ = 1e-6, joint_size_ = 1e-6;
  Largest largest_;
};

}  // namespace

void check_own_motion(const Context& context, const std::string& controller,
                      const AfterContact& run, ClaimList& claims) {
  constexpr const char* kName = "post_impact_second_integration";
  const PostImpactSpec& spec = context.problem.post_impact;
  const Controller chosen = controller_of(spec, controller).value_or(Controller{});
  const SimulationOptions options = plant_options_of(spec, context.problem.robot);
  const std::string lacks = missing(spec, options, chosen, run);
  if (!lacks.empty()) return claims.not_verified(kName, lacks);

  const RobotModel& known = options.controller_robot ? *options.controller_robot : run.robot;
  const JointResistance& resistance = context.problem.resistance;
  reference::ControlledRobot subject{run.robot, known, {}};
  if (resistance.model == ResistanceModel::RotorInertia) {
    subject.added_inertia = resistance.rotor_inertia;
  }
  const Law law{*law_of(chosen.kind), spec.K_omega,           spec.K_phi,
                chosen.rank_edge,     chosen.joint_rate_edge, options.control_period};

  const std::vector<TraceSample>& trace = run.simulation.trace;
  const PlantState& start = trace.front().state;
  std::vector<double> times;
  for (const TraceSample& sample : trace) times.push_back(sample.time - trace.front().time);
  const auto own = reference::controlled_motion(
      subject, law, {start.base, {start.phi, start.phidot, start.Omega}}, times,
      context.options.second_integration_step_error, context.options.stop);
  if (!own.complete) {
    return claims.not_verified(kName, "the second integration did not reach the horizon");
  }
  Deviation deviation(trace);
  for (std::size_t i = 0; i < trace.size(); ++i) deviation.take(trace[i], own.samples[i]);
  Largest largest = deviation.largest();
  if (law.period > 0) {
    const JointVectord& peaks = run.simulation.summary.peak_demanded_torques;
    const double size = std::max(1e-6, peaks.lpNorm<Eigen::Infinity>());
    const Eigen::VectorXd apart = peaks - own.peak_demanded_torques;
    largest.take(apart.lpNorm<Eigen::Infinity>() / size, "largest demanded torques");
  }
  claims.at_most(kName, largest.value, context.options.second_integration_tolerance, "1",
                 fmt::format("the motion over {} s under {} by a second code; largest: {}",
                             spec.horizon, controller, largest.place));
}

}  // namespace stillbase::verification
