// What all objectives and constraints of a problem share: robot and target placed at a point of the
// search, the impact of a scenario there, and how gradients reach the variables.
//
// Everything is a function of the point alone. The lines are in capture_model_kernel.hpp, for any
// number type S: double gives values and gradients, Tangent the derivatives of gradients.
#pragma once

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/residual_velocity.hpp>
#include <stillbase/impact/gradient.hpp>

#include "formulation/variables/layout.hpp"
#include "target/motion_table.hpp"

namespace stillbase {

template <class S>
using VectorX = Eigen::Matrix<S, Eigen::Dynamic, 1>;

/// The variables: all joints, three of the attitude, the contact time.
template <class S>
using VariableVector = Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints + 4, 1>;

/// Gradient of a scalar over joints, rotation of the base (rad, in B) and contact time.
template <class S>
struct ScalarGradient {
  JointVector<S> phi;
  Vector3<S> theta = Vector3<S>::Zero();
  S t = S(0);
  explicit ScalarGradient(int n) : phi(JointVector<S>::Zero(n)) {}
};

/// Base, joints and target at one x.
template <class S>
struct Placement {
  VariableVector<S> x;
  JointVector<S> phi;
  S time;
  Matrix3<S> R_NB;
  Matrix3<S> attitude_rates;     ///< rotation of B (in B) per attitude variable, one per column
  ContactKinematics<S> contact;  ///< nominal
  ContactRates<S> rates;         ///< of it
};

/// The impact of one scenario at one posture.
template <class S>
struct ScenarioImpact {
  // Not defaulted: `{}` would fill kilobytes with zeros.
  ScenarioImpact() {}  // NOLINT(modernize-use-equals-default)

  Encounter<S> encounter;
  ContactRates<S> rates;
  S closing_speed_rate = S(0);        ///< per s of contact time, m/s^2
  RigidContact<S> rigid;              ///< of a sticking contact or a latch
  TargetAtHandRates<S> target_rates;  ///< of its target
  /// Of rigid.apart per s of contact time, the base attitude relative to E fixed; in B.
  Vector6<S> apart_rate = Vector6<S>::Zero();
  ImpactResponse<S> response;  ///< to a unit impulse; of a rigid contact to the whole impulse
  S p = S(0);                  ///< impulse, N s; of a rigid contact 1
};

struct CaptureModel {
  CaptureProblem problem;
  VariableLayout layout;
  ImpactResistance resistance;
  EncounterModel encounter;
  std::optional<ResidualRoot> residual;  ///< where the problem states a residual velocity
  Scenario nominal;
  /// The target's motion from the estimate that took the place of the problem's
  /// (set_target_state); empty: `encounter.motion`.
  std::optional<MotionTable> latest_motion;

  /// @throws InputError as encounter_model(), when nothing is free, or when the residual velocity
  ///   cannot be predicted
  /// @param known encounter_model() of the problem
  CaptureModel(const CaptureProblem& p, const EncounterModel& known);

  int n() const { return problem.robot.n(); }
  Configuration configuration(const Eigen::VectorXd& x) const;
  /// The same but for the name of the feature, which stays.
  void write_configuration(const Eigen::VectorXd& x, Configuration& out) const;

  /// Longest time between an estimate and what is asked of its motion, s.
  double horizon_from(double estimate_time) const;
  /// Room for estimates with so much rotation (rad) within horizon_from(). @pre follows_target()
  void reserve_motion(double rotation);
  /// @pre reserve_motion()
  void set_target_state(const TargetState& estimate);

  /// The target at a time, with its derivatives over it. @pre encounter.follows_target()
  template <class S>
  TargetKinematics<S> target_at(const S& time) const;

