// The polish as a nonlinear program: control points of a spline from rest to rest, and its speed.
//
//   x = [control points of the free joints, column by column; v]   v = planned duration / duration
//   time       minimise 1 / v
//   attitude   minimise the mean square of the base's turn away from its final attitude (the
//   largest
//              turn is not smooth), the duration left as long as it need be
//   subject to rates at knots and between, accelerations at knots, torques at knots where they
//              matter, as parts of their limits; clearances at knots and between, the target where
//              it is at that time
//
// Momentum is conserved by construction: the base's motion is integrated.
#pragma once

#include <vector>

#include <stillbase/nlp/problem.hpp>

#include "approach/attempt.hpp"
#include "approach/rest_spline.hpp"

namespace stillbase {

/// 3 x any number of unknowns; the joints' Matrix3Xd has no room for control points.
using TurnSlopes = Eigen::Matrix<double, 3, Eigen::Dynamic>;

class PolishProblem final : public nlp::Problem {
 public:
  /// @param found outlives this
  PolishProblem(const ApproachTask& task, const AttemptResult& found, double wait);

  int num_variables() const override { return num_points() + 1; }
  int num_constraints() const override;
  Eigen::VectorXd lower() const override { return lower_; }
  Eigen::VectorXd upper() const override { return upper_; }
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;

  /// The planned motion as near as the splines come, a little slower.
  Eigen::VectorXd start() const { return x_start_; }
  /// The motion of x, from time 0; joints that may not move stay where they are to the last bit.
  JointPath motion(const Eigen::VectorXd& x) const;

 private:
  struct Place {
    double u = 0;
    RestSpline::Weights value, first, second;
  };
  struct State {
    std::vector<JointVectord> phi, first;  ///< at the places; derivatives with respect to u
    std::vector<Pose> base;
  };

  void set_bounds();
  int num_points() const { return static_cast<int>(task_.free.size()) * spline_.points(); }
  bool is_for_time() const { return task_.problem.approach.polish == PathPolish::Time; }
  bool has_torque_rows() const { return torque_rows_ > 0; }
  const PolishOptions& options() const { return task_.options.polish; }
  std::size_t knot_stride() const {
    return static_cast<std::size_t>(options().places_per_interval);
  }
  Eigen::MatrixXd points(const Eigen::VectorXd& x) const;
  JointMotion motion_at(const Place& place, const Eigen::MatrixXd& points, double v) const;
  State state(const Eigen::VectorXd& x) const;
  double time_at(double u, double v) const;
  double excursion(const State& state) const;
  /// How the base at each place is turned, seen from the last one, by the control points (3 x N-1).
  std::vector<TurnSlopes> turn_slopes(const State& state, const Eigen::VectorXd& x) const;
  Eigen::VectorXd excursion_slope(const State& state, const std::vector<TurnSlopes>& turns) const;
  Eigen::RowVectorXd clearance_slope(const State& state, std::size_t j, double v, double here,
                                     const TurnSlopes& turns) const;
  double needed() const;
  Eigen::VectorXd torques(const Place& knot, const Eigen::MatrixXd& points, double v) const;
  double clearance(const JointVectord& phi, const Pose& base, double time) const;

  const ApproachTask& task_;
  const TimedMotion& planned_;
  const std::optional<TargetMotion>& target_;
  double planned_duration_;
  double arrival_;  ///< s
  RestSpline spline_;
  std::vector<Place> places_;  ///< knots and what is between them, in order
  Eigen::VectorXd x_start_, lower_, upper_;
  JointVectord effort_;  ///< limits of the joints whose torques are looked at; infinite: not
  int torque_rows_ = 0;
};

}  // namespace stillbase
