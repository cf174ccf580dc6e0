#include "verification/own_motion.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reference/controlled_motion.hpp"
#include "verification/contact_case.hpp"

namespace stillbase::verification {
namespace {

using Law = reference::ControlLaw;

/// The second integration against the first.
struct OwnMotionOptions {
  double lead = 0.01;  ///< s before a contact that takes time; less where the period of control is
  /// Rates, momenta and torques (SI) that are smaller are compared as if of this size: those of
  /// rounding size stay of rounding size.
  double least_size = 1e-6;
};
constexpr OwnMotionOptions kOwnMotion;

constexpr std::pair<ControllerKind, Law::Kind> kLaws[] = {
    {ControllerKind::None, Law::Kind::Free},
    {ControllerKind::JointDamping, Law::Kind::JointDamping},
    {ControllerKind::JointDampingLiteral, Law::Kind::JointDampingLiteral},
    {ControllerKind::Rns, Law::Kind::Rns},
    {ControllerKind::RnsDamped, Law::Kind::RnsDamped},
    {ControllerKind::RnsHandback, Law::Kind::RnsHandback},
    {ControllerKind::Detumble, Law::Kind::Detumble},
};

Law law_of(const Controller& controller, const PostImpactSpec& spec) {
  Law law;
  for (const auto& [kind, law_kind] : kLaws) {
    if (kind == controller.kind) law.kind = law_kind;
  }
  law.K_omega = spec.K_omega;
  law.K_phi = spec.K_phi;
  law.rank_edge = controller.rank_edge;
  law.joint_rate_edge = controller.joint_rate_edge;
  law.period = spec.control_period;
  law.handback_start = spec.handback_start;
  law.K_handback = spec.handback_gain;
  law.K_detumble = controller.K_detumble;
  law.reserve = controller.reserve;
  if (spec.model.friction_scale > 0) law.friction_rate = controller.friction_transition_rate;
  return law;
}

/// What the second code lacks of a run; empty: nothing.
std::string missing(const CaptureProblem& problem, const AfterContact& run) {
  if (run.is_held && problem.robot.hand_body == kBase) return "the base itself holds the target";
  if (problem.post_impact.control_period > 0) return {};
  for (const LimitEvent& event : run.simulation.summary.limits) {
    if (event.kind == LimitKind::Rate) {
      return "a joint is at its rate limit, and its torque may change at every instant";
    }
  }
  return {};
}

/// The robot as the controllers know it.
RobotModel known_robot(const CaptureProblem& problem) {
  const ControllerModelSpec& model = problem.post_impact.model;
  RobotModel known = problem.robot;
  known.base.mass *= model.base_mass_scale;
  known.base.inertia *= model.base_mass_scale;
  for (Body& body : known.bodies) {
    body.mass *= model.arm_mass_scale;
    body.inertia *= model.arm_mass_scale;
  }
  // Without compensation the laws do not ask for friction.
  for (Joint& joint : known.joints) {
    joint.viscous_friction *= model.friction_scale;
    joint.coulomb_friction *= model.friction_scale;
  }
  return known;
}

/// Hand and target before a compliant contact, its damping from the restitution unless stated.
struct CompliantStart {
  reference::SpringContact contact;
  reference::BodyMotion target;  ///< `lead` before the contact, by uniform motion
  double lead = 0;               ///< s

  explicit CompliantStart(const Context& context) {
    const Situation& at = context.situation;
    const CaptureProblem& problem = context.problem;
    const ContactSpec& spec = problem.post_impact.contact;
    const ContactCase subject =
        contact_case(problem, at.target(), at.event, at.response, at.at, at.event.n, at.impulse());
    const TargetAtContact& met = *subject.target;
    contact.mass = met.body.mass;
    contact.inertia = met.body.inertia;
    contact.stiffness = spec.stiffness;
    contact.friction = spec.friction;
    const double e = problem.impulse.restitution;
    contact.damping =
        spec.damping ? *spec.damping
                     : reference::damping_for(e, spec.stiffness,
                                              subject.impulse / ((1 + e) * subject.closing_speed));
    const Eigen::Quaterniond R_TN = met.state.pose.orientation.conjugate();
    contact.point = R_TN * Vector3d(at.hand_N - met.state.pose.position);
    contact.normal = R_TN * subject.normal_N;
    if (problem.resistance.model == ResistanceModel::Servo) {
      contact.servo_stiffness = problem.resistance.stiffness;
      contact.servo_damping = problem.resistance.damping;
      contact.servo_posture = at.at.phi;
    }
    lead = std::min(problem.post_impact.control_period, kOwnMotion.lead);
    target = {met.state.pose, met.state.velocity, met.state.angular_velocity};
    target.pose.position -= lead * target.velocity;
    const double angle = lead * target.rate.norm();
    if (angle > 0) {
      target.pose.orientation =
          target.pose.orientation * Eigen::AngleAxisd(-angle, target.rate.normalized());
    }
  }
};

/// The target that a latch leaves in the hand, in the hand's axes.
reference::MetBody held_body(const Context& context) {
  reference::MetBody body = met_body(context.problem, context.situation.event);
  const Matrix3d R = context.situation.response.dynamics.hand_rotation;
  body.inertia = (R.transpose() * body.inertia * R).eval();
  body.r = (R.transpose() * body.r).eval();
  return body;
}

/// The robots of the problem that take part, and what they are fitted with.
struct Subject {
  RobotModel robot, known_empty, known;

  Subject(const Context& context, const AfterContact& run)
      : robot(context.problem.robot),
        known_empty(known_robot(context.problem)),
        known(known_empty),
        problem_(context.problem),
        is_held_(run.is_held) {
    if (!is_held_) return;
    reference::MetBody body = held_body(context);
    robot = reference::holding(robot, body);
    body.mass *= problem_.post_impact.model.target_mass_scale;
    body.inertia *= problem_.post_impact.model.target_mass_scale;
    known = reference::holding(known_empty, body);
  }

