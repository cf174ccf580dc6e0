// The inside of a Formulation: its rows, and what they are worth at a point.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/capture/formulation.hpp>
#include <stillbase/target/target.hpp>

#include "capture/layout.hpp"

namespace stillbase {

/// Frame in which the impulse direction never changes: rows are written in its components, so that
/// "normal to n" means the same two axes at every point of the search.
enum class ContactFrame { Base, Inertial, Target };

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
  AttitudeAngle  // squared angle from the stated attitude
};

struct Row {
  RowKind kind;
  int index;
  std::string name;
  double lower, upper;
};

/// Gradient of a scalar over joints, turn of the base (rad, in B) and contact time.
struct ScalarGradient {
  JointVectord phi;
  Vector3d theta = Vector3d::Zero();
  double t = 0;
  explicit ScalarGradient(int n) : phi(JointVectord::Zero(n)) {}
};

/// The vector y whose size an objective measures, per unit of impulse.
Vector3d objective_quantity(ObjectiveQuantity quantity, const ImpactResponse<double>& response);

/// Two unit vectors that complete n to a right-handed basis.
std::pair<Vector3d, Vector3d> tangent_basis(const Vector3d& n);

/// Everything at one x that is not the impact.
struct Local {
  Eigen::VectorXd x;
  Configuration configuration;
  Matrix3d R_NB;
  Matrix3d R_EB;                         ///< E: the contact frame
  Vector3d omega_EB = Vector3d::Zero();  ///< turn of B seen from E per second of contact time, in B
  Encounter encounter;
  double closing_speed_rate = 0;        ///< d v_n / dt
  std::optional<ContactState> contact;  ///< with a predicted target
};

struct Formulation::Parts {
  CaptureProblem problem;
  VariableLayout layout;
  ImpactResistance resistance;
  std::optional<TargetMotion> motion;  ///< of the predicted target
  ContactFrame frame = ContactFrame::Base;
  Vector3d n_E, u_E, v_E;  ///< impulse direction and tangents in the contact frame
  Vector6d F_E;            ///< wrench per unit of impulse
  std::vector<Row> rows;
  std::optional<Vector3d> hand_point;  ///< stated hand position
  double objective_unit = 1;
  mutable long evaluations = 0;

  explicit Parts(const CaptureProblem& p);

  bool hand_follows_contact() const { return motion.has_value() && !hand_point; }
  int n() const { return problem.robot.n(); }

  void add_rows();
  void add_case_rows();
  void drop_structural_rows();
  Local localise(const Eigen::VectorXd& x) const;
  int start_dimension() const { return layout.size; }
  Eigen::VectorXd start_point(const Eigen::VectorXd& u) const;
  double value_of(const Row& row, const Local& local, const PostureImpact<double>& posture,
                  const ImpactResponse<double>& response) const;
  ScalarGradient gradient_of(const Row& row, const Local& local,
                             const PostureImpact<double>& posture,
                             const ImpactResponse<double>& response) const;

  Vector3d quantity(const ImpactResponse<double>& response) const {
    return objective_quantity(problem.objective, response);
  }
  ResponseWeights<double> quantity_weights(const Vector3d& u) const;
  /// d value / d(turn of B seen from the contact frame) goes to the base attitude, or to time.
  void add_contact_turn(const Local& local, const Vector3d& g, ScalarGradient& gradient) const;
  ScalarGradient impact_gradient(const Local& local, const PostureImpact<double>& posture,
                                 const ImpactResponse<double>& response,
                                 const ResponseWeights<double>& weights) const;
  /// Wanted hand axes in B for HandConstraint::Pose.
  Matrix3d wanted_hand_axes(const Local& local) const;
  Eigen::VectorXd compress(const Eigen::VectorXd& x, const ScalarGradient& gradient) const;
  double magnitude(const Local& local, const ImpactResponse<double>& response) const {
    return impulse_magnitude(problem, local.encounter, response.hand_inverse_mass);
  }
};

}  // namespace stillbase
