// Motion of the target after the contact: it bounces, is pushed on, stays at the hand, or is held.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances of the motion after a contact.
struct FateOptions {
  double rounding = 1e-9;  ///< of the closing speed: points that separate slower move on together
};
constexpr FateOptions kFate;

/// Velocity [v; omega] of the target's contact point per impulse [f; t] there: the force moves the
/// centroid and rotates the body about it.
Matrix6d target_response(const CaptureProblem& problem, const ContactEvent& event) {
  Matrix6d W;
  for (int i = 0; i < 6; ++i) {
    const Vector6d F = Vector6d::Unit(i);
    const Vector3d f = F.head<3>(), t = F.tail<3>();
    Vector3d omega = Vector3d::Zero(), v = f / problem.target->mass;
    if (problem.impulse.source == ImpulseSource::RigidBody) {
      omega = reference::solve_definite(event.target_inertia, event.r.cross(f) + t);
      v += omega.cross(event.r);
    }
    W.col(i) << v, omega;
  }
  return W;
}

/// @param target_speed of the target's contact point along n after the contact, m/s
std::string words(double target_speed, double separation, double closing) {
  const double least = kFate.rounding * closing;
  if (separation <= least) {
    return fmt::format("stays at the hand without being held: both move on at {:.4g} m/s",
                       target_speed);
  }
  if (target_speed < 0) {
    return fmt::format("bounced: it moves back at {:.4g} m/s, {:.4g} m/s relative to the hand",
                       -target_speed, separation);
  }
  return fmt::format("pushed on: it moves at {:.4g} m/s, {:.4g} m/s slower than the hand",
                     target_speed, separation);
}

void check_jump(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const ContactEvent& event = context.situation.event;
  const Vector3d n = event.n;
  const Vector6d Fbar = context.situation.impulse();
  const double closing = closing_speed(problem, event, n);
  const double hand = n.dot((context.situation.response.W * Fbar).head<3>());
  const double target = closing - n.dot((target_response(problem, event) * Fbar).head<3>());
  const double separation = hand - target;
  claims.at_least("target_fate", separation, problem.impulse.restitution * closing,
                  kFate.rounding * closing, "m/s", words(target, separation, closing));
}

/// Both points move on together; nothing holds them.
void check_sticking(const Context& context, ClaimList& claims) {
  const ContactEvent& event = context.situation.event;
  const reference::MetBody body = met_body(context.problem, event);
  const Vector3d before = body.velocity + body.omega.cross(body.r);
  const Vector6d Fbar = context.situation.impulse();
  Vector3d hand = (context.situation.response.W * Fbar).head<3>();
  if (const auto& motion = context.situation.response.before) hand += motion->hand.head<3>();
  const Vector3d target = before - (target_response(context.problem, event) * Fbar).head<3>();
  claims.at_most("target_fate", (hand - target).norm() / before.norm(),
                 context.options.momentum_tolerance, "1",
                 fmt::format("sticks without being held: both points move on at {:.4g} m/s; "
                             "their difference, relative to the target before",
                             target.norm()));
}

void check_compliant(const Context& context, const AfterContact& run, ClaimList& claims) {
  const ContactEvent& event = context.situation.event;
  const EncounterResult& encounter = *run.encounter;
  const ContactHistory& contact = encounter.contact;
  if (contact.contacts == 0 || contact.phase == ContactPhase::Touching) {
    claims.not_evaluated("target_fate", 0, "m/s",
                         contact.contacts == 0 ? "hand and target never touch"
                                               : "hand and target still touch at the horizon");
    return;
  }
  const Vector3d n_N = context.situation.at.base.orientation * event.n;
  const TargetPlantState& end = encounter.target_end;
  const Vector3d omega_N = end.pose.orientation * end.angular_velocity;
  Vector3d point_N = Vector3d::Zero();
  if (event.feature) {
    const Vector3d r_T = event.R_NT.conjugate() * Vector3d(event.feature->r);
    point_N = end.pose.orientation * r_T;
  }
  const double target = n_N.dot(end.velocity + omega_N.cross(point_N));
  claims.at_least(
      "target_fate", encounter.separation_speed, 0, 0, "m/s",
      fmt::format(
          "{}; {} contact{} of {:.3g} ms at first, up to {:.4g} N, {:.4g} N s in all",
          words(target, encounter.separation_speed, closing_speed(context.problem, event, event.n)),
          contact.contacts, contact.contacts == 1 ? "" : "s",
          1e3 * (contact.first_end - contact.first_begin),
          run.simulation.summary.peak_contact_force, encounter.impulse_N.norm()));
}

/// Robot and target at the start of the simulation, against the latch's own equations and the
/// target's momentum before the contact.
void check_latch(const Context& context, const AfterContact& run, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const ContactEvent& event = context.situation.event;
  const Configuration& at = context.situation.at;
  const TargetState state = context.situation.target()->state(at.contact_time);
  const Vector3d omega = at.base.orientation.conjugate() * state.angular_velocity;
  Vector6d V_t;
  V_t << *event.velocity, omega;
  const Matrix6d W_t = target_response(problem, event);
  Vector6d V_rel = V_t;
  if (const auto& motion = context.situation.response.before) V_rel -= motion->hand;
  const Vector6d Fbar = reference::solve_definite(context.situation.response.W + W_t, V_rel);
  const Vector6d target_after = V_t - W_t * Fbar;

  const PlantState& start = run.simulation.trace.front().state;
  const reference::Dynamics d =
      reference::compute(run.robot, {start.phi, start.phidot, start.Omega});
  Eigen::VectorXd x(6 + start.phidot.size());
  x << start.Omega, start.phidot;
  const Vector6d apart = d.J * x - target_after;
  claims.at_most(
      "target_fate", run.is_held ? apart.norm() / V_t.norm() : kInfinity,
      context.options.momentum_tolerance, "1",
      fmt::format("held: latched by {:.4g} N s and {:.4g} N m s at the hand; velocity of "
                  "the hand from that of the target after it, relative",
                  Fbar.head<3>().norm(), Fbar.tail<3>().norm()));

  // Momentum about the hand: the robot had none before.
  const Vector3d v_centroid = *event.velocity - omega.cross(event.r);
  const Vector3d p = problem.target->mass * v_centroid;
  const Vector3d spin = event.target_inertia * omega;
  const Vector3d l = spin - event.r.cross(p);
  const Vector3d L = d.L_g + Vector3d(d.centroid - d.hand_position).cross(d.P);
  const double error = std::max((d.P - p).norm() / p.norm(),
                                (L - l).norm() / (spin.norm() + event.r.norm() * p.norm()));
  claims.at_most("latch_momentum", error, context.options.momentum_tolerance, "1",
                 "momentum of robot with target from that of the target before, relative");
}

}  // namespace

void check_target_fate(const Context& context, const AfterContact* run, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  if (!problem.target || problem.impulse.source == ImpulseSource::Given) return;
  if (problem.impulse.contact == ContactLaw::Latch) {
    if (run != nullptr) check_latch(context, *run, claims);
  } else if (problem.impulse.contact == ContactLaw::Sticking) {
    check_sticking(context, claims);
  } else if (problem.post_impact.contact.model == ContactModel::Instantaneous) {
    check_jump(context, claims);
  } else if (run != nullptr && run->encounter) {
    check_compliant(context, *run, claims);
  }
}

}  // namespace stillbase::verification
