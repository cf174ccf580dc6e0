// What happens after the impact under each controller, momenta judged by `reference`.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/contact_case.hpp"
#include "verification/own_motion.hpp"

namespace stillbase::verification {
namespace {

/// The integration of the motion after the impact, and how well two of them agree.
struct PostImpactCheckOptions {
  /// Errors of a step of the integration: a hundredth of what checks of momenta allow over it all.
  double relative_step = 1e-11, absolute_step = 1e-13;
  /// Samples of the motion; under detumble close enough to see which load is held at its limit.
  int samples = 20, detumble_samples = 200;
  /// Relative, between two instants of the same stop: a joint that creeps there carries the errors
  /// of ten horizons.
  double same_time = 1e-3;
  double same_rate = 1e-4;      ///< relative, between joint rates of two integrations
  double no_rate = 1e-9;        ///< rad/s: what has come to rest but for their errors
  double no_time = 1e-9;        ///< s: a joint that begins at its stop reaches it at once
  double first_instant = 1e-9;  ///< relative: the jump by two codes, nothing is integrated yet
};
constexpr PostImpactCheckOptions kPostImpact;

struct Momentum {
  Vector3d linear, angular;
};

/// Momenta of a plant state in N, the angular one about the system centroid, wheels included. What
/// thrusters gave is subtracted: it is no drift.
Momentum momentum_of(const PlantState& state, const reference::Dynamics& d) {
  const Eigen::Quaterniond& R_NB = state.base.orientation;
  return {R_NB * d.P, R_NB * Vector3d(d.L_g + state.wheel_momentum) - state.thruster_impulse};
}

/// Largest change of the momenta over a trace, relative to the given sizes.
struct Drift {
  double linear = 0, angular = 0;

