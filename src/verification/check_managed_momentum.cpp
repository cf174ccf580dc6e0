// The momentum that a plan has to manage, and the limits that this takes up, recomputed.
#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/contact_case.hpp"
#include "verification/grip_load.hpp"
#include "verification/limit_uses.hpp"

namespace stillbase::verification {
namespace {

/// How well two integrations agree on what the momentum takes up.
struct ManagedMomentumOptions {
  /// Relative, between two integrations, which see their extremes at different instants.
  double extremes = 1e-3;
  double no_momentum = 1e-9;  ///< of the momentum: an axis without any has its rounding
  double no_rotation = 1e-6;  ///< of the momenta that cancel: by the planner's integration
  /// Parts of a limit: what two integrations may see on either side of kNearLimit, and what the
  /// samples miss of a load that crosses it.
  double integrations = 1e-4, samples = 0.01;
};
constexpr ManagedMomentumOptions kManaged;

constexpr const char* kAxes[] = {"x", "y", "z"};

bool is_latched(const CaptureProblem& problem, const Vector6d& Fbar) {
  return problem.impulse.contact == ContactLaw::Latch && !Fbar.isZero(0);
}

/// Of a latched target its spin and both masses' motion about their common centroid, else the
/// impulse's moment about the robot's centroid; the robot rests before the contact.
Vector3d angular_momentum(const Situation& at, const Vector6d& Fbar) {
  const Vector3d hand = at.response.dynamics.hand_position;
  // A response that holds the target has the common centroid.
  const Vector3d centroid =
      reference::compute(at.problem.robot, {at.at.phi, {}, Vector6d::Zero()}).centroid;
  if (!is_latched(at.problem, Fbar)) {
    const Vector3d f = Fbar.head<3>();
    return (hand - centroid).cross(f) + Fbar.tail<3>();
  }
  const reference::MetBody body = met_body(at.problem, at.event);
  const double m = body.mass, M = at.problem.robot.total_mass();
  const Vector3d apart = hand - body.r - centroid;
  return body.inertia * body.omega + (M * m / (M + m)) * apart.cross(body.velocity);
}

/// N m s: of an axis this much is rounding.
double no_momentum(const Situation& at, const Vector3d& angular) {
  return kManaged.no_momentum * (angular.norm() + at.response.rounding_scale(at.impulse()));
}

using Uses = LimitUses;

void add_joints(const RobotModel& robot, const Eigen::VectorXd& sizes, CaptureLimit limit,
                double Joint::*most, const char* unit, const char* prismatic_unit, Uses& uses) {
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    if (!std::isfinite(joint.*most) || joint.*most <= 0) continue;
    uses[limit].push_back({limit, joint.name, std::abs(sizes(k)), joint.*most,
                           joint.is_prismatic() ? prismatic_unit : unit});
  }
}

void add_reach(const Situation& situation, Uses& uses) {
  const RobotModel& robot = situation.problem.robot;
  const std::vector<Pose> bodies = reference::body_poses(robot, situation.at.phi);
  const Vector3d hand = situation.response.dynamics.hand_position;
  std::vector<int> way;  // bodies from the hand inwards
  for (int b = robot.hand_body; b != kBase; b = robot.tree()[b].parent) way.push_back(b);
  if (way.empty()) return;
  double longest = robot.p_hand.norm();
  for (const int b : way) {
    const Joint& joint = robot.tree()[b];
    if (b != way.back()) longest += joint.p.norm();
    if (joint.is_prismatic()) longest += std::max(-joint.lower, joint.upper);
  }
  if (!std::isfinite(longest)) return;
  const double apart = (hand - bodies[way.back()].position).norm();
  uses[CaptureLimit::Reach].push_back({CaptureLimit::Reach, robot.hand, apart, longest, "m"});
}

/// @param nothing N m s: no_momentum()
void add_wheels(const PostImpactSpec& spec, const Vector3d& angular, double nothing,
                const AfterContact* run, Uses& uses) {
  const bool unloads_arm =
      chooses(spec, ControllerKind::RnsHandback) || chooses(spec, ControllerKind::Detumble);
  const bool take_all = unloads_arm && !(spec.thrusters.torque > 0);
  for (int i = 0; i < 3 && spec.wheels.exist(); ++i) {
    const double torque = spec.wheels.torque(i);
    double held = std::abs(spec.wheels.preset(i));
    if (take_all) held = std::max(held, std::abs(spec.wheels.preset(i) + angular(i)));
    if (run != nullptr && torque > 0) {
      const SimulationSummary& summary = run->simulation.summary;
      held = std::max(held, summary.peak_wheel_momenta(i));
      uses[CaptureLimit::WheelTorque].push_back(
          {CaptureLimit::WheelTorque, kAxes[i], summary.peak_wheel_torques(i), torque, "N m"});
    }
    if (torque <= 0 && held <= nothing) continue;
    const double capacity = torque > 0 ? spec.wheels.momentum(i) : 0;
    if (capacity >= kAnyWheelMomentum) continue;
    uses[CaptureLimit::WheelMomentum].push_back(
        {CaptureLimit::WheelMomentum, kAxes[i], held, capacity, "N m s"});
  }
}

/// max_i |h_i| / tau_i.
std::optional<double> least_time(const WheelSpec& wheels, const Vector3d& angular, double nothing) {
  if (!wheels.exist()) return std::nullopt;
  double time = 0;
  for (int i = 0; i < 3; ++i) {
    const double h = std::abs(angular(i));
    if (h <= nothing) continue;
    if (wheels.torque(i) <= 0) return std::nullopt;
    time = std::max(time, h / wheels.torque(i));
  }
  return time;
}

Uses all_uses(const Situation& situation, const Vector3d& angular, const AfterContact* run) {
  const CaptureProblem& problem = situation.problem;
  const RobotModel& robot = problem.robot;
  const Configuration& at = situation.at;
  Uses uses;
  add_reach(situation, uses);
  const Eigen::VectorXd after = situation.response.impact(situation.impulse()).Delta_phidot;
  const SimulationSummary none;
  const SimulationSummary& summary = run == nullptr ? none : run->simulation.summary;
  const Eigen::VectorXd rates = run == nullptr ? after : Eigen::VectorXd(summary.peak_joint_rates);
  add_joints(robot, rates, CaptureLimit::JointRate, &Joint::max_velocity, "rad/s", "m/s", uses);
  if (run != nullptr) {
    add_joints(robot, summary.peak_demanded_torques, CaptureLimit::JointTorque, &Joint::max_effort,
               "N m", "N", uses);
  }
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const double range = joint.upper - joint.lower;
    if (!std::isfinite(range) || range <= 0) continue;
    const double low = run == nullptr ? at.phi(k) : summary.lowest_positions(k);
    const double high = run == nullptr ? at.phi(k) : summary.highest_positions(k);
    // The nearer of both stops.
    const double margin = std::min(low - joint.lower, joint.upper - high);
    uses[CaptureLimit::JointStop].push_back({CaptureLimit::JointStop, joint.name,
                                             range / 2 - margin, range / 2,
                                             joint.is_prismatic() ? "m" : "rad"});
  }
  const GripSpec& grip = problem.post_impact.grip;
  if (run != nullptr && run->is_held && grip.force) {
    uses[CaptureLimit::GripForce].push_back(
        {CaptureLimit::GripForce, robot.hand, summary.peak_grip_force, *grip.force, "N"});
  }
  if (run != nullptr && run->is_held && grip.moment) {
    uses[CaptureLimit::GripMoment].push_back(
        {CaptureLimit::GripMoment, robot.hand, summary.peak_grip_moment, *grip.moment, "N m"});
  }
  const double nothing = no_momentum(situation, angular);
  add_wheels(problem.post_impact, angular, nothing, run, uses);

