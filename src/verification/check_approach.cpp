// The approach path as stored: ends, limits, torques, base motion, clearances.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/path_checks.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances, steps and samples of a path.
struct ApproachCheckOptions {
  double beyond_limit = 1e-6;  ///< rad, m: overshoot of a segment that ends at a limit
  /// rad, joint travel of one integration step: the error of a step is its fifth power.
  double travel_per_step = 0.005;
  /// m: the same distance by the same function. Base poses between samples agree to about 1e-6 m
  /// and rad, with a lever of the arm's length.
  double stated_distance = 1e-5;
  /// Relative: accelerations are second differences of the positions, which round to about 1e-15.
  double acceleration = 1e-13;
  /// Relative: torques follow from accelerations, which round as second differences.
  double torque = 1e-8;
  int chords = 8;        ///< per segment, that define the length of a path in a plan
  int torque_looks = 8;  ///< per segment, as often as a plan states torques
};
constexpr ApproachCheckOptions kApproach;

/// Euclidean length in joint space, by the eight chords per segment that define it in a plan.
double path_length(const Approach& approach) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < approach.times.size(); ++i) {
    const HermiteSegment segment(approach, i);
    for (int j = 0; j < kApproach.chords; ++j) {
      const double s = segment.duration() / kApproach.chords;
      length += (segment.position((j + 1) * s) - segment.position(j * s)).norm();
    }
  }
  return length;
}

/// Hand and target at the last sample, by the stored rates and base velocity.
void check_arrival_velocity(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  const Situation& situation = context.situation;
  const reference::Dynamics d =
      reference::compute(context.problem.robot, {approach.joint_positions.back(), {}, {}});
  Eigen::VectorXd x(6 + context.problem.robot.n());
  x << approach.base_velocities.back(), approach.joint_velocities.back();
  const Vector6d hand = d.J * x;
  Vector6d target;
  target << *situation.event.velocity, situation.event.omega;
  const DecidedVelocity decided = decided_velocity(context.problem, situation.event, situation.at);
  claims.at_most("approach_arrival_match", decided.error(hand), kShared.matched_velocity,
                 "m/s or rad/s",
                 fmt::format("velocity of the hand at the last sample from the {} components that "
                             "the problem decides",
                             decided.values.size()));
  // As the contact asks for it: zero of a hand that matches all.
  const Vector6d wanted = target - situation.response.before->hand;
  claims.at_most("approach_arrival_velocity", (target - hand - wanted).cwiseAbs().maxCoeff(),
                 kShared.matched_velocity, "m/s or rad/s",
                 fmt::format("velocity of the target less that of the hand at the last sample, "
                             "{:.3g} m/s and {:.3g} rad/s, from the one that the contact asks for",
                             (target - hand).head<3>().norm(), (target - hand).tail<3>().norm()));
}

