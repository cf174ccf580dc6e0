#include "verification/target_prediction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "reference/tumbling.hpp"

namespace stillbase::verification {
namespace {

using reference::Tumbling;

/// Where two predictions are compared, and the errors of one.
struct PredictionCheckOptions {
  int instants = 9;  ///< at which motions are compared, from the approach's start to the contact
  /// Of the estimated rate: a hundred times the rounding errors of a prediction. No code can say
  /// how a target moves whose motion this changes visibly.
  double rounding = 1e-13;
};
constexpr PredictionCheckOptions kPrediction;

double difference(const Tumbling& a, const Tumbling& b) {
  const double rate = std::max(a.omega.norm(), b.omega.norm());
  return std::max(a.R_NT.angularDistance(b.R_NT), (a.omega - b.omega).norm() / rate);
}

/// Largest difference of a contact feature's point, normal and velocity.
double difference(const ContactState& stated, const ContactFeature& feature,
                  const TargetState& estimate, const Tumbling& own, double dt) {
  const Vector3d r = own.R_NT * feature.point;
  const Vector3d along = dt * estimate.linear_velocity;
  const Vector3d spin = own.R_NT * own.omega.cross(feature.point);
  const double length = estimate.pose.position.norm() + along.norm() + r.norm();
  const double speed = estimate.linear_velocity.norm() + own.omega.norm() * r.norm();
  const double off = (stated.point - (estimate.pose.position + along + r)).norm();
  const double off_rate = (stated.velocity - (estimate.linear_velocity + spin)).norm();
  return std::max({length > 0 ? off / length : off, speed > 0 ? off_rate / speed : off_rate,
                   angle_between(stated.normal, own.R_NT * feature.normal)});
}

}  // namespace

PredictionDifference prediction_difference(const TargetBody& body, const TargetState& estimate,
                                           const TargetMotion& motion,
                                           const std::vector<double>& times,
                                           const StopCondition& stop) {
  const Eigen::Quaterniond R_NT = estimate.pose.orientation.normalized();
  const Tumbling start{R_NT, R_NT.conjugate() * estimate.angular_velocity};
  const double rate = start.omega.norm();
  std::array<Tumbling, 3> rounded{start, start, start};
  for (int axis = 0; axis < 3; ++axis) {
    rounded[static_cast<std::size_t>(axis)].omega[axis] += kPrediction.rounding * rate;
  }

  PredictionDifference out;
  for (const double time : times) {
    const double dt = time - estimate.time;
    const double turned = 1 + std::abs(dt) * rate;
    const auto own = reference::tumble(body.inertia, start, dt, stop);
    if (!own) return out;
    for (const Tumbling& from : rounded) {
      const auto other = reference::tumble(body.inertia, from, dt, stop);
      if (!other) return out;
      out.growth = std::max(out.growth, difference(*own, *other) / turned);
    }
    const TargetState stated = motion.state(time);
    const Eigen::Quaterniond& R = stated.pose.orientation;
    const Tumbling there{R, R.conjugate() * stated.angular_velocity};
    out.largest = std::max(out.largest, difference(*own, there) / turned);
    for (const ContactFeature& feature : body.features) {
      const double off = difference(motion.contact(feature, time), feature, estimate, *own, dt);
      out.largest = std::max(out.largest, off / turned);
    }
  }
  out.complete = true;
  return out;
}

void check_target_prediction(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  if (!problem.target || problem.impulse.direction || problem.target->is_point_mass) return;
  if (problem.target_state.angular_velocity.isZero(0)) return;
  constexpr const char* kName = "target_prediction";

  const double contact = context.situation.at.contact_time;
  const std::vector<double>& path = context.plan.approach.times;
  const double first = path.empty() ? contact : path.front();
  std::vector<double> times;
  for (int i = 0; i < kPrediction.instants; ++i) {
    times.push_back(first + (contact - first) * i / (kPrediction.instants - 1));
  }
  const double limit = context.options.prediction_tolerance;
  const PredictionDifference found =
      prediction_difference(*problem.target, problem.target_state, *context.situation.target(),
                            times, context.options.stop);
  if (!found.complete) {
    return claims.not_verified(kName, "the second integration was stopped before its end");
  }
  if (found.growth > limit) {
    return claims.not_verified(
        kName, fmt::format("the target rotates about an unstable axis: rounding of its estimate "
                           "grows to {:.2g} per radian turned",
                           found.growth));
  }
  claims.at_most(kName, found.largest, limit, "1",
                 "the target's motion until the contact by a second integration, largest "
                 "difference, relative, per radian turned");
}

}  // namespace stillbase::verification