  const VariableSpec& variables = problem.variables;
  const double window = variables.contact_time_upper - variables.contact_time_lower;
  if (window > 0) {
    const double edge = std::min(at.contact_time - variables.contact_time_lower,
                                 variables.contact_time_upper - at.contact_time);
    uses[CaptureLimit::TimeWindow].push_back(
        {CaptureLimit::TimeWindow, "contact_time", window / 2 - edge, window / 2, "s"});
  }
  const PostImpactSpec& spec = problem.post_impact;
  if (run != nullptr && chooses(spec, ControllerKind::Detumble)) {
    const auto least = least_time(spec.wheels, angular, nothing);
    double left = kAtRest;  // of momentum or joint rates, at least
    if (angular.norm() > 0) {
      left = std::max(left, run->simulation.trace.back().total.norm() / angular.norm());
    }
    const bool takes_time = least && *least > 0;
    const double beyond = spec.horizon + left * (takes_time ? *least : spec.horizon);
    uses[CaptureLimit::TimeWindow].push_back({CaptureLimit::TimeWindow, "horizon",
                                              summary.rest_time.value_or(beyond), spec.horizon,
                                              "s"});
  }
  return uses;
}

const LimitUse& largest_of(const std::vector<LimitUse>& uses) {
  return *std::max_element(uses.begin(), uses.end(), [](const LimitUse& a, const LimitUse& b) {
    return a.part() < b.part();
  });
}