void check_ends(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const Approach& approach = context.plan.approach;
  const Configuration& goal = context.plan.configuration;
  const std::size_t last = approach.times.size() - 1;

  claims.at_most(
      "approach_start",
      largest_difference(problem.robot, approach.joint_positions.front(), problem.start, true),
      kShared.rounding, "rad", "first posture from the problem's start posture");
  claims.at_most(
      "approach_arrival",
      largest_difference(problem.robot, approach.joint_positions.back(), goal.phi, false),
      kShared.rounding, "rad", "last posture from the configuration");
  claims.at_most("approach_contact_time", std::abs(approach.times.back() - goal.contact_time),
                 kShared.rounding, "s", "last time from the contact time");
  const std::optional<MotionOfRobot>& moving = context.situation.response.before;
  const Eigen::VectorXd wanted =
      moving ? moving->phidot : Eigen::VectorXd(Eigen::VectorXd::Zero(problem.robot.n()));
  const Eigen::VectorXd at_contact = approach.joint_velocities.back() - wanted;
  claims.at_most("approach_rest",
                 std::max(approach.joint_velocities.front().cwiseAbs().maxCoeff(),
                          at_contact.cwiseAbs().maxCoeff()),
                 kShared.rounding, "rad/s",
                 moving ? "joint rates at the start, and from those of the contact at the end"
                        : "joint rates at both ends");
  if (moving) check_arrival_velocity(context, claims);

  // The wait: how long the joints have been at rest at the contact, or before the last run to it.
  std::size_t leaves = last;
  while (moving && leaves > 0 && !approach.joint_velocities[leaves].isZero(0)) --leaves;
  std::size_t arrival = leaves;
  while (arrival > 0 && approach.joint_positions[arrival - 1] == approach.joint_positions[leaves] &&
         approach.joint_velocities[arrival - 1].isZero(0)) {
    --arrival;
  }
  const double wait = approach.times[leaves] - approach.times[arrival];
  claims.at_least(
      "approach_wait", wait, problem.approach.wait, kShared.rounding, "s",
      moving ? "time at rest before the run to the contact" : "time at rest before the contact");
  claims.at_most("approach_duration", approach.times[last] - approach.times.front(),
                 problem.approach.max_duration * (1 + kShared.rounding), "s",
                 "from the start to the contact");
  claims.at_most("approach_stated_duration",
                 std::abs(approach.times[arrival] - approach.times.front() +
                          (approach.times[last] - approach.times[leaves]) - approach.duration),
                 kShared.rounding, "s", "stated time of motion");
  if (!problem.impulse.direction && problem.target) {
    claims.at_least("approach_begins", approach.times.front(), problem.target_state.time,
                    kShared.rounding, "s", "not before the time of the target's estimate");
  }

  const double length = path_length(approach);
  claims.same("approach_path_length", relative_error(approach.path_length, length),
              context.options.recompute_tolerance, fmt::format("{:.6g} rad", length));
}

/// Stated accelerations against those of the segments, relative to their rounding: the sizes of
/// positions and rates over the square of the time between samples.
void check_accelerations(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  double worst = approach.joint_accelerations.back().cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i + 1 < approach.times.size(); ++i) {
    const HermiteSegment segment(approach, i);
    const double h = segment.duration();
    const Eigen::VectorXd size =
        segment.position(0).cwiseAbs() + segment.position(h).cwiseAbs() +
        h * (segment.velocity(0).cwiseAbs() + segment.velocity(h).cwiseAbs());
    const Eigen::VectorXd difference =
        h * h * (approach.joint_accelerations[i] - segment.acceleration(0)).cwiseAbs();
    for (Eigen::Index k = 0; k < size.size(); ++k) {
      if (difference(k) > 0) worst = std::max(worst, difference(k) / size(k));
    }
  }
  claims.at_most("approach_stated_accelerations", worst, kApproach.acceleration, "1",
                 "stated accelerations against those of the segments, relative to positions and "
                 "rates over the time between samples");
}

/// The stated torques against those at the samples.
void check_stated_torques(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  double size = 0;
  std::vector<Eigen::VectorXd> found;
  for (std::size_t i = 0; i + 1 < approach.times.size(); ++i) {
    const HermiteSegment segment(approach, i);
    found.push_back(path_torques(context.problem, segment.position(0), segment.velocity(0),
                                 segment.acceleration(0)));
    size = std::max(size, found.back().norm());
  }
  double difference = approach.joint_torques.back().cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < found.size(); ++i) {
    difference = std::max(difference, relative_error(approach.joint_torques[i], found[i], size));
  }
  claims.same("approach_stated_torques", difference, kApproach.torque,
              fmt::format("up to {:.6g} N m at the samples", size));
}

/// Integrated poses at all samples, from the first stored one on.
std::vector<Pose> integrated_poses(const Context& context, const std::vector<BaseTrack>& tracks,
                                   double* worst_step) {
  const Approach& approach = context.plan.approach;
  std::vector<Pose> poses{approach.base_poses.front()};
  *worst_step = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (context.problem.approach.base == BaseMode::Held) {
      poses.push_back(poses.back());
    } else {
      const Pose stored = tracks[i].pose(approach.times[i + 1] - approach.times[i]);
      // The motion of the base does not depend on where it starts: one integration serves both.
      poses.push_back(poses.back() * (approach.base_poses[i].inverse() * stored));
      *worst_step = std::max(*worst_step, pose_error(stored, approach.base_poses[i + 1]).largest());
    }
  }
  return poses;
}

