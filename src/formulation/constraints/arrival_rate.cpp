// Rates of the joints right before a contact with a hand that moves: those that the approach may
// use.
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/dynamics/inertia.hpp>

#include "formulation/constraints/singular_value_kernel.hpp"

namespace stillbase {

namespace {

/// The arm must be able to move the hand as wanted in almost every posture.
void require_rank(const CaptureModel& model) {
  const MatchedPart part = model.encounter.matched;
  const int rank = generic_rank(model, [&](const PostureImpact<double>& posture) {
    Eigen::MatrixXd J = compute_hat_inertia<double>(posture.inertia, posture.jacobian).Jhat_phi;
    if (part == MatchedPart::All) return J;
    return Eigen::MatrixXd(part == MatchedPart::Angular ? J.bottomRows(3) : J.topRows(3));
  });
  // Of a match along the normal, which lies in the target: the arm can move the hand along some
  // direction where it can move it at all.
  if (rank >= matched_components(part)) return;
  throw InputError({Finding{
      model.problem.source, 0, "hand-velocity",
      fmt::format(
          "contact.hand_velocity: decides {} components of the hand's velocity, but the arm "
          "moves the hand in {} of them; match fewer",
          matched_components(part), rank)}});
}

}  // namespace

void add_arrival_rate(const CaptureModel& model, ConstraintSet& out) {
  if (!model.encounter.hand_moves()) return;
  require_rank(model);
  for (int k = 0; k < model.n(); ++k) {
    const Joint& joint = model.problem.robot.joints[static_cast<std::size_t>(k)];
    const double limit = model.problem.approach.velocity_scale * joint.max_velocity;
    if (!std::isfinite(limit)) continue;
    const auto rate = [k]<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
      if (gradient != nullptr) {
        HandMotionWeights<S> weights;
        weights.phidot.setZero(at.model.n());
        weights.phidot[k] = S(1);
        *gradient = at.model.template motion_before_gradient<S>(at.posture, at.impact, weights);
      }
      return at.impact.rigid.before.phidot[k];
    };
    const char* const unit = joint.is_prismatic() ? "m/s" : "rad/s";
    add_constraint(out.rows,
                   {.name = "arrival_rate_" + joint.name,
                    .unit = unit,
                    .lower = -limit,
                    .upper = limit,
                    .needs_impact = true,
                    .is_limit = true},
                   rate);
  }
}

}  // namespace stillbase
