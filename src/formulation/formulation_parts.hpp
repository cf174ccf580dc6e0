// The inside of a Formulation: its rows, and what they are worth at a point.
//
// What depends on the variables is written once for any number type S (formulation_kernel.hpp,
// rows_kernel.hpp): on double it gives values and gradients, on Tangent the derivatives of the
// gradients.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/impact/batch.hpp>

#include "formulation/constraints/clearance_kernel.hpp"
#include "formulation/constraints/singular_kernel.hpp"
#include "formulation/objectives/turn_after_impact.hpp"
#include "formulation/variables/layout.hpp"

namespace stillbase {

template <class S>
using VectorX = Eigen::Matrix<S, Eigen::Dynamic, 1>;

enum class RowKind {
  HandPosition,    // component of the hand's distance from its point
  StationBox,      // component of the base position that puts the hand on its point
  HandAxis,        // component of the approach axis normal to n
  HandFacing,      // approach axis along n: negative when the hand faces the target
  HandPose,        // component of the rotation error 1/2 sum r_i x d_i
  PoseFacing,      // sum r_i . d_i: excludes the opposite orientation
  CaseTotal,       // component of the total angular momentum per unit impulse
  CaseBase,        // of the base part
  CaseCoupling,    // of the coupling part
  CouplingColumn,  // coupling part along a column of the coupling matrix (rank < 3)
  ClosingSpeed,
  AttitudeAngle,   // squared angle from the stated attitude
  AttitudeCone,    // cosine of the angle of the base's axis from its direction
  JointRate,       // of joint `index` right after the predicted impact
  CouplingMargin,  // least singular value of the coupling matrix, of its generic rank
  JacobianMargin,  // of the generalized Jacobian
  Clearance        // signed distance of pair `index`
};

struct Row {
  RowKind kind;
  int index;
  std::string name;
  double lower, upper;
};

/// Gradient of a scalar over joints, turn of the base (rad, in B) and contact time.
template <class S>
struct ScalarGradient {
  JointVector<S> phi;
  Vector3<S> theta = Vector3<S>::Zero();
  S t = S(0);
  explicit ScalarGradient(int n) : phi(JointVector<S>::Zero(n)) {}
};

/// The variables: all joints, three of the attitude, the contact time.
template <class S>
using LocalVector = Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints + 4, 1>;

/// Everything at one x that is not the impact.
template <class S>
struct Local {
  LocalVector<S> x;
  JointVector<S> phi;
  S time;
  Matrix3<S> R_NB;
  Matrix3<S> attitude_rates;     ///< turn of B (in B) per attitude variable, one per column
  ContactKinematics<S> contact;  ///< nominal
  ContactRates<S> rates;         ///< of it
};

/// The impact of one scenario at one posture.
template <class S>
struct ScenarioImpact {
  Encounter<S> encounter;
  ContactRates<S> rates;
  S closing_speed_rate = S(0);  ///< per s of contact time, m/s^2
  ImpactResponse<S> response;   ///< to a unit impulse
  S p = S(0);                   ///< impulse, N s
};

struct Formulation::Parts {
  CaptureProblem problem;
  VariableLayout layout;
  ImpactResistance resistance;
  EncounterModel model;
  std::vector<Row> rows;
  std::vector<Row> implied_rows;  ///< hold where the others do: reported, not given to optimizers
  std::vector<ClearancePair> clearances;
  TargetPlacement target;  ///< at the contact, where a clearance to it is asked for
  int coupling_rank = 0;   ///< generic ranks, of what a margin is asked for
  int jacobian_rank = 0;
  double objective_unit = 1;
  bool rows_need_hit = false;          ///< some row is a function of the predicted impact
  std::vector<Scenario> prediction;    ///< the predicted one alone
  mutable ScenarioEvaluation at_last;  ///< workspace
  mutable long evaluations = 0;

  std::vector<TurnAfterImpact> turns;  ///< of the objective
  StopCondition simulations_stop;
  std::vector<UserTerm> user_terms;

  explicit Parts(const CaptureProblem& p);

  int n() const { return problem.robot.n(); }
  int start_dimension() const { return layout.size; }
  Eigen::VectorXd start_point(const Eigen::VectorXd& u) const;
  Configuration configuration(const Eigen::VectorXd& x) const;
  Scenario predicted() const { return nominal_scenario(model); }

  // Which rows there are (formulation_rows.cpp).
  void add_rows();
  void add_case_rows();
  void add_margin_rows();
  void add_clearance_rows();
  void drop_structural_rows();
  void set_combinations_aside();

