// Improves a found path by Ipopt, path and time law together. The result is checked like every
// path, taken in part where the check refuses it, and dropped where it is no better.
#pragma once

#include <vector>

#include <stillbase/nlp/problem.hpp>

#include "approach/attempt.hpp"
#include "approach/rest_spline.hpp"

namespace stillbase {

/// Replaces a found motion by a better one in the sense of the problem's polish, if there is one,
/// and states the measure (s of motion, or rad of excursion) before and after.
void polish(const ApproachTask& task, double wait, const StopCondition& stop, AttemptResult& found);

/// 3 x any number of unknowns; the joints' Matrix3Xd has no room for control points.
using TurnSlopes = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// The polish as a nonlinear program: control points of a spline from rest to rest, and its speed.
///
///   x = [control points of the free joints, column by column; v]   v = planned duration / duration
///   time       minimise 1 / v
///   attitude   minimise the mean square of the base's rotation angle from its final attitude (the
///              largest angle is not smooth), with the duration that the limits ask for
///   subject to rates at knots and between, accelerations at knots, torques at knots where they
///              matter, as parts of their limits; clearances at knots and between, the target where
///              it is at that time
///
/// Momentum is conserved by construction: the base's motion is integrated.
class PolishProblem final : public nlp::Problem {
 public:
  /// @param found outlives this
  PolishProblem(const ApproachTask& task, const AttemptResult& found, double wait);

  int num_variables() const override { return num_points() + 1; }
  int num_constraints() const override { return clearance_rows_begin() + inner_places(); }
  Eigen::VectorXd lower() const override { return lower_; }
  Eigen::VectorXd upper() const override { return upper_; }
  Eigen::VectorXd constraint_lower() const override { return bounds(-1, 0); }
  Eigen::VectorXd constraint_upper() const override { return bounds(1, kInfinity); }
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    evaluate(x, true, out);
  }
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    evaluate(x, false, out);
  }

  /// The planned motion as near as the splines come, slowed down somewhat.
  Eigen::VectorXd start() const { return x_start_; }
  /// The motion of x, from time 0; joints that may not move stay where they are to the last bit.
  JointPath motion(const Eigen::VectorXd& x) const;

 private:
  struct Place {
    double u = 0;
    RestSpline::Weights value, first, second;
    bool is_knot = false;
  };
  struct State {
    std::vector<JointVectord> phi, first;  ///< at the places; derivatives with respect to u
    std::vector<Pose> base;
  };

  int num_free() const { return static_cast<int>(task_.free.size()); }
  int num_points() const { return num_free() * spline_.points(); }
  /// Rows: rates at the inner places, accelerations at knots, torques at knots, clearances at the
  /// inner places.
  int inner_places() const { return static_cast<int>(places_.size()) - 2; }
  int clearance_rows_begin() const {
    return num_free() * (inner_places() + options().intervals + 1) + torque_rows_;
  }
  bool is_for_time() const { return task_.problem.approach.polish == PathPolish::Time; }
  const PolishOptions& options() const { return task_.options.polish; }

  void set_bounds();
  Eigen::VectorXd bounds(double sign, double clearance) const;
  Eigen::MatrixXd points(const Eigen::VectorXd& x) const;
  State state(const Eigen::MatrixXd& points) const;
  void evaluate(const Eigen::VectorXd& x, bool with_slopes, nlp::Evaluation& out) const;
  /// Mean square of the base's rotation angle from its final attitude, rad^2.
  double excursion(const State& state) const;
  /// Rotation vector of the base at each place, in the axes of the last one, per control point (3 x
  /// N-1).
  std::vector<TurnSlopes> turn_slopes(const State& state, const Eigen::MatrixXd& points) const;
  Eigen::VectorXd torques(const Place& knot, const Eigen::MatrixXd& points, double v) const;
  double clearance(const JointVectord& phi, const Pose& base, double u, double v) const;
  Eigen::RowVectorXd clearance_slope(const State& state, std::size_t j, double v, double here,
                                     const TurnSlopes& turns) const;

  const ApproachTask& task_;
  const TimedMotion& planned_;
  const std::optional<TargetMotion>& target_;
  double planned_duration_;
  double arrival_;  ///< s
  RestSpline spline_;
  std::vector<Place> places_;  ///< knots and what is between them, in order
  Eigen::VectorXd x_start_, lower_, upper_;
  JointVectord effort_;  ///< limits of the joints whose torques are constrained; infinite: none
  int torque_rows_ = 0;
};

}  // namespace stillbase