  void take(const Momentum& now, const Momentum& start, double linear_size, double angular_size) {
    const double P = (now.linear - start.linear).norm(), L = (now.angular - start.angular).norm();
    if (P > 0) linear = std::max(linear, P / linear_size);
    if (L > 0) angular = std::max(angular, L / angular_size);
  }
};

/// Drift of the robot alone, relative to the largest momenta that the kinetic energy right after
/// the impact could hold: sqrt(2 w T) and sqrt(2 T trace(Htilde_omega)).
Drift momentum_drift(const Context& context, const RobotModel& robot,
                     const std::vector<TraceSample>& trace) {
  Drift drift;
  std::optional<Momentum> start;
  double linear_size = 0, angular_size = 0;
  for (const TraceSample& sample : trace) {
    const PlantState& state = sample.state;
    const auto d = reference::compute(robot, {state.phi, state.phidot, state.Omega});
    const Momentum now = momentum_of(state, d);
    if (!start) {
      start = now;
      Eigen::VectorXd x(6 + state.phi.size());
      x << state.Omega, state.phidot;
      double energy = x.dot(d.H * x) / 2;
      if (context.problem.resistance.model == ResistanceModel::RotorInertia) {
        const JointVectord& rotors = context.problem.resistance.rotor_inertia;
        energy += state.phidot.dot(rotors.cwiseProduct(state.phidot)) / 2;
      }
      linear_size = std::sqrt(2 * d.mass * energy);
      angular_size = std::sqrt(2 * energy * d.Htilde_omega.trace());
    }
    drift.take(now, *start, linear_size, angular_size);
  }
  return drift;
}

/// Drift of robot and target together, about the origin of N, through a contact of some duration.
/// Relative to the target's momentum before it.
Drift pair_drift(const CaptureProblem& problem, const std::vector<TraceSample>& trace) {
  Drift drift;
  std::optional<Momentum> start;
  double linear_size = 0, angular_size = 0;
  for (const TraceSample& sample : trace) {
    const PlantState& state = sample.state;
    const TargetPlantState& target = *sample.target;
    const auto d = reference::compute(problem.robot, {state.phi, state.phidot, state.Omega});
    Momentum now = momentum_of(state, d);
    const Vector3d p = problem.target->mass * target.velocity;
    now.angular += (state.base * Vector3d(d.centroid)).cross(now.linear);
    now.angular += target.pose.position.cross(p);
    if (problem.impulse.source == ImpulseSource::RigidBody) {
      const Vector3d spin = problem.target->inertia * target.angular_velocity;
      now.angular += target.pose.orientation * spin;
    }
    now.linear += p;
    if (!start) {
      start = now;
      linear_size = p.norm();
      angular_size = p.norm() * (1 + target.pose.position.norm());
    }
    drift.take(now, *start, linear_size, angular_size);
  }
  return drift;
}

std::string describe(const LimitEvent& event, const RobotModel& robot) {
  return fmt::format("{} {} at {:.3f} s", robot.joints[event.joint].name, to_string(event.kind),
                     event.time);
}

/// The first controller is the plan's choice, so its motion is judged.
void judge_motion(const Context& context, const ControllerReport& report,
                  const SimulationSummary& summary, ClaimList& claims) {
  const PostImpactSpec& spec = context.problem.post_impact;
  const RobotModel& robot = context.problem.robot;
  const std::string under = fmt::format(" under {} over {} s", report.controller, report.horizon);
  claims.at_most("post_impact_base_rate", report.residual_base_rate, spec.residual_base_rate_max,
                 "rad/s",
                 fmt::format("at the horizon{}; peak {:.3g}", under, report.peak_base_rate));
  claims.at_most("post_impact_attitude", report.attitude_turned, spec.attitude_change_max, "rad",
                 "largest change of the base's attitude" + under);
  const double slack = context.options.limit_slack;
  claims.at_most("post_impact_joint_rates",
                 largest_fraction(robot, summary.peak_joint_rates, &Joint::max_velocity), 1 + slack,
                 "1",
                 fmt::format("largest fraction of a rate limit{}; peak {:.3g} rad/s", under,
                             report.peak_joint_rate));
  claims.at_most("post_impact_joint_torques",
                 largest_fraction(robot, summary.peak_demanded_torques, &Joint::max_effort),
                 1 + slack, "1",
                 fmt::format("largest fraction of a torque limit that is demanded{}; peak {:.3g} "
                             "N m, of which the joint gives {:.3g} N m",
                             under, report.peak_demanded_torque, report.peak_joint_torque));
  Objections stops;
  for (const LimitEvent& event : summary.limits) {
    stops.demand(event.kind != LimitKind::LowerStop && event.kind != LimitKind::UpperStop,
                 describe(event, robot));
  }
  claims.none_wrong("post_impact_joint_stops", stops, "joint stops reached" + under);
  claims.at_most("post_impact_linear_momentum", report.linear_momentum_drift,
                 context.options.momentum_tolerance, "1", "relative change in N" + under);
  claims.at_most("post_impact_angular_momentum", report.angular_momentum_drift,
                 context.options.momentum_tolerance, "1", "relative change in N" + under);
}

/// With the integration and the samples of these checks.
SimulationOptions options_of(const Context& context, const Controller& controller) {
  SimulationOptions options = plant_options_of(context.problem.post_impact, context.problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = kPostImpact.relative_step;
  options.absolute_tolerance = kPostImpact.absolute_step;
  const int samples = controller.kind == ControllerKind::Detumble ? kPostImpact.detumble_samples
                                                                  : kPostImpact.samples;
  options.output_period = context.problem.post_impact.horizon / samples;
  options.stop = context.options.stop;
  return options;
}

/// The joint that reaches a stop included: of neither where none does.
bool have_same_end(const AfterHorizon& a, const AfterHorizon& b) {
  return a.moves == b.moves && a.stop_time.has_value() == b.stop_time.has_value() &&
         a.joint == b.joint;
}

bool have_same_time(const AfterHorizon& a, const AfterHorizon& b) {
  return !a.stop_time || !b.stop_time ||
         std::abs(*a.stop_time - *b.stop_time) <=
             kPostImpact.same_time * *b.stop_time + kPostImpact.no_time;
}

bool agree(const AfterHorizon& a, const AfterHorizon& b) {
  return have_same_end(a, b) && have_same_time(a, b);
}

/// The plan's statement on the time after the horizon.
void check_after_horizon(const Context& context, const ContactCase& subject,
                         const AfterContact& run, ClaimList& claims) {
  const char* const name = "after_horizon";
  const auto& stated = context.plan.after_horizon;
  if (!stated && context.plan.status == PlanStatus::Limit) {
    return claims.not_verified(name, "not stated: a limit came before it was simulated");
  }
  const PostImpactSpec& spec = context.problem.post_impact;
  const auto controller = controller_of(spec, spec.controllers.front());
  const auto found =
      look_beyond_horizon(subject, spec, *controller, options_of(context, *controller), run);
  if (!found) return claims.not_verified(name, "the simulation beyond the horizon did not finish");
  if (!stated) {
    Objections missing;
    missing.add("missing from a plan with a controller");
    return claims.none_wrong(name, missing, "what the joints do after the horizon");
  }
  claims.at_most("after_horizon_joint_rate", std::abs(stated->joint_rate - found->joint_rate),
                 kPostImpact.same_rate * found->joint_rate + kPostImpact.no_rate, "rad/s",
                 fmt::format("norm at the horizon, stated {:.6g} from {:.6g} recomputed",
                             stated->joint_rate, found->joint_rate));
  if (!agree(*stated, *found)) {
    // Over ten horizons the motion of several joints may become chaotic: then another method of
    // this verification ends otherwise, too.
    SimulationOptions another = options_of(context, *controller);
    another.integrator = IntegratorKind::Dopri5;
    const auto other = look_beyond_horizon(subject, spec, *controller, another, run);
    if (other && !agree(*other, *found)) {
      return claims.not_verified(
          name, "the motion beyond the horizon is chaotic: two integrations of it end differently");
    }
  }
  Objections objections;
  const auto words = [](const AfterHorizon& x) {
    if (!x.stop_time) {
      return (x.moves ? "moving, no stop within ten horizons" : "at rest") +
             (x.joint.empty() ? "" : ", and names " + x.joint);
    }
    return fmt::format("{} at its stop {:.6g} s after the impact", x.joint, *x.stop_time);
  };
  const bool has_same_end = have_same_end(*stated, *found);
  objections.demand(has_same_end, "the plan states " + words(*stated));
  claims.none_wrong(name, objections, words(*found));
  if (!has_same_end || !found->stop_time) return;
  claims.at_most(
      "after_horizon_stop_time", std::abs(*stated->stop_time - *found->stop_time),
      kPostImpact.same_time * *found->stop_time + kPostImpact.no_time, "s",
      fmt::format("stated {:.6g} from {:.6g} recomputed", *stated->stop_time, *found->stop_time));
}

/// Simulates the motion under one controller.
/// @return nothing when it did not run; the report says why
std::optional<AfterContact> simulate(const Context& context, const ContactCase& subject,
                                     ControllerReport& report) {
  const PostImpactSpec& spec = context.problem.post_impact;
  const auto controller = controller_of(spec, report.controller);
  if (!controller) {
    report.detail = "no controller of this name";
    return std::nullopt;
  }
  try {
    AfterContact run =
        simulate_after_contact(subject, spec, *controller, options_of(context, *controller));
    const SimulationResult& result = run.simulation;
    const Drift drift = run.encounter ? pair_drift(context.problem, result.trace)
                                      : momentum_drift(context, run.robot, result.trace);
    report.linear_momentum_drift = drift.linear;
    report.angular_momentum_drift = drift.angular;
    report.finished = result.status == SimulationStatus::Finished;
    if (!report.finished) report.detail = "simulation: " + to_string(result.status);
    return run;
  } catch (const std::exception& error) {
    report.detail = error.what();
    return std::nullopt;
  }
}

void fill(ControllerReport& report, const SimulationSummary& summary, const RobotModel& robot) {
  report.residual_base_rate = summary.residual_base_rate;
  report.peak_base_rate = summary.peak_base_rate;
  report.attitude_turned = summary.attitude_turned;
  report.peak_joint_rate = summary.peak_joint_rates.cwiseAbs().maxCoeff();
  report.residual_joint_rate = summary.residual_joint_rate;
  report.peak_joint_torque = summary.peak_torque;
  report.peak_demanded_torque = summary.peak_demanded_torque;
  for (const LimitEvent& event : summary.limits) {
    report.limits_met.push_back(describe(event, robot));
  }
}

/// What the plan says of the impact, against the state with which the simulation begins. A
/// compliant contact takes time: its simulation begins before the impact.
void check_first_instant(const Context& context, const AfterContact& run, ClaimList& claims) {
  if (run.encounter) return;
  const ImpactSummary& stated = context.plan.impact;
  const TraceSample& first = run.simulation.trace.front();
  const PostureResponse& response = context.situation.response;
  const double momentum = response.rounding_scale(context.situation.impulse());
  const double rate = 3 * momentum / response.dynamics.Htilde_omega.trace();
  double worst = 0;
  const auto compare = [&](const Eigen::VectorXd& said, const Eigen::VectorXd& found,
                           double scale) {
    worst = std::max(worst, relative_error(said, found, scale));
  };
  compare(stated.base, first.base, momentum);
  compare(stated.coupling, first.coupling, momentum);
  compare(stated.total, first.total, momentum);
  const Vector6d Omega = stated.Omega_after();
  compare(Omega.head<3>(), first.state.Omega.head<3>(),
          stated.Fbar.head<3>().norm() / response.dynamics.mass);
  compare(Omega.tail<3>(), first.state.Omega.tail<3>(), rate);
  compare(stated.phidot_after(), first.state.phidot, rate);
  claims.same("first_instant", worst, kPostImpact.first_instant,
              "momenta and velocities of the plan's impact against those with which its simulation "
              "begins");
}

}  // namespace

void check_post_impact(const Context& context, ClaimList& claims,
                       std::vector<ControllerReport>& reports) {
  const Situation& at = context.situation;
  const PostImpactSpec& spec = context.problem.post_impact;
  const ContactCase subject = contact_case(context.problem, at.target(), at.event, at.response,
                                           at.at, at.event.n, at.impulse());
  if (spec.controllers.empty()) {
    if (context.plan.after_horizon) {
      Objections invented;
      invented.add("stated without a controller");
      claims.none_wrong("after_horizon", invented, "what the joints do after the horizon");
    }
    check_managed_momentum(context, nullptr, claims);
    check_target_fate(context, nullptr, claims);
  }
  for (const std::string& controller : spec.controllers) {
    ControllerReport report;
    report.controller = controller;
    report.horizon = spec.horizon;
    const auto run = simulate(context, subject, report);
    if (report.finished) fill(report, run->simulation.summary, context.problem.robot);
    reports.push_back(report);
    if (reports.size() > 1) continue;
    if (report.finished) {
      judge_motion(context, report, run->simulation.summary, claims);
      check_own_motion(context, controller, *run, claims);
      check_first_instant(context, *run, claims);
      check_after_horizon(context, subject, *run, claims);
      check_managed_momentum(context, &*run, claims);
      check_target_fate(context, &*run, claims);
    } else {
      claims.not_evaluated("post_impact_base_rate", spec.residual_base_rate_max, "rad/s",
                           report.detail);
    }
  }
}

}  // namespace stillbase::verification
