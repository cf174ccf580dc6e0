// Plant and controller as one ordinary differential equation with events.
#pragma once

#include <array>
#include <optional>

#include <stillbase/simulation/contact.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/sensing.hpp"

namespace stillbase {

/// [position (3), quaternion xyzw (4), phi (n), Omega (6), phidot (n), wheel momentum (3),
/// thruster impulse (3)], and with a target [position (3), quaternion xyzw (4), velocity in N (3),
/// rate in T (3)].
inline constexpr int kTargetSize = 13;
using StateVector =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 19 + 2 * kMaxJoints + kTargetSize, 1>;

StateVector pack(const PlantState& state);
StateVector pack(const PlantState& state, const TargetPlantState& target);
/// Quaternions come out with unit length.
/// @param n joints
PlantState unpack(const StateVector& x, int n);
TargetPlantState unpack_target(const StateVector& x, int n);
/// Brings the quaternions of a state vector to unit length.
void normalise_attitude(StateVector& x, int n);
/// Finite, and not so large that products of its elements would leave the range of numbers.
bool is_bounded(const StateVector& x);

/// Observes every step: state, terms of (3) and command (after limits) at its beginning.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void observe(double t, const PlantState& state, const PlantTerms& terms,
                       const ControlCommand& command, bool saturated) = 0;
  /// Before observe(), in runs with a target.
  virtual void observe_target(const TargetPlantState& target, const Vector3d& contact_force) = 0;
  /// A joint runs into an enforced stop with this rate.
  virtual void stop_met(double t, int joint, LimitKind kind, double rate) = 0;
};

/// State of a joint between two events.
enum class JointMode : unsigned char {
  Moves,
  Sticks,   ///< held by Coulomb friction
  AtLower,  ///< rests at its stop
  AtUpper
};

class ClosedLoop {
 public:
  /// The references must outlive the loop.
  /// @param encounter null: no target
  ClosedLoop(const RobotModel& robot, const JointVectord& rotor_inertia,
             const Controller& controller, const SimulationOptions& options,
             const EncounterPlant* encounter = nullptr);

  int n() const { return robot_.n(); }
  /// A control instant: measures and commands, and holds the command until the next one. Nothing to
  /// do under continuous control.
  void sample(double t, const StateVector& x);
  /// @param observer may be null
  void derivative(double t, const StateVector& x, StateVector& dxdt, StepObserver* observer);

  /// True when the equations change at x: a joint beyond its stop, at rest or pulled off it, or the
  /// begin or end of the contact.
  bool has_event(double t, const StateVector& x);
  /// Makes the changes: impulses of stops, modes of joints, contact.
  /// @return false when there are too many at one instant
  bool handle_events(double t, StateVector& x, StepObserver& observer);

  const ContactHistory& contact() const { return contact_; }
  /// Whether the run has to end with the first contact, and this is over.
  bool is_over() const {
    return encounter_ != nullptr && encounter_->end_with_contact && contact_.contacts > 0 &&
           contact_.phase != ContactPhase::Touching;
  }

 private:
  struct Load {
    Vector6d F_b;
    JointVectord tau;
  };
  const PlantTerms& terms_at(const StateVector& x, const PlantState& state);
  void command(const PlantState& state, const PlantTerms& terms, double elapsed);
  void limit(const JointVectord& phidot);
  Load load(double t, const StateVector& x, const PlantState& state, const PlantTerms& terms);
  HandLoad hand_load(const StateVector& x, const PlantState& state, const PlantTerms& terms) const;
  bool handle_one_event(double t, StateVector& x, StepObserver& observer);
  bool handle_contact(double t, StateVector& x);
  bool release_one(double t, StateVector& x);
  void classify(const PlantState& state, bool first);
  void hold(int k, JointMode mode);
  bool any_held() const { return !held_.empty(); }
  double coulomb(int k) const;

  const RobotModel& robot_;
  const JointVectord& rotor_inertia_;
  const Controller& controller_;
  const SimulationOptions& options_;
  const EncounterPlant* encounter_;
  Sensing sensing_;
  ControlCommand command_;  ///< after limits, held between control instants
  bool saturated_ = false;
  bool has_started_ = false;
  std::array<JointMode, kMaxJoints> mode_{};
  std::array<signed char, kMaxJoints> slides_{};  ///< sign of the rate that friction works against
  std::vector<bool> held_;                        ///< n, or empty when no joint is held
  ContactHistory contact_;
  std::optional<PlantTerms> terms_;  ///< of terms_x_; computed once per state
  StateVector terms_x_;
};

}  // namespace stillbase