std::string words(const LimitUse& use) {
  return fmt::format("{} of {}: {:.6g} of {:.6g} {}", to_string(use.limit), use.place, use.value,
                     use.most, use.unit);
}

/// Difference of a value that is rounding or integration, by its natural size and not by its limit,
/// which may be out of reach: of momentum the one that is managed and those that it is a difference
/// of, of positions a range or 1 rad (m), else 1e-6 of a unit.
/// @param momentum N m s: of the momentum
double floor_of(const LimitUse& use, double momentum) {
  if (use.limit == CaptureLimit::WheelMomentum) return momentum;
  if (use.limit == CaptureLimit::JointStop) return kManaged.extremes * std::min(use.most, 1.0);
  return kManaged.no_rotation * std::min(use.most, 1.0);
}

/// Stated limits against the recomputed ones, and whether the first one is the tightest.
void compare_limits(const ManagedMomentum& stated, const Uses& uses, double momentum,
                    double time_step, Objections& objections) {
  std::map<CaptureLimit, int> times;
  for (const LimitUse& use : stated.limits) {
    const auto known = uses.find(use.limit);
    ++times[use.limit];
    if (known == uses.end()) {
      objections.add(words(use) + ", of which nothing is known");
      continue;
    }
    const LimitUse& largest = largest_of(known->second);
    const auto is_there = [&use](const LimitUse& other) { return other.place == use.place; };
    const auto place = std::find_if(known->second.begin(), known->second.end(), is_there);
    const LimitUse& own = place == known->second.end() ? largest : *place;
    const double apart = own.unit == "s" ? time_step : kManaged.extremes * std::abs(own.value);
    const double same = kManaged.extremes * std::abs(own.value) + apart + floor_of(own, momentum);
    // Of what is all but zero, and of places that are used alike, rounding decides which is
    // largest.
    const bool is_nothing = std::abs(largest.value) <= floor_of(largest, momentum);
    const bool is_largest =
        own.part() >= largest.part() || own.value + same >= largest.part() * own.most;
    objections.demand(((own.place == use.place && is_largest) || is_nothing) &&
                          use.unit == own.unit &&
                          std::abs(use.most - own.most) <= kManaged.no_momentum * own.most &&
                          std::abs(use.value - own.value) <= same,
                      words(use) + " stated, " + words(largest) + " found");
  }
  for (const auto& [limit, list] : uses) {
    objections.demand(times[limit] == 1,
                      fmt::format("{} is stated {} times", to_string(limit), times[limit]));
  }
  for (std::size_t i = 1; i < stated.limits.size(); ++i) {
    objections.demand(stated.limits[i].part() <= stated.limits[i - 1].part(),
                      to_string(stated.limits[i].limit) + " is used more than the one before it");
  }
}

/// Largest size in each sample of a run, of one load that `detumble` may drive up to its limit.
struct Load {
  CaptureLimit limit;
  std::string place;
  double most = 0;
  std::function<double(const TraceSample&)> size;
};

std::vector<Load> loads_of(const CaptureProblem& problem) {
  const PostImpactSpec& spec = problem.post_impact;
  std::vector<Load> loads;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    loads.push_back({CaptureLimit::JointRate, joint.name, joint.max_velocity,
                     [k](const TraceSample& x) { return x.state.phidot[k]; }});
    loads.push_back({CaptureLimit::JointTorque, joint.name, joint.max_effort,
                     [k](const TraceSample& x) { return x.demanded_tau[k]; }});
  }
  for (int i = 0; i < 3; ++i) {
    loads.push_back({CaptureLimit::WheelTorque, kAxes[i], spec.wheels.torque[i],
                     [i](const TraceSample& x) { return x.wheel_torque[i]; }});
  }
  loads.push_back({CaptureLimit::GripForce, problem.robot.hand, spec.grip.force.value_or(0),
                   [](const TraceSample& x) { return x.grip_wrench.head<3>().norm(); }});
  loads.push_back({CaptureLimit::GripMoment, problem.robot.hand, spec.grip.moment.value_or(0),
                   [](const TraceSample& x) { return x.grip_wrench.tail<3>().norm(); }});
  return loads;
}

