// Objective and risk measure at one configuration, by `reference`.
#pragma once

#include <functional>

#include "verification/recomputation.hpp"
#include "verification/residual_velocity.hpp"

namespace stillbase::verification {

/// One term of an objective under one impulse.
struct TermCase {
  const CaptureProblem& problem;
  const ObjectiveTerm& term;
  const PostureResponse& response;
  const Vector6d& Fbar;
  const RobotModel* planned;  ///< robot that the controller was made for; null: the problem's
};

/// The formula of this room for an objective quantity, written apart from the planner's.
struct QuantityRecord {
  ObjectiveQuantity quantity;
  /// The quantity is size^power: the size grows with the impulse, the power is 1 or 2.
  double (*size)(const TermCase&);
  int power;
  /// Size of what `size` is a sum and difference of: two evaluations agree to a part of it.
  double (*rounding_scale)(const TermCase&);
  /// The angular momentum that vanishes where the quantity does; null: there is none.
  Vector3d reference::Impact::*momentum;
};
const QuantityRecord& record_of(ObjectiveQuantity quantity);

/// Change of attitude of the base `after` seconds after an impulse under the problem's first
/// controller, rad: simulated with adaptive steps from the jump of `reference`. At most pi; pi when
/// the simulation breaks off.
double attitude_turned(const TermCase& at);

/// One term of an objective for an impulse, in its own unit, and its rounding scale.
double term_value(const TermCase& at);
double term_scale(const TermCase& at);

/// The problem's objective for an impulse: the root of the sum of (term / size)^2, of squares
/// (power 2) term / size; of one square alone the square.
/// @param planned robot that the controller was made for; null: the problem's
double objective_value(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, const RobotModel* planned = nullptr);
/// The same of the rounding scales: positive for every impulse but zero, also where the hand is at
/// the centroid.
double objective_scale(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar);

/// Objective along the directions d (unit, in B) of the impulse on the hand.
double objective_along(const Situation& situation, const Vector3d& d);
double scale_along(const Situation& situation, const Vector3d& d);

/// |y|^2 for an impulse, y the terms of the objective below each other, each over its size.
double square_of(const CaptureProblem& problem, const PostureResponse& response,
                 const Vector6d& Fbar);

/// Largest relative error of a stated nominal objective: two integrations of one motion agree less
/// well than two evaluations of one formula.
double objective_tolerance(const CaptureProblem& problem, double recompute_tolerance);

struct WorstDirection {
  double value = 0;
  Vector3d direction = Vector3d::Zero();
};

/// The direction of a cone about n (unit) at this angle from n and this azimuth; in a wedge n
/// rotated about the plane's normal (unit) by the angle. rad
Vector3d cone_direction(const Vector3d& n, const std::optional<Vector3d>& plane_normal,
                        double angle, double azimuth);

/// @param n axis of the cone, unit
/// @param half_angle rad
/// @param plane_normal unit; with it the cone is the wedge that n sweeps when rotated about it
/// @param samples directions before the refinement
WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples);

/// Largest objective over the problem's cone of directions.
/// @param samples directions before the local refinement
WorstDirection worst_direction(const Situation& situation, int samples);

/// |y|^2 of each of the problem's samples at a configuration, with its weight.
struct WeightedSquare {
  double square = 0, weight = 0;
};
std::vector<WeightedSquare> sampled_squares(const CaptureProblem& problem,
                                            const TargetMotion* motion,
                                            const Configuration& configuration,
                                            const PostureResponse& response);

/// The problem's measure over its samples (expectation, CVaR), as a root.
double sampled_measure(const CaptureProblem& problem, const TargetMotion* motion,
                       const Configuration& configuration, const PostureResponse& response);
inline double sampled_measure(const Situation& at) {
  return sampled_measure(at.problem, at.target(), at.at, at.response);
}

/// The measures over a residual velocity, and what bounds the worst case from above.
struct ResidualNumbers {
  double expectation = 0, worst_case = 0, worst_case_bound = 0;
};
ResidualNumbers residual_numbers(const CaptureProblem& problem, const ResidualCase& residual);
/// The objective at a relative velocity [v; omega] (in B), as if what separates could pull.
double residual_along(const CaptureProblem& problem, const ResidualCase& residual,
                      const Vector6d& V);

/// Expectation or CVaR.
bool is_sampled(RiskMeasure measure);

/// The problem's measure at a configuration.
/// @param cone_samples directions before the local refinement
double measure_value(const Situation& situation, int cone_samples);

/// Objective and measure at a configuration.
struct ObjectiveNumbers {
  double nominal = 0;
  double worst_case = 0;  ///< largest of the sampled directions
  double measure = 0;     ///< of the problem
  double scale = 0;       ///< size of the terms that the nominal value is a sum and difference of
};
ObjectiveNumbers objective_numbers(const Situation& situation, int cone_samples);

}  // namespace stillbase::verification
