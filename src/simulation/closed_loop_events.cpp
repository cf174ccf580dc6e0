// Stops, stick and slip, begin and end of the contact.
#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

#include "simulation/closed_loop.hpp"

namespace stillbase {
namespace {

/// A joint that would leave its stop more slowly than this rests there, rad/s (m/s): without it, a
/// joint pressed against a stop would rebound without end.
constexpr double kRestRate = 1e-5;
/// Rate into a stop below which it is not reversed.
constexpr double kNoRate = 1e-12;
/// Part of the friction torque by which more than it is needed before a joint slips: keeps rounding
/// from releasing a joint that just came to rest.
constexpr double kSlipSlack = 1e-9;

signed char sign_of(double x) { return static_cast<signed char>((x > 0) - (x < 0)); }

}  // namespace

void ClosedLoop::hold(int k, JointMode mode) {
  mode_[k] = mode;
  if (mode != JointMode::Moves) {
    slides_[k] = 0;
    if (held_.empty()) held_.assign(n(), false);
    held_[k] = true;
    return;
  }
  if (held_.empty()) return;
  held_[k] = false;
  if (std::find(held_.begin(), held_.end(), true) == held_.end()) held_.clear();
}

/// After a jump of the rates, or at the start: moving joints slide; joints at rest under friction
/// stick until release_one() releases them.
void ClosedLoop::classify(const PlantState& state, bool first) {
  for (int k = 0; k < n(); ++k) {
    const double rate = state.phidot[k];
    if (mode_[k] != JointMode::Moves && rate != 0) hold(k, JointMode::Moves);
    if (mode_[k] != JointMode::Moves || !(coulomb(k) > 0)) continue;
    slides_[k] = sign_of(rate);
    if (rate == 0 && first) hold(k, JointMode::Sticks);
  }
}

HandLoad ClosedLoop::hand_load(const StateVector& x, const PlantState& state,
                               const PlantTerms& terms) const {
  const TargetPlantState target = unpack_target(x, n());
  const HandJacobian<double> jacobian = compute_hand_jacobian(robot_, terms.kinematics);
  const Vector6d V_h = jacobian.R_bh * state.Omega + jacobian.J_phi * state.phidot;
  const Vector3d hand = state.base * terms.kinematics.r_bh;
  const Vector3d hand_velocity = state.base.orientation * V_h.head<3>();
  return contact_load(encounter_->contact, target, hand, hand_velocity);
}

ClosedLoop::JointEvent ClosedLoop::event_of(int k, const PlantState& state) const {
  if (mode_[k] != JointMode::Moves) return JointEvent::None;
  const Joint& joint = robot_.joints[k];
  const double rate = state.phidot[k];
  if (options_.joint_stops && state.phi[k] < joint.lower && rate < -kNoRate) {
    return JointEvent::LowerStop;
  }
  if (options_.joint_stops && state.phi[k] > joint.upper && rate > kNoRate) {
    return JointEvent::UpperStop;
  }
  return slides_[k] * rate < 0 ? JointEvent::Sticks : JointEvent::None;
}

ClosedLoop::Overload ClosedLoop::overload(double t, const StateVector& x, const PlantState& state) {
  Overload worst;
  if (held_.empty()) return worst;
  const PlantTerms& terms = terms_at(x, state);
  const Load forces = load(t, x, state);
  const PlantAcceleration motion = compute_acceleration(terms, forces.F_b, forces.tau, held_);
  const JointVectord needed = holding_torque(terms, motion, forces.tau);
  double most_beyond = 0;
  for (int k = 0; k < n(); ++k) {
    // A stop pushes in one direction, and friction adds to it.
    double torque = -kInfinity;
    if (mode_[k] == JointMode::Sticks) torque = std::abs(needed[k]);
    if (mode_[k] == JointMode::AtLower) torque = -needed[k];
    if (mode_[k] == JointMode::AtUpper) torque = needed[k];
    const double beyond = torque - coulomb(k) * (1 + kSlipSlack);
    if (!(beyond > most_beyond)) continue;
    worst = {k, needed[k]};
    most_beyond = beyond;
  }
  return worst;
}

ContactPhase ClosedLoop::next_phase(const HandLoad& hand) const {
  switch (contact_.phase) {
    case ContactPhase::Apart:
      return hand.gap < 0 ? ContactPhase::Touching : ContactPhase::Apart;
    case ContactPhase::Touching:
      return hand.normal_force < 0 && hand.gap_rate > 0 ? ContactPhase::Leaving
                                                        : ContactPhase::Touching;
    case ContactPhase::Leaving:
      // A controller may stop the hand before the gap opens: then the target pushes again.
      if (hand.normal_force > 0) return ContactPhase::Touching;
      break;
  }
  return hand.gap > 0 ? ContactPhase::Apart : ContactPhase::Leaving;
}

bool ClosedLoop::has_event(double t, const StateVector& x) {
  const PlantState state = unpack(x, n());
  for (int k = 0; k < n(); ++k) {
    if (event_of(k, state) != JointEvent::None) return true;
  }
  if (overload(t, x, state).joint >= 0) return true;
  return encounter_ != nullptr &&
         next_phase(hand_load(x, state, terms_at(x, state))) != contact_.phase;
}

bool ClosedLoop::handle_contact(double t, const StateVector& x) {
  if (encounter_ == nullptr) return false;
  const PlantState state = unpack(x, n());
  const HandLoad hand = hand_load(x, state, terms_at(x, state));
  const ContactPhase next = next_phase(hand);
  if (next == contact_.phase) return false;
  const bool begins = contact_.phase == ContactPhase::Apart;
  contact_.phase = next;
  if (begins && contact_.contacts++ == 0) contact_.first_begin = t;
  if (next == ContactPhase::Leaving && contact_.contacts == 1) {
    contact_.has_separated = true;
    contact_.first_end = t;
    contact_.first_separation_speed = hand.gap_rate;
  }
  return true;
}

bool ClosedLoop::release_one(double t, const StateVector& x) {
  const Overload worst = overload(t, x, unpack(x, n()));
  if (worst.joint < 0) return false;
  hold(worst.joint, JointMode::Moves);
  // It moves in the direction of the missing torque.
  if (coulomb(worst.joint) > 0) {
    slides_[worst.joint] = static_cast<signed char>(-sign_of(worst.torque));
  }
  return true;
}

bool ClosedLoop::handle_one_event(double t, StateVector& x, Recorder& recorder) {
  PlantState state = unpack(x, n());
  for (int k = 0; k < n(); ++k) {
    const JointEvent event = event_of(k, state);
    if (event == JointEvent::None) continue;
    const double rate = state.phidot[k];
    if (event == JointEvent::Sticks) {
      impose_joint_rate(terms_at(x, state), k, 0, held_, state);
      hold(k, JointMode::Sticks);
    } else {
      const bool is_lower = event == JointEvent::LowerStop;
      has_stopped_ = true;
      recorder.stop_reached(t, k, is_lower ? LimitKind::LowerStop : LimitKind::UpperStop, rate);
      const double rebound = -options_.stop_restitution * rate;
      const bool stays = std::abs(rebound) < kRestRate;
      // An impulse of the stop moves the other joints, held or not. A slow one must not release
      // them, or joints at their stops would push each other without end.
      const bool is_slow = std::abs(rate) < kRestRate;
      impose_joint_rate(terms_at(x, state), k, stays ? 0 : rebound,
                        is_slow ? held_ : std::vector<bool>(), state);
      if (stays) hold(k, is_lower ? JointMode::AtLower : JointMode::AtUpper);
    }
    classify(state, false);
    x = encounter_ != nullptr ? pack(state, unpack_target(x, n())) : pack(state);
    return true;
  }
  return handle_contact(t, x) || release_one(t, x);
}

bool ClosedLoop::handle_events(double t, StateVector& x, Recorder& recorder) {
  if (!has_started_) {
    has_started_ = true;
    classify(unpack(x, n()), true);
  }
  const int most = 50 * (n() + 2);
  for (int i = 0; i < most; ++i) {
    if (!handle_one_event(t, x, recorder)) return true;
  }
  return false;
}

}  // namespace stillbase
