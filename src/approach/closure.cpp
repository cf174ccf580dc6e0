#include "approach/closure.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "approach/base_motion.hpp"

namespace stillbase {

namespace {

Vector6d pose_error(const Pose& from, const Pose& to) {
  Vector6d e;
  e << to.position - from.position, rotation_log(from.orientation.conjugate() * to.orientation);
  return e;
}

Pose moved(const Pose& pose, const Vector6d& by) {
  return {pose.position + by.head<3>(), pose.orientation * rotation_exp(by.tail<3>())};
}

/// Joint path shifted smoothly, by nothing at its start and by `shift` (n) at its end.
JointPath shifted(const JointPath& path, const JointVectord& shift) {
  JointPath out = path;
  const double begin = path.times.front(), duration = path.times.back() - begin;
  if (!(duration > 0)) return out;
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    const double u = (path.times[i] - begin) / duration;
    out.phi[i] += (u * u * u * (10 + u * (6 * u - 15))) * shift;
    out.phidot[i] += (30 * u * u * (1 - u) * (1 - u) / duration) * shift;
  }
  out.phidot.front().setZero();
  out.phidot.back().setZero();
  return out;
}

/// From an assumed final base pose to the pose in which the path to its posture leaves the base.
struct Loop {
  const CaptureProblem& problem;
  const JointPath& path;
  const ContactSolver& solve;
  double far;

  bool go(const Pose& base, ContactSolve how, ClosedPath& out) const {
    const auto end = solve.at_base(base, how);
    if (!end) return false;
    const JointVectord shift = end->phi - path.phi.back();
    if (!(shift.lpNorm<Eigen::Infinity>() < far)) return false;
    out.end = *end;
    out.path = shifted(path, shift);
    out.path.phi.back() = end->phi;
    out.base_poses = base_poses_from(problem.robot, out.path, problem.base);
    out.open = pose_error(base, out.base_poses.back()).norm();
    return true;
  }
};

/// d(pose left - pose assumed) / d(pose assumed).
std::optional<Matrix6d> slope(const Loop& loop, const Pose& base, const Vector6d& at, double step) {
  Matrix6d J;
  for (int k = 0; k < 6; ++k) {
    ClosedPath there;
    const Pose beside = moved(base, step * Vector6d::Unit(k));
    if (!loop.go(beside, ContactSolve::Nearest, there)) return std::nullopt;
    J.col(k) = (pose_error(beside, there.base_poses.back()) - at) / step;
  }
  return J;
}

}  // namespace

ClosedPath close_path(const CaptureProblem& problem, const JointPath& path, const Pose& assumed,
                      const ContactSolver& solve, const ClosureOptions& options) {
  const Loop loop{problem, path, solve, options.far};
  Pose base = assumed;
  ClosedPath best, now;
  best.open = kInfinity;
  // Fixed-point iteration: the best posture changes with the pose, and so does the path to it.
  for (int round = 0; round < options.follow_rounds; ++round) {
    if (!loop.go(base, ContactSolve::Best, now)) break;
    if (now.open < best.open) best = now;
    if (now.open < options.converged) break;
    const Vector6d change = pose_error(base, now.base_poses.back());
    base = moved(base, std::min(1.0, options.stride / change.norm()) * change);
  }
  if (!std::isfinite(best.open)) return best;
  // Then Newton's method with the nearest posture that solves the contact.
  base = best.open < options.stride ? best.base_poses.back() : base;
  if (!loop.go(base, ContactSolve::Nearest, now)) return best;
  const auto J = slope(loop, base, pose_error(base, now.base_poses.back()), options.difference);
  if (!J) return best;
  const Eigen::PartialPivLU<Matrix6d> newton(*J);
  for (int round = 0; round < options.newton_rounds; ++round) {
    if (now.open < best.open || round == 0) best = now;
    if (best.open < options.closed) break;
    base = moved(base, -newton.solve(pose_error(base, now.base_poses.back())));
    if (!loop.go(base, ContactSolve::Nearest, now)) break;
  }
  best.closed = best.open < options.closed;
  return best;
}

}  // namespace stillbase