  template <class S>
  Placement<S> place(const VectorX<S>& x) const;
  template <class S>
  PostureImpact<S> posture(const Placement<S>& at) const;
  /// Its kinematics and Jacobian alone.
  PostureImpact<double> hand(const Placement<double>& at) const;
  /// The same with the joints displaced by the scenario's errors.
  template <class S>
  PostureImpact<S> posture(const Placement<S>& at, const Scenario& scenario) const;
  /// What of the impact does not depend on the posture; response and p are not set.
  template <class S>
  ScenarioImpact<S> encounter_of(const Placement<S>& at, const Scenario& scenario) const;
  /// The relative velocity of the scenario is off by L s: the target's takes it, whatever the
  /// nominal one is. A hand that moves does so as the nominal target asks.
  template <class S>
  void add_velocity_error(const Scenario& scenario, const S& time, ScenarioImpact<S>& impact) const;
  template <class S>
  ScenarioImpact<S> impact(const Placement<S>& at, const PostureImpact<S>& posture,
                           const Scenario& scenario) const;

  /// Gradient of a function of the response: to a unit impulse, of a rigid contact to the impulse.
  template <class S>
  ScalarGradient<S> impact_gradient(const PostureImpact<S>& posture,
                                    const ScenarioImpact<S>& impact,
                                    const ResponseWeights<S>& weights) const;
  /// Gradient of a function of the motion before the contact. @pre the hand moves
  template <class S>
  ScalarGradient<S> motion_before_gradient(const PostureImpact<S>& posture,
                                           const ScenarioImpact<S>& impact,
                                           const HandMotionWeights<S>& weights) const;
  /// Gradient of psi(p y): the weights of y per unit impulse, along_p = p d psi / dp acts through
  /// the contact law.
  template <class S>
  ScalarGradient<S> scaled_gradient(const PostureImpact<S>& posture,
                                    const ScenarioImpact<S>& impact, ResponseWeights<S> weights,
                                    const S& along_p) const;
  /// d value / d(rotation of B relative to the contact frame): over base attitude and time.
  template <class S>
  void add_contact_turn(const ContactRates<S>& rates, const Vector3<S>& g,
                        ScalarGradient<S>& gradient) const;
  /// d value / dF acts through the rotation of B, in which F is fixed to the contact frame.
  template <class S>
  void add_wrench_turn(const ScenarioImpact<S>& impact, const Vector6<S>& by_F,
                       ScalarGradient<S>& gradient) const;
  /// d value / d(the target right before a rigid contact), as ContactGradient.
  template <class S>
  void add_target_change(const ScenarioImpact<S>& impact, const Vector3<S>& turn,
                         const Vector3<S>& velocity, const Vector3<S>& omega,
                         ScalarGradient<S>& gradient) const;
  /// The same with what the hand's velocity is decided by, and over the joints.
  template <class S>
  ScalarGradient<S> contact_change(const ScenarioImpact<S>& impact,
                                   const ContactGradient<S>& by_contact) const;
  /// along_p = p d value / dp acts through the closing speed's change in time.
  template <class S>
  void add_speed_rate(const ScenarioImpact<S>& impact, const S& along_p,
                      ScalarGradient<S>& gradient) const;

  /// A gradient over the variables, into a vector or a row of a matrix (N).
  template <class S, class Out>
  void compress_into(const Placement<S>& at, const ScalarGradient<S>& gradient, Out&& out) const {
    for (std::size_t i = 0; i < layout.joints.size(); ++i) {
      out[static_cast<int>(i)] = gradient.phi[layout.joints[i]];
    }
    for (int i = 0; i < layout.attitude_size; ++i) {
      out[layout.attitude + i] = at.attitude_rates.col(i).dot(gradient.theta);
    }
    if (layout.time >= 0) out[layout.time] = gradient.t;
  }
};

/// The nominal impact at a point of the search.
struct NominalPoint {
  Placement<double> at;
  PostureImpact<double> posture;
  ScenarioImpact<double> impact;

  NominalPoint(const CaptureModel& model, const Eigen::VectorXd& x)
      : at(model.place<double>(x)),
        posture(model.posture(at)),
        impact(model.impact(at, posture, model.nominal)) {}
};

}  // namespace stillbase