  // What they are worth (formulation_kernel.hpp, rows_kernel.hpp).
  template <class S>
  Local<S> localise(const VectorX<S>& x) const;
  template <class S>
  PostureImpact<S> posture(const Local<S>& local) const;
  /// The same with the joints displaced by the scenario's errors.
  template <class S>
  PostureImpact<S> posture(const Local<S>& local, const Scenario& scenario) const;
  /// What of the impact does not depend on the posture; response and p are not set.
  template <class S>
  ScenarioImpact<S> encounter(const Local<S>& local, const Scenario& scenario) const;
  template <class S>
  ScenarioImpact<S> impact(const Local<S>& local, const PostureImpact<S>& posture,
                           const Scenario& scenario) const;
  /// 1/2 |y|^2 / unit^2 of a scenario, and its gradient.
  template <class S>
  S objective(const PostureImpact<S>& posture, const ScenarioImpact<S>& hit) const;
  template <class S>
  ScalarGradient<S> objective_gradient(const PostureImpact<S>& posture,
                                       const ScenarioImpact<S>& hit) const;
  template <class S>
  S value_of(const Row& row, const Local<S>& local, const PostureImpact<S>& posture,
             const ScenarioImpact<S>& hit) const;
  template <class S>
  ScalarGradient<S> gradient_of(const Row& row, const Local<S>& local,
                                const PostureImpact<S>& posture,
                                const ScenarioImpact<S>& hit) const;
  /// Both, without working out twice what they share.
  template <class S>
  S value_and_gradient(const Row& row, const Local<S>& local, const PostureImpact<S>& posture,
                       const ScenarioImpact<S>& hit, ScalarGradient<S>& gradient) const;
  template <class S>
  VectorX<S> compress(const Local<S>& local, const ScalarGradient<S>& gradient) const;
  /// The same into a row of a matrix.
  void compress_into(const Local<double>& local, const ScalarGradient<double>& gradient,
                     Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> out) const;
  /// sum w_k grad f_k over scenarios + sum multipliers_i grad g_i.
  template <class S>
  VectorX<S> lagrangian_gradient(const VectorX<S>& x, const std::vector<Scenario>& scenarios,
                                 const Eigen::VectorXd& weights,
                                 const Eigen::VectorXd& multipliers) const;

  /// @param predicted the nominal impact, where it is known already
  void evaluate_one_by_one(const Local<double>& local, const PostureImpact<double>& stated,
                           const ScenarioImpact<double>* predicted,
                           const std::vector<Scenario>& scenarios, bool derivatives,
                           ScenarioEvaluation& out) const;

  // Scenarios in the lanes of wide registers (formulation_batch.cpp).
  /// Fewer scenarios at one posture than this are evaluated one by one.
  static constexpr int kWorthPacks = 3;
  bool in_packs(const std::vector<Scenario>& scenarios) const;
  void resize_batch(Eigen::Index count) const;
  void put_in_batch(const Local<double>& local, const ScenarioImpact<double>& hit,
                    const Scenario& scenario, Eigen::Index row) const;
  void evaluate_batch(bool derivatives) const;
  void evaluate_in_packs(const Local<double>& local, const std::vector<Scenario>& scenarios,
                         bool derivatives, ScenarioEvaluation& out) const;
  mutable ImpactBatch batch;
  mutable BatchObjectiveValues batch_values;

  /// What is simulated of a scenario's y / unit, all terms below each other, and its Jacobian
  /// (turns.cpp).
  Eigen::VectorXd turn_vector(const Eigen::VectorXd& x, const Scenario& scenario) const;
  Eigen::MatrixXd turn_jacobian(const Eigen::VectorXd& x, const Scenario& scenario) const;
  /// What the user's terms add to a scenario's 1/2 |y|^2 / unit^2 (user_terms.cpp).
  double user_objective(const Eigen::VectorXd& x, const Scenario& scenario) const;
  Eigen::VectorXd user_gradient(const Eigen::VectorXd& x, const Scenario& scenario) const;

  // Pieces of the above.
  /// d psi of psi(p y): the weights of y per unit impulse, and of p through the contact law.
  template <class S>
  ScalarGradient<S> scaled_gradient(const PostureImpact<S>& posture, const ScenarioImpact<S>& hit,
                                    ResponseWeights<S> weights, const S& along_p) const;
  /// d value / d(turn of B seen from the contact frame) goes to the base attitude, or to time.
  template <class S>
  void add_contact_turn(const ContactRates<S>& rates, const Vector3<S>& g,
                        ScalarGradient<S>& gradient) const;
  /// d value / dF acts through the turn of B, in which F is fixed to the contact frame.
  template <class S>
  void add_wrench_turn(const ScenarioImpact<S>& hit, const Vector6<S>& by_F,
                       ScalarGradient<S>& gradient) const;
  /// along_p = p d value / dp acts through the closing speed's change in time.
  template <class S>
  void add_speed_rate(const ScenarioImpact<S>& hit, const S& along_p,
                      ScalarGradient<S>& gradient) const;
  template <class S>
  ScalarGradient<S> impact_gradient(const PostureImpact<S>& posture, const ScenarioImpact<S>& hit,
                                    const ResponseWeights<S>& weights) const;
  /// The coupling matrix, or the generalized Jacobian with its angular rows times a length; and its
  /// smallest singular value of generic rank.
  template <class S>
  SingularTriple<S> margin(RowKind kind, const PostureImpact<S>& posture) const;
  template <class S>
  ScalarGradient<S> margin_gradient(RowKind kind, const PostureImpact<S>& posture,
                                    const SingularTriple<S>& triple) const;
  /// A shape in B; the target lies with its contact at the hand.
  template <class S>
  PlacedShape<S> placed(const ClearanceShape& shape, const Local<S>& local,
                        const PostureImpact<S>& posture) const;
  template <class S>
  Separation<S> separation(const ClearancePair& pair, const Local<S>& local,
                           const PostureImpact<S>& posture) const;
  template <class S>
  ScalarGradient<S> separation_gradient(const ClearancePair& pair, const Local<S>& local,
                                        const PostureImpact<S>& posture,
                                        const Separation<S>& at) const;
};

/// The vector behind a term of the objective, divided by the term's size, per unit of impulse.
template <class S>
JointVector<S> term_quantity(const ObjectiveTerm& term, const PostureImpact<S>& posture,
                             const ImpactResponse<S>& response);
/// Adds u . d(that vector) to the weights.
template <class S>
void add_term_weights(const ObjectiveTerm& term, const JointVector<S>& u,
                      ResponseWeights<S>& weights);

}  // namespace stillbase