/// s until the rest with at least this part of a load's limit, by the samples of a run.
double time_near(const Load& load, double part, const SimulationResult& run) {
  if (!(load.most > 0) || !std::isfinite(load.most)) return 0;
  double time = 0;
  for (std::size_t i = 1; i < run.trace.size(); ++i) {
    const double to = std::min(run.trace[i].time, run.summary.rest_time.value_or(kInfinity));
    const double from = run.trace[i - 1].time;
    if (to > from && std::abs(load.size(run.trace[i - 1])) >= part * load.most) time += to - from;
  }
  return time;
}

/// s that the load is near its limit, as the integration counts its steps.
double counted_time(const Load& load, const CaptureProblem& problem, const LoadTimes& times) {
  const std::vector<Joint>& joints = problem.robot.joints;
  const auto joint = std::find_if(joints.begin(), joints.end(),
                                  [&](const Joint& other) { return other.name == load.place; });
  const auto k = static_cast<Eigen::Index>(joint - joints.begin());
  const int axis = load.place == "x" ? 0 : load.place == "y" ? 1 : 2;
  switch (load.limit) {
    case CaptureLimit::JointRate:
      return times.joint_rates[k];
    case CaptureLimit::JointTorque:
      return times.joint_torques[k];
    case CaptureLimit::WheelTorque:
      return times.wheel_torques[axis];
    case CaptureLimit::GripForce:
      return times.grip_force;
    default:
      return times.grip_moment;
  }
}

/// The limit that binds under `detumble`: the times that this integration counts by its steps, and
/// that its samples show.
void compare_held(const Context& context, const AfterContact& run, Objections& objections) {
  const SimulationResult& result = run.simulation;
  const double interval =
      result.trace.size() > 1 ? result.trace[1].time - result.trace[0].time : 0.0;
  const double sampled = 3 * interval;  // a load that begins and ends between samples
  const double period = context.problem.post_impact.control_period;
  const auto& stated = context.plan.managed_momentum->longest_held;
  bool is_known = !stated;
  for (const Load& load : loads_of(context.problem)) {
    const double counted = counted_time(load, context.problem, result.summary.near_limit);
    const double open = time_near(load, kNearLimit - kManaged.integrations, result) -
                        time_near(load, kNearLimit + kManaged.integrations, result);
    // Both integrations end their steps at the instants of control.
    const double slack = (period > 0 ? 4 * period : sampled) + kManaged.extremes * counted + open;
    const double seen = time_near(load, kNearLimit + kManaged.samples, result) - sampled;
    const double certain = std::min(counted, std::max(counted - slack, seen));
    const double possible = std::max(
        counted, std::min(counted + slack,
                          time_near(load, kNearLimit - kManaged.samples, result) + sampled));
    const double time = stated ? stated->time : 0;
    const std::string name = to_string(load.limit) + " of " + load.place;
    objections.demand(certain <= time,
                      fmt::format("{} is held for {:.4g} s, longer than stated", name, counted));
    if (!stated || load.limit != stated->limit || load.place != stated->place) continue;
    is_known = true;
    objections.demand(
        time > 0 && time <= possible,
        fmt::format("{} is stated to be held for {:.4g} s, {:.4g} s found", name, time, counted));
  }
  objections.demand(is_known, "the limit that is held longest is none that can be held");
}

