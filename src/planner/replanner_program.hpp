// A capture problem at points of the search, evaluated without allocation: rows, measure,
// gradients.
#pragma once

#include <array>
#include <vector>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/planner/replanner.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/cone_search.hpp"

namespace stillbase {

/// The measure near a point is the largest of so many smooth functions: maxima over the cone.
inline constexpr int kMostPieces = 6;

/// A point of the search and what is known of it. Values are those of the objective divided by its
/// typical size, 1/2 |y|^2, as Formulation has them.
struct ReplanPoint {
  Eigen::VectorXd x;
  Eigen::VectorXd rows;              ///< (m)
  Eigen::MatrixXd jacobian;          ///< m x N
  double max_violation = kInfinity;  ///< of the rows and the bounds

  double measure = kInfinity;
  double nominal = 0;
  int pieces = 0;
  Eigen::VectorXd piece_values;                        ///< the largest is the measure
  Eigen::MatrixXd piece_gradients;                     ///< one row each
  std::array<Vector3d, kMostPieces> piece_directions;  ///< in E
  double worst_case = 0;                               ///< over the cone
  Vector3d worst_direction = Vector3d::Zero();         ///< in B
};

class ReplanProgram {
 public:
  /// @throws InputError as Replanner
  ReplanProgram(const CaptureProblem& problem, double most_rotation);

  const Formulation& formulation() const { return formulation_; }
  const CaptureProblem& problem() const { return parts().model.problem; }
  int num_variables() const { return formulation_.num_variables(); }
  int num_rows() const { return formulation_.num_constraints(); }
  bool is_worst_case() const { return problem().measure.kind == RiskMeasure::WorstCase; }

  /// Keeps the joints within a distance (rad, m) of these, inside their limits.
  void stay_within(double distance, const JointVectord& phi);
  /// Bound of the contact feature's rotation between estimate and contact, rad.
  double rotation_of(const TargetState& estimate) const;
  /// @param earliest no contact before it, s; at most the window's end
  void set_estimate(const TargetState& estimate, double earliest);
  void set_cone_half_angle(double half_angle) { formulation_.set_cone_half_angle(half_angle); }
  double cone_half_angle() const { return problem().uncertainty.cone_half_angle; }

  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  const Eigen::VectorXd& row_lower() const { return row_lower_; }
  const Eigen::VectorXd& row_upper() const { return row_upper_; }

  ReplanPoint empty_point() const;
  void move_into_box(Eigen::VectorXd& x) const { x = x.cwiseMax(lower_).cwiseMin(upper_); }
  /// rows, jacobian, max_violation
  void evaluate_rows(ReplanPoint& point) const;
  /// All other members.
  void evaluate_measure(ReplanPoint& point);
  /// In the objective's unit.
  double reported(double measure) const;

 private:
  const Formulation::Parts& parts() const { return formulation_.parts(); }
  void evaluate_cone(const NominalPoint& here, ReplanPoint& point);
  void evaluate_mean(const NominalPoint& here, ReplanPoint& point) const;
  double half_square(double length) const;

  Formulation formulation_;
  Eigen::VectorXd lower_, upper_, row_lower_, row_upper_;
  std::vector<Scenario> samples_;  ///< of an expectation
  Scenario piece_;
  DirectionModel directions_;
  ConeSearch cone_;
};

}  // namespace stillbase
