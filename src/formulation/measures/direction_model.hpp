// |y| as a function of the impulse direction at one posture: y and W_h are linear and quadratic in
// it, so a direction costs a few small products.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <stillbase/formulation/formulation.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

struct DirectionModel {
  const CaptureProblem& problem;
  const EncounterModel& model;
  Encounter<double> encounter;
  Vector3d velocity;  ///< of the target's contact point in B, where it decides the closing speed
  /// y = p Y [d; 1]: all linear terms below each other, and what a stated moment adds.
  Eigen::Matrix<double, Eigen::Dynamic, 4> Y;
  Matrix3d W;  ///< d' W d: inverse mass of hand and target together
  /// A sticking contact or a latch knows no direction: |y|^2 of its terms is the same for all.
  std::optional<double> whole_square;
  Vector3d n, u, v;  ///< nominal direction and tangents
  double half_angle = 0;
  bool planar = false;
  const DifferencedTerms& differenced;  ///< functions of the direction that are known by values
  StopCondition stop;                   ///< of the simulations
  Configuration configuration;

  DirectionModel(const CaptureProblem& problem, const Formulation& formulation,
                 const Configuration& at);
  /// With other terms than the formulation's. @param jump, terms outlive the model
  DirectionModel(const CaptureProblem& problem, const Formulation& formulation,
                 const Configuration& at, const JumpObjective& jump, const DifferencedTerms& terms);

  /// Takes another place, without allocation. @pre is_linear()
  void move_to(const Encounter<double>& there, const PostureImpact<double>& posture);

  /// Direction at angle |c| from n towards (c_1, c_2).
  Vector3d direction(const Eigen::Vector2d& c) const;
  /// The inverse of direction(), inside the cone.
  Eigen::Vector2d coordinates(const Vector3d& d) const;
  /// The place itself, or the nearest on the cone's rim.
  Eigen::Vector2d project(Eigen::Vector2d c) const;
  /// Minus infinity, less than anything, where simulations were given up; never of the nominal
  /// direction.
  double value(const Eigen::Vector2d& c) const;
  /// The same along a direction. @pre is_linear()
  double value_along(const Vector3d& d) const { return std::sqrt(square(d)); }
  /// Whether no value was given up so far.
  bool is_complete() const { return !differenced.is_simulated() || !stop.reached(); }
  /// |y|^2 along directions, several at a time. @pre is_linear()
  /// @param directions one per row, in the basis (n, u, v); a multiple of
  ///   DirectionSquares::kMostLanes
  void squares(const Eigen::MatrixX3d& directions, std::vector<double>& squares) const;
  /// Whether |y| is known in closed form: nothing simulated, nothing of the user's.
  bool is_linear() const { return differenced.empty(); }
  /// Gradient and Hessian of ln |y|^2 over d, as if d were any vector. False where |y| is zero and
  /// where it is not linear.
  bool log_derivatives(const Vector3d& d, Vector3d& gradient, Matrix3d& hessian) const;

 private:
  double closing_speed(const Vector3d& d) const;
  double magnitude(const Vector3d& d) const;  ///< p, of the impulse
  double square(const Vector3d& d) const;
  double other_square(const Vector3d& d, const StopCondition& until) const;

  const JumpObjective& jump_;
};

}  // namespace stillbase
