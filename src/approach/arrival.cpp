#include "approach/arrival.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>

#include "approach/base_motion.hpp"
#include "approach/effort.hpp"

namespace stillbase {

namespace {

constexpr const char* kNoStop = "no path to stop on if the grasp does not close: ";

/// A path of one cubic as samples at even times.
JointPath sampled(const JointPath& cubic, int samples) {
  JointPath out;
  const double t0 = cubic.times.front(), t1 = cubic.times.back();
  for (int i = 0; i <= samples; ++i) {
    const double t = i == samples ? t1 : t0 + (t1 - t0) * i / samples;
    const JointMotion at = motion_on_segment(cubic, 0, t);
    out.times.push_back(t);
    out.phi.push_back(at.phi);
    out.phidot.push_back(at.phidot);
  }
  out.phi.front() = cubic.phi.front();
  out.phidot.front() = cubic.phidot.front();
  out.phi.back() = cubic.phi.back();
  out.phidot.back() = cubic.phidot.back();
  return out;
}

std::string hit_words(const TimedHit& hit, double contact_time) {
  return fmt::format("{} {:.3f} s {} the contact (distance {:.4f} m)", to_string(hit.proximity),
                     std::abs(hit.time - contact_time),
                     hit.time < contact_time ? "before" : "after", hit.proximity.distance);
}

/// What keeps a path from being used; empty: nothing.
std::string objection(const ApproachTask& task, const TimedMotion& motion) {
  const JointPath& path = motion.path;
  for (const JointVectord& phi : path.phi) {
    const Joint* joint = joint_outside_limits(task.problem.robot, phi, task.options.limit_slack);
    if (joint != nullptr) return "beyond a limit of " + joint->name;
  }
  const double used = effort_used(task.problem, path, task.options.effort);
  if (used > task.options.effort.usable) {
    return fmt::format("{:.3g} of a torque limit", used);
  }
  const auto hit = first_hit(task, motion, task.target);
  return hit ? hit_words(*hit, task.goal.contact_time) : "";
}

/// Shortest time in which all rates can be reached from rest, s.
double shortest_time(const JointVectord& rates, const MotionLimits& limits) {
  return (rates.cwiseAbs().array() / limits.acceleration.array()).maxCoeff();
}

TimedMotion run_of(const ApproachTask& task, const JointVectord& rates, double duration,
                   int samples) {
  const Configuration& goal = task.goal;
  JointPath cubic;
  cubic.times = {goal.contact_time - duration, goal.contact_time};
  cubic.phi = {goal.phi - duration / 2 * rates, goal.phi};
  cubic.phidot = {JointVectord::Zero(rates.size()), rates};
  TimedMotion out;
  out.path = sampled(cubic, samples);
  out.base_poses = base_poses(task.problem.robot, out.path, BaseMode::Floating, goal.base);
  out.contact_time = goal.contact_time;
  return out;
}

/// The joints' displacement (n) that takes the hand by n d, without turning it, to first order.
JointVectord retreat_of(const ApproachTask& task, const Vector3d& n) {
  const auto kinematics = compute_kinematics<double>(task.problem.robot, task.goal.phi);
  const auto inertia = compute_inertia<double>(task.problem.robot, kinematics);
  const auto jacobian = compute_hand_jacobian<double>(task.problem.robot, kinematics);
  const Eigen::MatrixXd Jhat = compute_hat_inertia<double>(inertia, jacobian).Jhat_phi;
  Vector6d along = Vector6d::Zero();
  along.head<3>() = n;
  return Jhat.completeOrthogonalDecomposition().solve(along);
}

TimedMotion abort_of(const ApproachTask& task, const JointVectord& rates,
                     const JointVectord& retreat, double duration, int samples) {
  const Configuration& goal = task.goal;
  JointPath cubic;
  cubic.times = {goal.contact_time, goal.contact_time + duration};
  cubic.phi = {goal.phi, goal.phi + duration / 2 * rates + retreat};
  cubic.phidot = {rates, JointVectord::Zero(rates.size())};
  TimedMotion out;
  out.path = sampled(cubic, samples);
  out.base_poses = base_poses_from(task.problem.robot, out.path, goal.base);
  out.contact_time = out.path.times.back();
  return out;
}

/// Least time in which the cubic of abort_of() keeps rate and acceleration limits, s. Rates at the
/// start may be at their limits.
double shortest_abort(const JointVectord& rates, const JointVectord& retreat,
                      const MotionLimits& limits) {
  double most = 0;
  for (Eigen::Index k = 0; k < rates.size(); ++k) {
    const double v = std::abs(rates[k]), r = std::abs(retreat[k]), a = limits.acceleration[k];
    // |a| <= v / T + 6 r / T^2 at both ends.
    most = std::max(most, (v + std::sqrt(v * v + 24 * a * r)) / (2 * a));
  }
  return most;
}

/// Largest part of a rate limit that a path uses.
double rate_used(const JointPath& path, const MotionLimits& limits) {
  double used = 0;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    const JointVectord peak = peak_rates(path, i, path.times[i], path.times[i + 1]);
    used = std::max(used, (peak.array() / limits.rate.array()).maxCoeff());
  }
  return used;
}

/// n . (v_target - v_hand) at the contact, m/s, n the feature's normal.
double closing_speed(const ApproachTask& task, const Vector6d& relative_velocity) {
  const Configuration& goal = task.goal;
  const ContactState contact =
      task.target->contact(chosen_feature(task.problem), goal.contact_time);
  return contact.normal.dot(goal.base.orientation * Vector3d(relative_velocity.head<3>()));
}

/// Whether the hand leaves the target along the feature's normal, to the clearance at the end.
/// @pre they do not close in at the contact: then they would pass through each other at once
bool leaves_target(const ApproachTask& task, const TimedMotion& motion, double rounding) {
  const ContactFeature& feature = chosen_feature(task.problem);
  double gap = 0;
  for (std::size_t i = 0; i < motion.path.times.size(); ++i) {
    const auto kinematics = compute_kinematics<double>(task.problem.robot, motion.path.phi[i]);
    const Vector3d hand = motion.base_poses[i] * Vector3d(kinematics.r_bh);
    const ContactState contact = task.target->contact(feature, motion.path.times[i]);
    gap = contact.normal.dot(hand - contact.point);
    if (gap < -rounding) return false;
  }
  return gap >= least_distance(task.problem.approach);
}

}  // namespace

