// Torques that the approach takes.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/path_motion.hpp"

namespace stillbase::verification {
namespace {

/// Torques follow from accelerations, which round as second differences of the positions.
constexpr double kTorqueTolerance = 1e-8;

/// Torques by the second implementation of the dynamics: M [Omega'; phi''] + c = [0; tau], the base
/// floating without momentum or held; rotor inertias rotate with their joints.
Eigen::VectorXd torques(const Context& context, const Eigen::VectorXd& phi,
                        const Eigen::VectorXd& phidot, const Eigen::VectorXd& phiddot) {
  const CaptureProblem& problem = context.problem;
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

}  // namespace

void check_torques(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  constexpr int kLooks = 8;  // per segment, as often as a plan states it
  double size = 0;
  Largest used;
  std::vector<Eigen::VectorXd> found;
  for (std::size_t i = 0; i + 1 < approach.times.size(); ++i) {
    const HermiteSegment segment(approach, i);
    for (int look = 0; look <= kLooks; ++look) {
      const double s = segment.duration() * look / kLooks;
      const Eigen::VectorXd tau =
          torques(context, segment.position(s), segment.velocity(s), segment.acceleration(s));
      for (int k = 0; k < context.problem.robot.n(); ++k) {
        const Joint& joint = context.problem.robot.joints[k];
        used.take(std::abs(tau(k)) / joint.max_effort,
                  fmt::format("{} at {:.3f} s", joint.name, approach.times[i] + s));
      }
      if (look > 0) continue;
      found.push_back(tau);
      size = std::max(size, tau.norm());
    }
  }
  double difference = approach.joint_torques.back().cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < found.size(); ++i) {
    difference = std::max(difference, relative_error(approach.joint_torques[i], found[i], size));
  }
  claims.same("approach_stated_torques", difference, kTorqueTolerance,
              fmt::format("up to {:.6g} N m at the samples", size));
  claims.at_most("approach_joint_torques", used.value, 1 + context.options.limit_slack, "1",
                 "largest fraction of a torque limit: " + used.place);
  claims.same("approach_effort_used", relative_error(approach.effort_used, used.value),
              kTorqueTolerance,
              fmt::format("largest fraction of a torque limit, {:.6g}", used.value));
}

}  // namespace stillbase::verification