  reference::ControlledRobot view() const {
    const PostImpactSpec& spec = problem_.post_impact;
    reference::ControlledRobot out{robot, known, {}};
    if (problem_.resistance.model == ResistanceModel::RotorInertia) {
      out.added_inertia = problem_.resistance.rotor_inertia;
    }
    if (is_held_ && spec.grip.is_limited()) {
      out.known_empty = &known_empty;
      out.grip_force = spec.grip.force.value_or(kInfinity);
      out.grip_moment = spec.grip.moment.value_or(kInfinity);
    }
    out.wheels = {spec.wheels.torque, spec.wheels.momentum};
    out.thrusters = {spec.thrusters.torque, spec.thrusters.gain, spec.thrusters.dead_band};
    if (!spec.sensor.are_exact()) {
      const auto delay = std::lround(spec.sensor.delay / spec.control_period);
      out.sensors = reference::Sensors{spec.sensor.base_rate_error,
                                       spec.sensor.joint_position_error,
                                       spec.sensor.joint_rate_error,
                                       static_cast<std::size_t>(delay),
                                       spec.sensor.seed,
                                       spec.sensor.stream};
    }
    out.has_friction = spec.joint_friction;
    out.stop_restitution = spec.stop_restitution;
    return out;
  }

 private:
  const CaptureProblem& problem_;
  bool is_held_;
};

/// Distance of two states: m and rad of poses and joints; velocities relative to the run's largest.
class Deviation {
 public:
  explicit Deviation(const std::vector<TraceSample>& trace) {
    for (const TraceSample& sample : trace) {
      base_size_ = std::max(base_size_, sample.state.Omega.norm());
      joint_size_ = std::max(joint_size_, sample.state.phidot.norm());
      momentum_size_ =
          std::max({momentum_size_, sample.total.norm(), sample.state.wheel_momentum.norm()});
      if (!sample.target) continue;
      target_size_ = std::max(target_size_, sample.target->velocity.norm());
      spin_size_ = std::max(spin_size_, sample.target->angular_velocity.norm());
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
    largest_.take(apart(state.wheel_momentum, own.wheel_momentum) / momentum_size_,
                  "momentum of the wheels at " + at);
    if (!sample.target || !own.target) return;
    const PoseError target = pose_error(sample.target->pose, own.target->pose);
    largest_.take(target.position, "target's position at " + at);
    largest_.take(target.angle, "target's attitude at " + at);
    largest_.take(apart(sample.target->velocity, own.target->velocity) / target_size_,
                  "target's velocity at " + at);
    largest_.take(apart(sample.target->angular_velocity, own.target->rate) / spin_size_,
                  "target's rotation at " + at);
  }

  const Largest& largest() const { return largest_; }

 private:
  static double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return (a - b).lpNorm<Eigen::Infinity>();
  }

  double base_size_ = kOwnMotion.least_size, joint_size_ = kOwnMotion.least_size;
  double momentum_size_ = kOwnMotion.least_size, target_size_ = kOwnMotion.least_size;
  double spin_size_ = kOwnMotion.least_size;
  Largest largest_;
};

}  // namespace

void check_own_motion(const Context& context, const std::string& controller,
                      const AfterContact& run, ClaimList& claims) {
  constexpr const char* kName = "post_impact_second_integration";
  const PostImpactSpec& spec = context.problem.post_impact;
  const std::string lacks = missing(context.problem, run);
  if (!lacks.empty()) return claims.not_verified(kName, lacks);

  const Subject subject(context, run);
  const Law law = law_of(controller_of(spec, controller).value_or(Controller{}), spec);
  const std::vector<TraceSample>& trace = run.simulation.trace;
  const PlantState& start = trace.front().state;
  reference::Motion first{start.base, {start.phi, start.phidot, start.Omega}, spec.wheels.preset};
  reference::ControlledRobot robot = subject.view();
  double lead = 0;
  if (run.encounter) {
    const CompliantStart contact(context);
    robot.contact = contact.contact;
    first.target = contact.target;
    lead = contact.lead;
  }
  std::vector<double> times;
  times.reserve(trace.size());
  for (const TraceSample& sample : trace) times.push_back(sample.time + lead);
  const auto own = reference::controlled_motion(robot, law, first, times,
                                                context.options.second_integration_step_error,
                                                context.options.stop);
  if (own.has_two_at_stops) {
    return claims.not_verified(kName, "two joints are at their stops at once");
  }
  if (!own.complete) {
    return claims.not_verified(kName, "the second integration did not reach the horizon");
  }
  Deviation deviation(trace);
  for (std::size_t i = 0; i < trace.size(); ++i) deviation.take(trace[i], own.samples[i]);
  Largest largest = deviation.largest();
  const auto compare_peaks = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                                 const char* what) {
    largest.take((a - b).lpNorm<Eigen::Infinity>() /
                     std::max(kOwnMotion.least_size, a.lpNorm<Eigen::Infinity>()),
                 what);
  };
  const SimulationSummary& summary = run.simulation.summary;
  compare_peaks(summary.peak_demanded_torques, own.peak_demanded_torques,
                "largest demanded torques");
  compare_peaks(summary.peak_wheel_torques, own.peak_wheel_torques,
                "largest torques of the wheels");
  claims.at_most(kName, largest.value, context.options.second_integration_tolerance, "1",
                 fmt::format("the motion over {} s under {} by a second code; largest: {}",
                             spec.horizon, controller, largest.place));
}

}  // namespace stillbase::verification