/// |H_b Omega + H_bphi phidot| relative to the two terms, linear and angular part apart.
double relative_momentum(const RobotModel& robot, const JointVectord& phi, const Vector6d& Omega,
                         const JointVectord& phidot) {
  const auto d = reference::compute(robot, {phi, {}, {}});
  const Vector6d base = d.H.topLeftCorner<6, 6>() * Omega;
  const Vector6d joints = d.H.topRightCorner(6, phi.size()) * phidot;
  double worst = 0;
  for (const int row : {0, 3}) {
    const double left = (base + joints).segment<3>(row).norm();
    const double size = base.segment<3>(row).norm() + joints.segment<3>(row).norm();
    if (left > 0) worst = std::max(worst, left / size);
  }
  return worst;
}

void check_base(const Context& context, const std::vector<Pose>& poses, double worst_step,
                ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const Approach& approach = context.plan.approach;
  const VerifyOptions& options = context.options;
  const bool held = problem.approach.base == BaseMode::Held;
  const char* how = held ? "the base is held" : "the base floats without momentum";

  double worst_pose = 0, momentum = 0, rate = 0, excursion = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    worst_pose = std::max(worst_pose, pose_error(poses[i], approach.base_poses[i]).largest());
    const Vector6d& Omega = approach.base_velocities[i];
    rate = std::max(rate, Omega.cwiseAbs().maxCoeff());
    if (!held) {
      momentum = std::max(momentum, relative_momentum(problem.robot, approach.joint_positions[i],
                                                      Omega, approach.joint_velocities[i]));
    }
    excursion = std::max(excursion,
                         pose_error(approach.base_poses[i], context.plan.configuration.base).angle);
  }
  claims.at_most("approach_base_poses", worst_pose, options.base_path_tolerance, "m or rad",
                 fmt::format("{}: stored poses from those integrated from the first one", how));
  if (held) {
    claims.at_most("approach_base_rates", rate, kShared.rounding, "m/s or rad/s",
                   "stored base velocities");
  } else {
    claims.at_most("approach_base_steps", worst_step, options.base_step_tolerance, "m or rad",
                   "stored poses from those integrated from the sample before");
    claims.at_most("approach_momentum", momentum, options.momentum_tolerance, "1",
                   "momentum at the samples relative to that of the joints' motion");
  }
  claims.at_most("approach_base_arrival",
                 pose_error(approach.base_poses.back(), context.plan.configuration.base).largest(),
                 kShared.rounding, "m or rad", "last base pose from the configuration");
  if (!problem.approach.station_free) {
    claims.at_most("approach_base_start",
                   pose_error(approach.base_poses.front(), problem.base).largest(),
                   kShared.rounding, "m or rad", "first base pose from the stated one");
  }
  if (problem.approach.base == BaseMode::ReactionNull) {
    claims.at_most("approach_attitude_kept", excursion, problem.approach.attitude_tolerance, "rad",
                   "largest change from the final attitude in the reaction null space");
  }
  claims.at_most("approach_attitude_excursion", std::abs(approach.attitude_excursion - excursion),
                 kShared.rounding, "rad",
                 fmt::format("largest change from the final attitude, {:.6g} rad", excursion));

  claims.at_most("approach_hand_error",
                 std::max(approach.hand_position_error, approach.hand_angle_error),
                 options.hand_position_tolerance, "m or rad",
                 "stated distance of the hand at the end of the path from the contact");

  // The end of the hand's path, by the integrated motion alone.
  const auto at_rest = reference::compute(problem.robot, {approach.joint_positions.back(), {}, {}});
  const auto wanted = reference::compute(problem.robot, {context.plan.configuration.phi, {}, {}});
  const Pose& base = context.plan.configuration.base;
  claims.at_most(
      "approach_hand_arrival",
      (poses.back() * Vector3d(at_rest.hand_position) - base * Vector3d(wanted.hand_position))
          .norm(),
      options.base_path_tolerance * (1 + wanted.hand_position.norm()), "m",
      "hand at the end of the integrated motion from its position at the contact");
}

