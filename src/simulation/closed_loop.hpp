// Plant and controller as one ordinary differential equation with events.
#pragma once

#include <array>
#include <deque>
#include <optional>

#include <stillbase/core/random.hpp>
#include <stillbase/simulation/contact.hpp>

#include "simulation/recorder.hpp"
#include "simulation/ticks.hpp"

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

/// Measurement of the state: some control periods old, with errors.
class Sensing {
 public:
  /// @param control_period s, > 0 unless the sensors are exact
  Sensing(const SensorSpec& sensors, double control_period);
  bool is_exact() const { return is_exact_; }
  /// The measurement of a control instant. Before the first delayed one arrives it is the first.
  PlantState measure(const PlantState& state);

 private:
  SensorSpec sensors_;
  bool is_exact_;
  std::size_t delay_;  ///< control periods
  Random random_;
  std::deque<PlantState> delayed_;
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

  /// Goes on for a loop that has done without events so far, from within a control period.
  void go_on_from(const Sensing& sensing, const ControlCommand& command,
                  const JointVectord& demanded, bool saturated);

  int n() const { return robot_.n(); }
  /// A control instant: measures and commands, and holds the command until the next one. Nothing to
  /// do under continuous control.
  void sample(double t, const StateVector& x);
  /// @param recorder may be null
  void derivative(double t, const StateVector& x, StateVector& dxdt, Recorder* recorder);

  /// True when the equations change at x: a joint beyond its stop, at rest or pulled off it, or the
  /// begin or end of the contact.
  bool has_event(double t, const StateVector& x);
  /// Makes the changes: impulses of stops, modes of joints, contact.
  /// @return false when there are too many at one instant
  bool handle_events(double t, StateVector& x, Recorder& recorder);

  const ContactHistory& contact() const { return contact_; }
  /// Whether the run has to end with the first contact, and this is over, or with the first stop.
  bool is_over() const {
    if (options_.ends_at_stop && has_stopped_) return true;
    return encounter_ != nullptr && encounter_->end_with_contact && contact_.contacts > 0 &&
           contact_.phase != ContactPhase::Touching;
  }

 private:
  struct Load {
    Vector6d F_b;
    JointVectord tau;
  };
  /// What happens to a moving joint at a state.
  enum class JointEvent { None, LowerStop, UpperStop, Sticks };
  /// The held joint whose holding torque exceeds its limit most; joint -1: none.
  struct Overload {
    int joint = -1;
    double torque = 0;  ///< that would hold it, N m (N)
  };
  bool knows_terms_at(const StateVector& x) const;
  const PlantTerms& terms_at(const StateVector& x, const PlantState& state);
  /// Of the terms where they are known, else without them.
  PlantAcceleration acceleration(const StateVector& x, const PlantState& state, const Load& load);
  void command(const PlantState& state, const PlantTerms& terms, double elapsed);
  void limit(const JointVectord& phidot);
  Load load(double t, const StateVector& x, const PlantState& state);
  HandLoad hand_load(const StateVector& x, const PlantState& state, const PlantTerms& terms) const;
  JointEvent event_of(int k, const PlantState& state) const;
  Overload overload(double t, const StateVector& x, const PlantState& state);
  ContactPhase next_phase(const HandLoad& hand) const;
  bool handle_one_event(double t, StateVector& x, Recorder& recorder);
  bool handle_contact(double t, const StateVector& x);
  bool release_one(double t, const StateVector& x);
  void classify(const PlantState& state, bool first);
  void hold(int k, JointMode mode);
  double coulomb(int k) const;

  const RobotModel& robot_;
  const JointVectord& rotor_inertia_;
  const Controller& controller_;
  const SimulationOptions& options_;
  const EncounterPlant* encounter_;
  Sensing sensing_;
  ControlCommand command_;  ///< after limits, held between control instants
  JointVectord demanded_;   ///< n; torques of the command before limits
  bool saturated_ = false;
  bool has_started_ = false;
  bool has_stopped_ = false;  ///< a joint has reached its stop
  std::array<JointMode, kMaxJoints> mode_{};
  std::array<signed char, kMaxJoints> slides_{};  ///< sign of the rate that friction works against
  std::vector<bool> held_;                        ///< n, or empty when no joint is held
  ContactHistory contact_;
  std::optional<PlantTerms> terms_;  ///< of terms_x_; computed once per state
  StateVector terms_x_;
};

/// Refuses what cannot be run, with all findings at once.
/// @throws InputError
void check_simulation(const RobotModel& robot, const JointResistance& resistance,
                      const PlantState& initial, const Controller& controller,
                      const SimulationOptions& options);

/// What a run has beside its state.
struct Course {
  Recorder recorder;
  Ticks control, output;  ///< instants that are still to come
  long steps = 0;         ///< of the integrator
  /// Within the stretch between two instants, at whose end alone it is asked whether the run is
  /// over.
  bool is_within_stretch = false;

  Course(const RobotModel& robot, const Controller& controller, const SimulationOptions& options)
      : recorder(robot, controller, options),
        control(options.start_time, options.control_period),
        output(options.start_time, options.output_period) {}
};

/// From x at t to the end of the horizon; x and t end where the run ended.
SimulationResult run_on(ClosedLoop& loop, StateVector& x, double& t, Course& course,
                        const SimulationOptions& options);
/// The same from options.start_time on.
SimulationResult run_loop(ClosedLoop& loop, StateVector& x, double& t, const RobotModel& robot,
                          const Controller& controller, const SimulationOptions& options);

}  // namespace stillbase
