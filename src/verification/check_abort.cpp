#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "verification/path_checks.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances and samples of the path to rest.
struct AbortCheckOptions {
  double inside = 1e-6;   ///< m that the hand may be within the target's surface, by two codes
  double retreat = 1e-6;  ///< rad (m): joint travel by two codes
  int looks = 8;          ///< per segment, at gaps: as often as a plan looks at torques
};
constexpr AbortCheckOptions kAbort;

/// The samples in the form of an approach.
Approach as_path(const AbortPath& abort) {
  Approach path;
  path.status = ApproachStatus::Found;
  path.times = abort.times;
  path.joint_positions = abort.joint_positions;
  path.joint_velocities = abort.joint_velocities;
  path.base_poses = abort.base_poses;
  return path;
}

void check_ends(const Context& context, const Approach& path, ClaimList& claims) {
  const Configuration& contact = context.situation.at;
  const std::optional<MotionOfRobot>& before = context.situation.response.before;
  const double rates =
      before ? (path.joint_velocities.front() - before->phidot).cwiseAbs().maxCoeff() : kInfinity;
  claims.at_most("abort_start",
                 std::max({largest_difference(context.problem.robot, path.joint_positions.front(),
                                              contact.phi, false),
                           pose_error(path.base_poses.front(), contact.base).largest(),
                           std::abs(path.times.front() - contact.contact_time), rates}),
                 kShared.rounding, "rad, m, s or rad/s",
                 "first sample from posture, base pose, time and joint rates at the contact");
  claims.at_most("abort_rest", path.joint_velocities.back().cwiseAbs().maxCoeff(), kShared.rounding,
                 "rad/s", "joint rates at the end");
}

/// The stated retreat: the joints come to rest evenly, and meanwhile travel what takes the hand by
/// this much along the normal, to first order and without turning it.
void check_retreat(const Context& context, const Approach& path, ClaimList& claims) {
  const auto d = reference::compute(context.problem.robot, {context.situation.at.phi, {}, {}});
  Vector6d along = Vector6d::Zero();
  along.head<3>() = context.situation.event.n;
  const Eigen::VectorXd per_metre = hand_response(d).completeOrthogonalDecomposition().solve(along);
  const double duration = path.times.back() - path.times.front();
  const Eigen::VectorXd travel = path.joint_positions.back() - path.joint_positions.front() -
                                 duration / 2 * path.joint_velocities.front();
  const double stated = context.plan.approach.abort->retreat;
  claims.at_most("abort_retreat", (travel - stated * per_metre).cwiseAbs().maxCoeff(),
                 kAbort.retreat, "rad or m",
                 fmt::format("joint travel from that of the stated retreat, {:.6g} m", stated));
}

void check_base(const Context& context, const Approach& path, const std::vector<BaseTrack>& tracks,
                ClaimList& claims) {
  double worst = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Pose found = tracks[i].pose(path.times[i + 1] - path.times[i]);
    worst = std::max(worst, pose_error(found, path.base_poses[i + 1]).largest());
  }
  claims.at_most("abort_base_steps", worst, context.options.base_step_tolerance, "m or rad",
                 "stored poses from those integrated from the sample before, without momentum");
}

/// The hand is off the feature's plane all along.
void check_gap(const Context& context, const Approach& path, const std::vector<BaseTrack>& tracks,
               const TargetMotion& target, ClaimList& claims) {
  const auto feature = feature_of(context.problem);
  if (!feature) return;
  double least = kInfinity, gap = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const HermiteSegment segment(path, i);
    for (int look = 1; look <= kAbort.looks; ++look) {
      const double s = segment.duration() * look / kAbort.looks;
      const auto d = reference::compute(context.problem.robot, {segment.position(s), {}, {}});
      const Vector3d hand = tracks[i].pose(s) * Vector3d(d.hand_position);
      const ContactState contact = target.contact(*feature, path.times[i] + s);
      gap = contact.normal.dot(hand - contact.point);
      least = std::min(least, gap);
    }
  }
  claims.at_least("abort_gap", least, 0, kAbort.inside, "m",
                  "smallest distance of the hand from the feature's plane");
  claims.at_least("abort_distance", gap, context.problem.approach.clearance, kAbort.inside, "m",
                  "the same where the robot is at rest");
}

}  // namespace

void check_abort(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const std::optional<AbortPath>& abort = context.plan.approach.abort;
  if (!problem.hand_motion.moves() || !problem.approach.abort) {
    if (!abort) return;
    Objections invented;
    invented.add("a path that the problem does not ask for");
    return claims.none_wrong("abort_found", invented, "no path to rest");
  }
  Objections missing;
  missing.demand(abort && abort->times.size() > 1, "no path");
  claims.none_wrong("abort_found", missing,
                    "a path to rest if the grasp does not close, as the problem demands");
  if (!missing.none()) return;
  const Approach path = as_path(*abort);
  check_ends(context, path, claims);
  check_path_limits(context, path, "abort", claims);
  check_torque_use(context, path, abort->effort_used, "abort", claims);
  check_retreat(context, path, claims);
  const std::vector<BaseTrack> tracks = base_tracks(problem, path);
  check_base(context, path, tracks, claims);
  const auto target =
      target_motion(problem, context.situation.at, context.situation.hand_N, path.times.back());
  if (!target) return;
  check_gap(context, path, tracks, *target, claims);
  check_path_clearance(context, path_clearance(context, path, &*target, tracks),
                       abort->min_clearance, "abort", "", claims);
}

}  // namespace stillbase::verification