void check_clearance(const Context& context, const std::vector<BaseTrack>& tracks,
                     ClaimList& claims) {
  const PathClearance found = path_clearance(context, tracks);
  if (found.complete) {
    claims.at_most("approach_distance_codes", found.difference_of_codes, kShared.flat_distance, "m",
                   "smallest distances at the samples by two codes, largest difference" +
                       (found.differs_most.empty() ? "" : ": " + found.differs_most));
  }
  check_path_clearance(context, found, context.plan.approach.min_clearance, "approach",
                       "; hand and target included until the feature is within reach", claims);
}

}  // namespace

double largest_difference(const RobotModel& robot, const JointVectord& a, const JointVectord& b,
                          bool modulo_full_rotations) {
  // A joint that others follow is elsewhere after a full rotation, and so are they.
  std::vector<int> bodies(static_cast<std::size_t>(robot.n()), 0);
  for (const Coupling& c : robot.couplings) {
    bodies[static_cast<std::size_t>(c.joint)] += c.ratio == 1 ? 1 : 2;
  }
  double largest = 0;
  for (int k = 0; k < robot.n(); ++k) {
    const double difference = a(k) - b(k);
    const bool wraps = modulo_full_rotations && robot.joints[k].type == JointType::Continuous &&
                       bodies[static_cast<std::size_t>(k)] <= 1;
    largest = std::max(largest, std::abs(wraps ? wrap_angle(difference) : difference));
  }
  return largest;
}

void check_path_limits(const Context& context, const Approach& path, const std::string& name,
                       ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  Largest beyond, rate, acceleration;
  for (std::size_t i = 0; i + 1 < path.times.size(); ++i) {
    const HermiteSegment::Extremes e = HermiteSegment(path, i).extremes();
    for (int k = 0; k < problem.robot.n(); ++k) {
      const Joint& joint = problem.robot.joints[k];
      const std::string place = fmt::format("{} at {:.3f} s", joint.name, path.times[i]);
      beyond.take(std::max(joint.lower - e.lowest(k), e.highest(k) - joint.upper), place);
      rate.take(e.rate(k) / (joint.max_velocity * problem.approach.velocity_scale), place);
      acceleration.take(e.acceleration(k) / problem.approach.acceleration_limit(k), place);
    }
  }
  const double slack = context.options.limit_slack;
  claims.at_most(name + "_joint_limits", beyond.value, kApproach.beyond_limit, "rad",
                 "furthest beyond a joint limit between the samples: " + beyond.place);
  claims.at_most(name + "_joint_rates", rate.value, 1 + slack, "1",
                 "largest fraction of a rate limit: " + rate.place);
  claims.at_most(name + "_joint_accelerations", acceleration.value, 1 + slack, "1",
                 "largest fraction of an acceleration limit: " + acceleration.place);
}

void check_torque_use(const Context& context, const Approach& path, double stated,
                      const std::string& name, ClaimList& claims) {
  Largest used;
  for (std::size_t i = 0; i + 1 < path.times.size(); ++i) {
    const HermiteSegment segment(path, i);
    for (int look = 0; look <= kApproach.torque_looks; ++look) {
      const double s = segment.duration() * look / kApproach.torque_looks;
      const Eigen::VectorXd tau = path_torques(context.problem, segment.position(s),
                                               segment.velocity(s), segment.acceleration(s));
      for (int k = 0; k < context.problem.robot.n(); ++k) {
        const Joint& joint = context.problem.robot.joints[k];
        used.take(std::abs(tau(k)) / joint.max_effort,
                  fmt::format("{} at {:.3f} s", joint.name, path.times[i] + s));
      }
    }
  }
  claims.at_most(name + "_joint_torques", used.value, 1 + context.options.limit_slack, "1",
                 "largest fraction of a torque limit: " + used.place);
  claims.same(name + "_effort_used", relative_error(stated, used.value), kApproach.torque,
              fmt::format("largest fraction of a torque limit, {:.6g}", used.value));
}