Arrival plan_arrival(const ApproachTask& task, const ArrivalOptions& options) {
  const CaptureProblem& problem = task.problem;
  Arrival out;
  const ImpactSummary impact = impact_at(problem, task.goal);
  if (!impact.before) {
    out.failure = "the hand has no motion at the contact";
    return out;
  }
  const JointVectord& rates = impact.before->phidot;
  const double shortest = shortest_time(rates, task.limits);
  std::string failure;
  bool found = false;
  for (const double factor : options.run_factors) {
    const double duration = std::max(factor * shortest, options.shortest);
    out.run = run_of(task, rates, duration, options.samples);
    failure = objection(task, out.run);
    found = failure.empty();
    if (found) break;
  }
  if (!found) {
    out.failure = "on the run to the contact: " + failure;
    return out;
  }
  out.rest = task.goal;
  out.rest.phi = out.run.path.phi.front();
  out.rest.base = out.run.base_poses.front();
  out.rest.contact_time = out.run.path.times.front();
  if (!problem.approach.abort) return out;
  const double closing = closing_speed(task, impact.before->relative_velocity);
  if (closing > options.no_closing) {
    out.failure = kNoStop + fmt::format("hand and target close in at {:.3g} m/s", closing);
    return out;
  }

  const EncounterModel model = encounter_model(problem);
  const Vector3d n = encounter_at(model, task.goal).F.head<3>();
  const JointVectord per_metre = retreat_of(task, n);
  failure = "the hand does not leave the target";
  for (const double distance : options.retreats) {
    const JointVectord retreat = distance * per_metre;
    for (const double factor : options.abort_factors) {
      const double duration =
          std::max(factor * shortest_abort(rates, retreat, task.limits), options.shortest);
      if (duration > kLongestAbort) continue;
      TimedMotion abort = abort_of(task, rates, retreat, duration, options.samples);
      if (rate_used(abort.path, task.limits) > 1 + options.rate_slack) {
        failure = "beyond a rate limit";
        continue;
      }
      if (!leaves_target(task, abort, options.gap_rounding)) continue;
      const std::string objected = objection(task, abort);
      if (!objected.empty()) {
        failure = objected;
        continue;
      }
      out.clearance = smallest_clearance(task, abort, task.target).distance;
      out.abort = std::move(abort);
      out.retreat = distance;
      return out;
    }
  }
  out.failure = kNoStop + failure;
  return out;
}

void append_arrival(const ApproachTask& task, const Arrival& arrival, Approach& approach) {
  const CaptureProblem& problem = task.problem;
  const JointPath& path = arrival.run.path;
  const JointVectord zero = JointVectord::Zero(problem.robot.n());
  const auto motion_at = [&](std::size_t i) {
    JointMotion at{path.phi[i], path.phidot[i], zero};
    if (i < path.segments()) at.phiddot = motion_on_segment(path, i, path.times[i]).phiddot;
    return at;
  };
  // The last sample of the wait is the first one of the run.
  const JointMotion first = motion_at(0);
  approach.joint_accelerations.back() = first.phiddot;
  approach.joint_torques.back() = joint_torques(problem, first);
  for (std::size_t i = 1; i < path.times.size(); ++i) {
    const JointMotion at = motion_at(i);
    approach.times.push_back(path.times[i]);
    approach.joint_positions.push_back(at.phi);
    approach.joint_velocities.push_back(at.phidot);
    approach.joint_accelerations.push_back(at.phiddot);
    approach.joint_torques.push_back(i < path.segments() ? joint_torques(problem, at) : zero);
    approach.base_poses.push_back(arrival.run.base_poses[i]);
    approach.base_velocities.push_back(base_velocity(problem.robot, at));
  }
  const Pose& end = approach.base_poses.back();
  approach.attitude_excursion = 0;
  for (const Pose& base : approach.base_poses) {
    approach.attitude_excursion =
        std::max(approach.attitude_excursion,
                 rotation_log(end.orientation.conjugate() * base.orientation).norm());
  }
  const double duration = path.times.back() - path.times.front();
  approach.duration += duration;
  approach.path_length += length(path, task.options.length_parts);
  approach.effort_used =
      std::max(approach.effort_used, effort_used(problem, path, task.options.effort));
  approach.min_clearance =
      std::min(approach.min_clearance, smallest_clearance(task, arrival.run, task.target).distance);
  approach.detail += fmt::format("; then runs to the contact for {:.3f} s", duration);
  if (!arrival.abort) return;
  const TimedMotion& stop = *arrival.abort;
  approach.abort = AbortPath{stop.path.times,
                             stop.path.phi,
                             stop.path.phidot,
                             stop.base_poses,
                             arrival.retreat,
                             arrival.clearance,
                             effort_used(problem, stop.path, task.options.effort)};
}

}  // namespace stillbase
