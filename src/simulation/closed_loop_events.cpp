// Stops, stick and slip, begin and end of the contact.
#include <algorithm>
#include <cmath>

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
  const std::size_t i = static_cast<std::size_t>(k);
  mode_[i] = mode;
  if (mode != JointMode::Moves) {
    slides_[i] = 0;
    if (held_.empty()) held_.assign(static_cast<std::size_t>(n()), false);
    held_[i] = true;
    return;
  }
  if (held_.empty()) return;
  held_[i] = false;
  if (std::find(held_.begin(), held_.end(), true) == held_.end()) held_.clear();
}

/// After the rates have jumped (or at the start): what moves, slides; what rests under friction
/// sticks until release_one() says otherwise.
void ClosedLoop::classify(const PlantState& state, bool first) {
  for (int k = 0; k < n(); ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    const double rate = state.phidot[k];
    if (mode_[i] != JointMode::Moves && rate != 0) hold(k, JointMode::Moves);
    if (mode_[i] != JointMode::Moves || !(coulomb(k) > 0)) continue;
    slides_[i] = sign_of(rate);
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

bool ClosedLoop::has_event(double t, const StateVector& x) {
  const PlantState state = unpack(x, n());
  for (int k = 0; k < n(); ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    if (mode_[i] != JointMode::Moves) continue;
    const Joint& joint = robot_.joints[i];
    const double rate = state.phidot[k];
    if (options_.joint_stops && state.phi[k] < joint.lower && rate < -kNoRate) return true;
    if (options_.joint_stops && state.phi[k] > joint.upper && rate > kNoRate) return true;
    if (slides_[i] * rate < 0) return true;
  }
  if (!any_held() && encounter_ == nullptr) return false;
  const PlantTerms& terms = terms_at(x, state);
  if (any_held()) {
    const Load forces = load(t, x, state, terms);
    const PlantAcceleration motion = compute_acceleration(terms, forces.F_b, forces.tau, held_);
    const JointVectord needed = holding_torque(terms, motion, forces.tau);
    for (int k = 0; k < n(); ++k) {
      const JointMode mode = mode_[static_cast<std::size_t>(k)];
      const double most = coulomb(k);
      if (mode == JointMode::Sticks && std::abs(needed[k]) > most * (1 + kSlipSlack)) return true;
      // A stop pushes, and friction may help to stay.
      if (mode == JointMode::AtLower && needed[k] < -most * (1 + kSlipSlack)) return true;
      if (mode == JointMode::AtUpper && needed[k] > most * (1 + kSlipSlack)) return true;
    }
  }
  if (encounter_ == nullptr) return false;
  const HandLoad hand = hand_load(x, state, terms);
  switch (contact_.phase) {
    case ContactPhase::Apart:
      return hand.gap < 0;
    case ContactPhase::Touching:
      return hand.normal_force < 0 && hand.gap_rate > 0;
    case ContactPhase::Leaving:
      return hand.gap > 0;
  }
  return false;
}

bool ClosedLoop::handle_contact(double t, StateVector& x) {
  if (encounter_ == nullptr) return false;
  const PlantState state = unpack(x, n());
  const HandLoad hand = hand_load(x, state, terms_at(x, state));
  ContactPhase next = contact_.phase;
  if (contact_.phase == ContactPhase::Apart && hand.gap < 0) {
    next = ContactPhase::Touching;
    if (contact_.contacts++ == 0) contact_.first_begin = t;
  } else if (contact_.phase == ContactPhase::Touching && hand.normal_force < 0 &&
             hand.gap_rate > 0) {
    next = ContactPhase::Leaving;
    if (contact_.contacts == 1) {
      contact_.first_end = t;
      contact_.first_separation_speed = hand.gap_rate;
    }
  } else if (contact_.phase == ContactPhase::Leaving && hand.gap > 0) {
    next = ContactPhase::Apart;
  }
  const bool changes = next != contact_.phase;
  contact_.phase = next;
  return changes;
}

/// Releases the held joint that needs most beyond what holds it.
bool ClosedLoop::release_one(double t, StateVector& x) {
  if (!any_held()) return false;
  const PlantState state = unpack(x, n());
  const PlantTerms& terms = terms_at(x, state);
  const Load forces = load(t, x, state, terms);
  const PlantAcceleration motion = compute_acceleration(terms, forces.F_b, forces.tau, held_);
  const JointVectord needed = holding_torque(terms, motion, forces.tau);
  int worst = -1;
  double most_beyond = 0;
  for (int k = 0; k < n(); ++k) {
    const JointMode mode = mode_[static_cast<std::size_t>(k)];
    const double allowed = coulomb(k) * (1 + kSlipSlack);
    double beyond = -1;
    if (mode == JointMode::Sticks) beyond = std::abs(needed[k]) - allowed;
    if (mode == JointMode::AtLower) beyond = -needed[k] - allowed;
    if (mode == JointMode::AtUpper) beyond = needed[k] - allowed;
    if (beyond > most_beyond) {
      worst = k;
      most_beyond = beyond;
    }
  }
  if (worst < 0) return false;
  hold(worst, JointMode::Moves);
  // It goes where the missing torque lets it go.
  if (coulomb(worst) > 0) {
    slides_[static_cast<std::size_t>(worst)] = static_cast<signed char>(-sign_of(needed[worst]));
  }
  return true;
}

bool ClosedLoop::handle_one_event(double t, StateVector& x, StepObserver& observer) {
  PlantState state = unpack(x, n());
  const auto keep = [&] {
    const bool has_target = encounter_ != nullptr;
    x = has_target ? pack(state, unpack_target(x, n())) : pack(state);
  };
  for (int k = 0; k < n(); ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    const Joint& joint = robot_.joints[i];
    const double rate = state.phidot[k];
    const bool below = state.phi[k] < joint.lower && rate < -kNoRate;
    const bool above = state.phi[k] > joint.upper && rate > kNoRate;
    if (options_.joint_stops && mode_[i] == JointMode::Moves && (below || above)) {
      observer.stop_met(t, k, below ? LimitKind::LowerStop : LimitKind::UpperStop, rate);
      const double rebound = -options_.stop_restitution * rate;
      const bool rests = std::abs(rebound) < kRestRate;
      // A hit moves the other joints, at rest or not; mere settling must not wake them, or joints
      // at their stops would push each other without end.
      const bool settles = std::abs(rate) < kRestRate;
      impose_joint_rate(terms_at(x, state), k, rests ? 0 : rebound,
                        settles ? held_ : std::vector<bool>(), state);
      if (rests) hold(k, below ? JointMode::AtLower : JointMode::AtUpper);
      classify(state, false);
      keep();
      return true;
    }
    if (mode_[i] == JointMode::Moves && slides_[i] * rate < 0) {
      impose_joint_rate(terms_at(x, state), k, 0, held_, state);
      hold(k, JointMode::Sticks);
      classify(state, false);
      keep();
      return true;
    }
  }
  return handle_contact(t, x) || release_one(t, x);
}

bool ClosedLoop::handle_events(double t, StateVector& x, StepObserver& observer) {
  if (!has_started_) {
    has_started_ = true;
    classify(unpack(x, n()), true);
  }
  const int most = 50 * (n() + 2);
  for (int i = 0; i < most; ++i) {
    if (!handle_one_event(t, x, observer)) return true;
  }
  return false;
}

}  // namespace stillbase