void check_account(const Context& context, const Vector6d& Fbar, const Vector3d& angular,
                   const AfterContact* run, ClaimList& claims) {
  const auto& stated = context.plan.managed_momentum;
  if (!stated) {
    Objections missing;
    missing.demand(context.plan.status == PlanStatus::Infeasible,
                   "missing from a plan with a target and a solution");
    claims.none_wrong("managed_momentum_stated", missing, "the momentum that has to be managed");
    return;
  }
  // A limit may have come before the planner simulated the motion after the contact.
  if (context.plan.status == PlanStatus::Limit && !stated->remaining) run = nullptr;
  const Situation& at = context.situation;
  const PostImpactSpec& spec = context.problem.post_impact;
  Vector3d linear = Fbar.head<3>();
  if (is_latched(context.problem, Fbar)) {
    const reference::MetBody body = met_body(context.problem, at.event);
    linear = body.mass * body.velocity;
  }
  const double scale = at.response.rounding_scale(Fbar);
  const double error = std::max(relative_error(stated->angular, angular, scale),
                                relative_error(stated->linear, linear, linear.norm()));
  claims.same("managed_momentum", error, 100 * context.options.recompute_tolerance,
              fmt::format("{:.6g} N m s about the common centroid, {:.6g} N s", angular.norm(),
                          linear.norm()));

  Objections objections;
  const double step = 2 * spec.control_period;
  const auto times_agree = [&](const char* name, const std::optional<double>& said,
                               const std::optional<double>& found, double slack) {
    const bool both = said && found;
    objections.demand(
        said.has_value() == found.has_value() && (!both || std::abs(*said - *found) <= slack),
        fmt::format("{} {} stated, {} found", name, said ? fmt::format("{:.6g}", *said) : "null",
                    found ? fmt::format("{:.6g}", *found) : "null"));
  };
  const double nothing = no_momentum(at, angular);
  const auto least = least_time(spec.wheels, angular, nothing);
  times_agree("least_time", stated->least_time, least,
              kManaged.no_momentum * least.value_or(0) + 1e-12);
  std::optional<double> remaining, rest;
  if (run != nullptr) {
    remaining = run->simulation.trace.back().total.norm();
    rest = run->simulation.summary.rest_time;
  }
  const double same_momentum = kManaged.extremes * angular.norm() + kManaged.no_rotation * scale;
  times_agree("remaining", stated->remaining, remaining, same_momentum);
  times_agree("rest_time", stated->rest_time, rest, step + kManaged.extremes * rest.value_or(0));
  const Uses uses = all_uses(context.situation, angular, run);
  compare_limits(*stated, uses, same_momentum, step, objections);
  if (run != nullptr && chooses(spec, ControllerKind::Detumble)) {
    compare_held(context, *run, objections);
  } else {
    objections.demand(!stated->longest_held, "a limit is held without a controller that holds it");
  }
  std::string detail =
      stated->limits.empty() ? "no limit" : "tightest: " + words(stated->limits.front());
  if (run != nullptr) {
    detail += fmt::format(
        "; another integration's momenta and loads within {} of them, its times "
        "within two control periods more",
        2 * kManaged.extremes);
  }
  claims.none_wrong("capture_limits", objections, detail);
}

/// Demands of the problem that hold or not, whatever the plan says.
void check_demands(const Context& context, const Vector3d& angular, const AfterContact& run,
                   ClaimList& claims) {
  const Uses uses = all_uses(context.situation, angular, &run);
  const double slack = context.options.limit_slack;
  const auto demand = [&](CaptureLimit limit, const char* name, const std::string& detail) {
    const auto found = uses.find(limit);
    if (found == uses.end()) return;
    const LimitUse& most = largest_of(found->second);
    claims.at_most(name, most.value, most.most * (1 + slack), most.unit,
                   fmt::format("{} {}", detail, most.place));
  };
  demand(CaptureLimit::GripForce, "grip_force", "largest force on the target at the");
  demand(CaptureLimit::GripMoment, "grip_moment", "largest moment on the target about the");
  demand(CaptureLimit::WheelTorque, "wheel_torque", "largest torque of the wheel about");
  demand(CaptureLimit::WheelMomentum, "wheel_momentum",
         "largest momentum that the wheel holds or has to take, about");
  const PostImpactSpec& spec = context.problem.post_impact;
  if (!chooses(spec, ControllerKind::Detumble)) return;
  const auto& rest = run.simulation.summary.rest_time;
  claims.at_most("detumbled", rest.value_or(2 * spec.horizon), spec.horizon, "s",
                 rest ? "the time until robot and target rest, against the horizon"
                      : "robot and target do not rest at the horizon");
}

}  // namespace

LimitUses limit_uses(const Situation& situation, const AfterContact* run) {
  return all_uses(situation, angular_momentum(situation, situation.impulse()), run);
}

void check_managed_momentum(const Context& context, const AfterContact* run, ClaimList& claims) {
  if (!context.problem.target) return;
  const Vector6d Fbar = context.situation.impulse();
  const Vector3d angular = angular_momentum(context.situation, Fbar);
  check_account(context, Fbar, angular, run, claims);
  if (run == nullptr) return;
  check_demands(context, angular, *run, claims);
  check_grip_load(context, *run, claims);
}

}  // namespace stillbase::verification
