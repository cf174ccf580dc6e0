// What happens after the impact under each controller, momenta judged by `reference`.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/simulation/settings.hpp>

#include "verification/checks.hpp"
#include "verification/contact_case.hpp"

namespace stillbase::verification {
namespace {

struct Drift {
  double linear = 0, angular = 0;
};

// Largest change of the momenta in N, relative to the most that the kinetic energy right after the
// impact could hold: sqrt(2 w T) and sqrt(2 T trace(Htilde_omega)). What thrusters gave is no
// drift.
Drift momentum_drift(const Context& context, const RobotModel& robot,
                     const std::vector<TraceSample>& trace) {
  Drift drift;
  Vector3d P0 = Vector3d::Zero(), L0 = Vector3d::Zero();
  double scale_P = 0, scale_L = 0;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const PlantState& state = trace[i].state;
    const auto d = reference::compute(robot, {state.phi, state.phidot, state.Omega});
    const Vector3d P = state.base.orientation * d.P,
                   L = state.base.orientation * Vector3d(d.L_g + state.wheel_momentum) -
                       state.thruster_impulse;
    if (i == 0) {
      Eigen::VectorXd x(6 + state.phi.size());
      x << state.Omega, state.phidot;
      double energy = x.dot(d.H * x) / 2;
      if (context.problem.resistance.model == ResistanceModel::RotorInertia) {
        const JointVectord& rotors = context.problem.resistance.rotor_inertia;
        energy += state.phidot.dot(rotors.cwiseProduct(state.phidot)) / 2;
      }
      P0 = P;
      L0 = L;
      scale_P = std::sqrt(2 * d.mass * energy);
      scale_L = std::sqrt(2 * energy * d.Htilde_omega.trace());
    }
    if ((P - P0).norm() > 0) drift.linear = std::max(drift.linear, (P - P0).norm() / scale_P);
    if ((L - L0).norm() > 0) drift.angular = std::max(drift.angular, (L - L0).norm() / scale_L);
  }
  return drift;
}

// The same of robot and target together, about the origin of N, through a contact that takes time.
// Relative to what the target brought.
Drift pair_drift(const CaptureProblem& problem, const std::vector<TraceSample>& trace) {
  Drift drift;
  Vector3d P0 = Vector3d::Zero(), L0 = Vector3d::Zero();
  double scale_P = 0, scale_L = 0;
  const bool turns = problem.impulse.source == ImpulseSource::RigidBody;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const PlantState& state = trace[i].state;
    const TargetPlantState& target = *trace[i].target;
    const auto d = reference::compute(problem.robot, {state.phi, state.phidot, state.Omega});
    const Eigen::Quaterniond& R_NB = state.base.orientation;
    const Vector3d P_robot = R_NB * d.P, p = problem.target->mass * target.velocity;
    Vector3d L = R_NB * Vector3d(d.L_g + state.wheel_momentum) - state.thruster_impulse;
    L += (state.base * Vector3d(d.centroid)).cross(P_robot) + target.pose.position.cross(p);
    if (turns) {
      const Vector3d spin = problem.target->inertia * target.angular_velocity;
      L += target.pose.orientation * spin;
    }
    const Vector3d P = P_robot + p;
    if (i == 0) {
      P0 = P;
      L0 = L;
      scale_P = p.norm();
      scale_L = p.norm() * (1 + target.pose.position.norm());
    }
    drift.linear = std::max(drift.linear, (P - P0).norm() / scale_P);
    drift.angular = std::max(drift.angular, (L - L0).norm() / scale_L);
  }
  return drift;
}

std::string describe(const LimitEvent& event, const RobotModel& robot) {
  return fmt::format("{} {} at {:.3f} s", robot.joints[event.joint].name, to_string(event.kind),
                     event.time);
}

// Largest part of a limit that is used; joints without one use nothing.
double largest_part(const RobotModel& robot, const JointVectord& peaks, double Joint::*limit) {
  double part = 0;
  for (int k = 0; k < robot.n(); ++k) {
    const double most = robot.joints[k].*limit;
    if (std::isfinite(most) && peaks(k) > 0) part = std::max(part, peaks(k) / most);
  }
  return part;
}