void check_path_clearance(const Context& context, const PathClearance& found, double stated,
                          const std::string& name, const std::string& included, ClaimList& claims) {
  const double clearance = context.problem.approach.clearance;
  if (!found.complete) {
    claims.not_evaluated(name + "_clearance", clearance, "m", found.detail);
    return;
  }
  if (found.least.found == kInfinity) {
    claims.at_most(name + "_clearance", 0, 0, "m", "no pair of bodies could collide");
    return;
  }
  // Without a clearance the bodies must still be apart.
  claims.at_least(
      name + "_clearance", found.least.proven, clearance,
      std::min(clearance, kShared.flat_distance), "m",
      fmt::format("no distance is smaller between the samples, proven with {} instants; smallest "
                  "found {:.6g} m, {} at {:.3f} s{}",
                  found.instants, found.least.found, found.least.pair, found.least.time, included));
  // A plan states the smallest of the distances half a resolution apart. Between them it may be
  // smaller, so a stated one is between the two.
  const bool is_none = found.of_path.found == kInfinity;
  const double fine = is_none ? 0 : found.of_path.proven;
  const double coarse = found.distance_as_stated.value_or(0);
  const double difference =
      is_none && std::isinf(stated) ? 0 : std::max(fine - stated, stated - coarse);
  claims.at_most(name + "_stated_clearance", difference, kApproach.stated_distance, "m",
                 fmt::format("stated smallest clearance without hand against target, {:.6g} m, "
                             "from [{:.9g}, {:.9g}], proven and at the planner's steps",
                             stated, fine, std::max(fine, coarse)));
}

Eigen::VectorXd path_torques(const CaptureProblem& problem, const Eigen::VectorXd& phi,
                             const Eigen::VectorXd& phidot, const Eigen::VectorXd& phiddot) {
  const Eigen::Index n = phi.size();
  const bool held = problem.approach.base == BaseMode::Held;
  Vector6d Omega = Vector6d::Zero(), dot_Omega = Vector6d::Zero();
  if (!held) Omega = drifting_base_velocity(problem.robot, phi, phidot);
  const reference::Dynamics d = reference::compute(problem.robot, {phi, phidot, Omega});
  if (!held) {
    const Vector6d load = d.H.topRightCorner(6, n) * phiddot + d.c.head<6>();
    dot_Omega = -reference::solve_definite(d.H.topLeftCorner(6, 6), load);
  }
  Eigen::VectorXd tau =
      d.H.bottomRightCorner(n, n) * phiddot + d.H.bottomLeftCorner(n, 6) * dot_Omega + d.c.tail(n);
  if (problem.resistance.model == ResistanceModel::RotorInertia) {
    tau += problem.resistance.rotor_inertia.cwiseProduct(phiddot);
  }
  return tau;
}

std::vector<BaseTrack> base_tracks(const CaptureProblem& problem, const Approach& path) {
  std::vector<BaseTrack> tracks;
  for (std::size_t i = 0; i + 1 < path.times.size(); ++i) {
    const HermiteSegment segment(path, i);
    const Pose& from = path.base_poses[i];
    if (problem.approach.base == BaseMode::Held) {
      tracks.emplace_back(segment, from);
    } else {
      tracks.emplace_back(problem.robot, segment, from, kApproach.travel_per_step);
    }
  }
  return tracks;
}

void check_approach(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  if (!context.problem.approach.enabled) {
    Objections invented;
    invented.demand(
        approach.status != ApproachStatus::Found && approach.times.empty() && !approach.abort,
        "a path that the problem does not ask for");
    if (!invented.none()) claims.none_wrong("approach_found", invented, "no approach");
    return;
  }
  Objections missing;
  missing.demand(approach.status == ApproachStatus::Found,
                 approach.detail.empty() ? "no path" : approach.detail);
  claims.none_wrong(
      "approach_found", missing,
      fmt::format("the problem demands an approach; {} samples", approach.times.size()));
  if (!missing.none()) return;
  claims.at_most("approach_late_by", approach.late_by, 0, "s", "a path that is found is not late");
  check_ends(context, claims);
  check_path_limits(context, approach, "approach", claims);
  check_accelerations(context, claims);
  check_stated_torques(context, claims);
  check_torque_use(context, approach, approach.effort_used, "approach", claims);
  double worst_step = 0;
  const std::vector<BaseTrack> tracks = base_tracks(context.problem, approach);
  const std::vector<Pose> poses = integrated_poses(context, tracks, &worst_step);
  check_base(context, poses, worst_step, claims);
  check_clearance(context, tracks, claims);
  check_abort(context, claims);
}

}  // namespace stillbase::verification