// The first controller is the plan's choice: what it leaves is judged.
void judge(const Context& context, const ControllerReport& report, const SimulationSummary& summary,
           ClaimList& claims) {
  const PostImpactSpec& spec = context.problem.post_impact;
  const RobotModel& robot = context.problem.robot;
  const std::string under = fmt::format(" under {} over {} s", report.controller, report.horizon);
  claims.at_most("post_impact_base_rate", report.residual_base_rate, spec.residual_base_rate_max,
                 "rad/s",
                 fmt::format("at the horizon{}; peak {:.3g}", under, report.peak_base_rate));
  claims.at_most("post_impact_attitude", report.attitude_turned, spec.attitude_change_max, "rad",
                 "largest turn of the base" + under);
  const double slack = context.options.limit_slack;
  claims.at_most("post_impact_joint_rates",
                 largest_part(robot, summary.peak_joint_rates, &Joint::max_velocity), 1 + slack,
                 "1",
                 fmt::format("largest part of a rate limit{}; peak {:.3g} rad/s", under,
                             report.peak_joint_rate));
  claims.at_most("post_impact_joint_torques",
                 largest_part(robot, summary.peak_torques, &Joint::max_effort), 1 + slack, "1",
                 fmt::format("largest part of a torque limit{}; peak {:.3g} N m", under,
                             report.peak_joint_torque));
  std::vector<std::string> stops;
  for (const LimitEvent& event : summary.limits) {
    if (event.kind == LimitKind::LowerStop || event.kind == LimitKind::UpperStop) {
      stops.push_back(describe(event, robot));
    }
  }
  claims.none_wrong("post_impact_joint_stops", stops, "joint stops reached" + under);
  claims.at_most("post_impact_linear_momentum", report.linear_momentum_drift,
                 context.options.momentum_tolerance, "1", "relative change in N" + under);
  claims.at_most("post_impact_angular_momentum", report.angular_momentum_drift,
                 context.options.momentum_tolerance, "1", "relative change in N" + under);
}

}  // namespace

void check_post_impact(const Context& context, const ContactEvent& event,
                       const PostureResponse& response, ClaimList& claims,
                       std::vector<ControllerReport>& reports) {
  const CaptureProblem& problem = context.problem;
  const PostImpactSpec& spec = problem.post_impact;
  const Vector6d Fbar = impulse_along(problem, event, response, event.n);
  const ContactCase subject = contact_case(problem, context.motion, event, response,
                                           context.plan.configuration, event.n, Fbar);
  if (spec.controllers.empty()) {
    check_target_fate(context, event, response, Fbar, nullptr, claims);
  }
  for (std::size_t i = 0; i < spec.controllers.size(); ++i) {
    ControllerReport report;
    report.controller = spec.controllers[i];
    report.horizon = spec.horizon;
    SimulationSummary summary;
    std::optional<AfterContact> run;
    const auto kind = controller_from_name(report.controller);
    if (!kind) {
      report.detail = "no controller of this name";
    } else {
      SimulationOptions options = plant_options_of(spec, problem.robot);
      options.integrator = IntegratorKind::Fehlberg78;
      options.relative_tolerance = 1e-11;
      options.absolute_tolerance = 1e-13;
      options.output_period = spec.horizon / 20;
      options.stop = context.options.stop;
      try {
        run = simulate_after_contact(subject, contact_choice_of(spec), controller_of(*kind, spec),
                                     options);
        const SimulationResult& result = run->simulation;
        summary = result.summary;
        report.finished = result.status == SimulationStatus::Finished;
        if (!report.finished) report.detail = "simulation: " + to_string(result.status);
        const Drift drift = run->encounter ? pair_drift(problem, result.trace)
                                           : momentum_drift(context, run->robot, result.trace);
        report.linear_momentum_drift = drift.linear;
        report.angular_momentum_drift = drift.angular;
      } catch (const std::exception& error) {
        report.finished = false;
        report.detail = error.what();
      }
    }
    if (report.finished) {
      report.residual_base_rate = summary.residual_base_rate;
      report.peak_base_rate = summary.peak_base_rate;
      report.attitude_turned = summary.attitude_turned;
      report.peak_joint_rate = summary.peak_joint_rates.cwiseAbs().maxCoeff();
      report.residual_joint_rate = summary.residual_joint_rate;
      report.peak_joint_torque = summary.peak_torque;
      for (const LimitEvent& event_met : summary.limits) {
        report.limits_met.push_back(describe(event_met, problem.robot));
      }
    }
    if (i == 0) {
      if (report.finished) {
        judge(context, report, summary, claims);
        check_target_fate(context, event, response, Fbar, &*run, claims);
      } else {
        claims.not_evaluated("post_impact_base_rate", spec.residual_base_rate_max, "rad/s",
                             report.detail);
      }
    }
    reports.push_back(report);
  }
}

}  // namespace stillbase::verification
