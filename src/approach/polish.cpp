#include "approach/polish.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/rotation.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "approach/base_motion.hpp"
#include "approach/effort.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// Gauss points of an interval, as in base_step().
constexpr double kGaussPoints[] = {0.21132486540518713, 0.7886751345948129};

Vector3d turning(const RobotModel& robot, const JointVectord& phi, const JointVectord& first) {
  return base_velocity(robot, {phi, first, first}).tail<3>();
}

double measure(const ApproachTask& task, const TimedMotion& motion) {
  if (task.problem.approach.polish == PathPolish::Time) {
    return motion.path.times.back() - motion.path.times.front();
  }
  double excursion = 0;
  for (const Pose& pose : motion.base_poses) {
    excursion = std::max(
        excursion,
        rotation_log(motion.base_poses.back().orientation.conjugate() * pose.orientation).norm());
  }
  return excursion;
}

/// A shape with its own time law as fast as the limits allow, and with a new one.
std::vector<JointPath> timed(const ApproachTask& task, JointPath own) {
  std::vector<JointPath> paths;
  const JointPath curve = over_length(own);
  if (curve.segments() > 0) paths.push_back(time_curve(curve, task.limits, task.options.time_law));
  stretch(own, stretch_for_limits(own, task.limits) * (1 + 1e-9));
  paths.push_back(std::move(own));
  return paths;
}

}  // namespace

void polish(const ApproachTask& task, double wait, const StopCondition& stop,
            AttemptResult& found) {
  if (task.problem.approach.polish == PathPolish::None || task.free.empty()) return;
  found.before_polish = found.after_polish = measure(task, found.motion);
  if (!(found.motion.path.times.back() > found.motion.path.times.front())) return;
  const AttemptResult planned = found;
  const PolishProblem problem(task, planned, wait);
  nlp::OptimizeOptions options;
  options.max_evaluations = task.options.polish.evaluations;
  options.stop = stop;
  options.feasibility_tolerance = task.options.polish.feasibility_tolerance;
  options.explain_infeasibility = false;
  const Eigen::VectorXd begin = problem.start();
  const Eigen::VectorXd end =
      nlp::make_optimizer("ipopt-lbfgs")->minimize(problem, begin, options).x;
  for (const double part : task.options.polish.parts) {
    for (JointPath& path : timed(task, problem.motion(begin + part * (end - begin)))) {
      AttemptResult trial = planned;
      finish_motion(task, std::move(path), wait, trial);
      if (trial.status != ApproachStatus::Found) continue;
      trial.after_polish = measure(task, trial.motion);
      if (trial.after_polish < found.after_polish * (1 - task.options.polish.worthwhile)) {
        found = std::move(trial);
      }
    }
  }
}

PolishProblem::PolishProblem(const ApproachTask& task, const AttemptResult& found, double wait)
    : task_(task),
      planned_(found.motion),
      target_(found.target),
      planned_duration_(found.motion.path.times.back() - found.motion.path.times.front()),
      arrival_(found.motion.contact_time - wait),
      spline_(found.motion.path.phi.front(), found.motion.path.phi.back(),
              task.options.polish.intervals) {
  const int per_interval = options().places_per_interval;
  const int count = options().intervals * per_interval;
  for (int j = 0; j <= count; ++j) {
    const double u = static_cast<double>(j) / count;
    places_.push_back({u, spline_.weights(u, 0), spline_.weights(u, 1), spline_.weights(u, 2),
                       j % per_interval == 0});
  }
  set_bounds();
  const Eigen::MatrixXd fitted = spline_.fitted(planned_.path)(task_.free, Eigen::all);
  x_start_.resize(num_variables());
  x_start_ << fitted.reshaped(), is_for_time() ? options().first_speed : options().slowest;
  x_start_ = x_start_.cwiseMax(lower_).cwiseMin(upper_);
  const int n = task_.problem.robot.n();
  effort_ = JointVectord::Constant(n, kInfinity);
  if (effort_used(task_.problem, planned_.path, task_.options.effort) > options().small_torque) {
    for (int k = 0; k < n; ++k) effort_[k] = task_.problem.robot.joints[k].max_effort;
    torque_rows_ = n * (options().intervals + 1);
  }
}

void PolishProblem::set_bounds() {
  lower_.resize(num_variables());
  upper_.resize(num_variables());
  for (int i = 0; i < num_free(); ++i) {
    const Eigen::Index k = task_.free[i];
    const Joint& joint = task_.problem.robot.joints[k];
    double least = kInfinity, most = -kInfinity;
    for (const JointVectord& phi : planned_.path.phi) {
      least = std::min(least, phi[k]);
      most = std::max(most, phi[k]);
    }
    for (int c = 0; c < spline_.points(); ++c) {
      lower_[c * num_free() + i] = std::max(least - options().room, std::min(joint.lower, least));
      upper_[c * num_free() + i] = std::min(most + options().room, std::max(joint.upper, most));
    }
  }
  lower_[num_points()] = is_for_time() ? options().first_speed / 2 : options().slowest;
  upper_[num_points()] = is_for_time() ? options().fastest : options().slowest;
}

Eigen::VectorXd PolishProblem::bounds(double sign, double clearance) const {
  Eigen::VectorXd bound = Eigen::VectorXd::Constant(num_constraints(), sign * options().usable);
  bound.tail(inner_places()).setConstant(clearance);
  return bound;
}

Eigen::MatrixXd PolishProblem::points(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd all = planned_.path.phi.front().replicate(1, spline_.points());
  all(task_.free, Eigen::all) = x.head(num_points()).reshaped(num_free(), spline_.points());
  return all;
}

JointPath PolishProblem::motion(const Eigen::VectorXd& x) const {
  JointPath path = spline_.motion(points(x), planned_duration_ / x[num_points()], options().stored);
  for (std::size_t i = 0; i < path.phi.size(); ++i) {
    path.phi[i] = with_free_part(path.phi.front(), task_.free, path.phi[i](task_.free));
    path.phidot[i] = with_free_part(JointVectord::Zero(path.phi[i].size()), task_.free,
                                    path.phidot[i](task_.free));
  }
  return path;
}

// Between two places the base turns by the velocities at two Gauss points; here the places are near
// and one in the middle would do, but the same steps as everywhere keep one meaning.
PolishProblem::State PolishProblem::state(const Eigen::MatrixXd& points) const {
  State out;
  JointPath path;
  for (const Place& place : places_) {
    path.times.push_back(place.u);
    path.phi.push_back(spline_.at(place.value, points));
    path.phidot.push_back(spline_.at(place.first, points));
  }
  out.base.assign(places_.size(), planned_.base_poses.back());
  if (task_.problem.approach.base != BaseMode::Held) {
    for (std::size_t i = path.segments(); i-- > 0;) {
      out.base[i] =
          out.base[i + 1] *
          base_step(task_.problem.robot, path, i, path.times[i], path.times[i + 1]).inverse();
    }
  }
  out.phi = std::move(path.phi);
  out.first = std::move(path.phidot);
  return out;
}

double PolishProblem::excursion(const State& state) const {
  double sum = 0;
  for (const Pose& pose : state.base) {
    sum += rotation_log(state.base.back().orientation.conjugate() * pose.orientation).squaredNorm();
  }
  return sum / static_cast<double>(state.base.size());
}

// Q_j the attitude at place j seen from the last one, D_i the turn from i to i + 1. A small turn
// delta_i behind D_i changes all Q_j, j <= i, by exp(-Q_(i+1) delta_i) from the left. delta_i by
// differences of the turning rate at the two points that the integration takes.
std::vector<TurnSlopes> PolishProblem::turn_slopes(const State& state,
                                                   const Eigen::MatrixXd& points) const {
  const RobotModel& robot = task_.problem.robot;
  std::vector<TurnSlopes> slopes(places_.size(), TurnSlopes::Zero(3, num_points()));
  if (task_.problem.approach.base == BaseMode::Held) return slopes;
  const double step = options().difference;
  for (std::size_t i = places_.size() - 1; i-- > 0;) {
    slopes[i] = slopes[i + 1];
    const Matrix3d seen =
        (state.base.back().orientation.conjugate() * state.base[i + 1].orientation)
            .toRotationMatrix();
    const double h = places_[i + 1].u - places_[i].u;
    for (const double part : kGaussPoints) {
      const double u = places_[i].u + part * h;
      const RestSpline::Weights value = spline_.weights(u, 0), first = spline_.weights(u, 1);
      JointVectord phi = spline_.at(value, points), rate = spline_.at(first, points);
      const Vector3d here = turning(robot, phi, rate);
      for (Eigen::Index c = 0; c < spline_.points(); ++c) {
        if (value.points[c] == 0 && first.points[c] == 0) continue;
        for (Eigen::Index row = 0; row < num_free(); ++row) {
          const Eigen::Index k = task_.free[row];
          const double phi_k = phi[k], rate_k = rate[k];
          phi[k] += step * value.points[c];
          rate[k] += step * first.points[c];
          slopes[i].col(c * num_free() + row) -=
              h / (2 * step) * (seen * (turning(robot, phi, rate) - here));
          phi[k] = phi_k;
          rate[k] = rate_k;
        }
      }
    }
  }
  return slopes;
}

// The joints move the base about the system's centroid, which stays where it is.
Eigen::RowVectorXd PolishProblem::clearance_slope(const State& state, std::size_t j, double v,
                                                  double here, const TurnSlopes& turns) const {
  const double step = options().distance_difference;
  const RobotModel& robot = task_.problem.robot;
  const bool floats = task_.problem.approach.base != BaseMode::Held;
  const JointVectord& phi = state.phi[j];
  const Pose& base = state.base[j];
  const Place& place = places_[j];
  const auto centroid_at = [&](const JointVectord& at) {
    return system_centroid(robot, compute_kinematics<double>(robot, at));
  };
  const Vector3d centroid = centroid_at(phi);
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(num_variables());
  for (Eigen::Index i = 0; i < num_free(); ++i) {
    JointVectord beside = phi;
    beside[task_.free[i]] += step;
    Pose moved = base;
    if (floats) moved.position += base.orientation * Vector3d(centroid - centroid_at(beside));
    const double d = (clearance(beside, moved, place.u, v) - here) / step;
    for (Eigen::Index c = 0; c < spline_.points(); ++c) {
      slope[c * num_free() + i] = d * place.value.points[c];
    }
  }
  if (floats) {
    const Eigen::Quaterniond& last = state.base.back().orientation;
    Vector3d by_turn;
    for (int axis = 0; axis < 3; ++axis) {
      Pose moved;
      moved.orientation =
          last * rotation_exp(step * Vector3d::Unit(axis)) * last.conjugate() * base.orientation;
      moved.position = base * centroid - moved.orientation * centroid;
      by_turn[axis] = (clearance(phi, moved, place.u, v) - here) / step;
    }
    slope.head(num_points()) += by_turn.transpose() * turns;
  }
  if (target_) {
    slope[num_points()] = (clearance(phi, base, place.u, v * (1 + step)) - here) / (v * step);
  }
  return slope;
}

Eigen::VectorXd PolishProblem::torques(const Place& knot, const Eigen::MatrixXd& points,
                                       double v) const {
  const double rate = v / planned_duration_;
  const JointMotion motion{spline_.at(knot.value, points), rate * spline_.at(knot.first, points),
                           rate * rate * spline_.at(knot.second, points)};
  return joint_torques(task_.problem, motion).cwiseQuotient(effort_);
}

/// Distance beyond what is asked for, over the distance from which on none is asked for.
double PolishProblem::clearance(const JointVectord& phi, const Pose& base, double u,
                                double v) const {
  const double time = arrival_ - (1 - u) * planned_duration_ / v;
  const Pose target = target_ ? target_->state(time).pose : Pose{};
  const auto nearest = task_.scene.nearest(compute_kinematics<double>(task_.problem.robot, phi),
                                           base, target_ ? &target : nullptr, false);
  const double far = options().far_away;
  const double distance = nearest ? std::min(nearest->distance, far) : far;
  return (distance - options().extra_clearance * task_.problem.approach.clearance) / far;
}

void PolishProblem::evaluate(const Eigen::VectorXd& x, bool with_slopes,
                             nlp::Evaluation& out) const {
  const Eigen::MatrixXd all = points(x);
  const State now = state(all);
  const Eigen::Index m = num_free(), last = num_points();
  const double v = x[last], rate = v / planned_duration_;
  std::vector<TurnSlopes> turns;
  Eigen::MatrixXd& J = out.jacobian;
  out.objective = is_for_time() ? 1 / v : excursion(now);
  out.constraints.resize(num_constraints());
  if (with_slopes) {
    turns = turn_slopes(now, all);
    J = Eigen::MatrixXd::Zero(num_constraints(), num_variables());
    out.gradient = Eigen::VectorXd::Zero(num_variables());
    if (is_for_time()) out.gradient[last] = -1 / (v * v);
    for (std::size_t j = 0; j < places_.size() && !is_for_time(); ++j) {
      // d|log Q|^2 = 2 log(Q) . w for exp(w) Q.
      const Vector3d turned =
          rotation_log(now.base.back().orientation.conjugate() * now.base[j].orientation);
      out.gradient.head(last) +=
          2 / static_cast<double>(places_.size()) * (turns[j].transpose() * turned);
    }
  }
  Eigen::Index row = 0;
  // One row per free joint of scale * (derivative at a place) / limit; scale goes with v^power.
  const auto add_limits = [&](const JointVectord& values, const RestSpline::Weights& weights,
                              double scale, int power, const JointVectord& limits) {
    for (Eigen::Index i = 0; i < m; ++i, ++row) {
      const Eigen::Index k = task_.free[i];
      out.constraints[row] = scale * values[k] / limits[k];
      if (!with_slopes) continue;
      for (Eigen::Index c = 0; c < spline_.points(); ++c) {
        J(row, c * m + i) = scale / limits[k] * weights.points[c];
      }
      J(row, last) = power * out.constraints[row] / v;
    }
  };
  for (std::size_t j = 1; j + 1 < places_.size(); ++j) {
    add_limits(now.first[j], places_[j].first, rate, 1, task_.limits.rate);
  }
  for (const Place& knot : places_) {
    if (!knot.is_knot) continue;
    add_limits(spline_.at(knot.second, all), knot.second, rate * rate, 2,
               task_.limits.acceleration);
  }
  for (const Place& knot : places_) {
    if (!knot.is_knot || torque_rows_ == 0) continue;
    const Eigen::VectorXd used = torques(knot, all, v);
    out.constraints.segment(row, used.size()) = used;
    Eigen::MatrixXd beside = all;
    for (Eigen::Index c = 0; c < spline_.points() && with_slopes; ++c) {
      if (knot.value.points[c] == 0 && knot.second.points[c] == 0) continue;
      for (Eigen::Index i = 0; i < m; ++i) {
        double& point = beside(task_.free[i], c);
        const double kept = point;
        point += options().difference;
        J.block(row, c * m + i, used.size(), 1) =
            (torques(knot, beside, v) - used) / options().difference;
        point = kept;
      }
    }
    // All torques go with the square of v.
    if (with_slopes) J.block(row, last, used.size(), 1) = 2 / v * used;
    row += used.size();
  }
  const double far =
      1 - options().extra_clearance * task_.problem.approach.clearance / options().far_away;
  for (std::size_t j = 1; j + 1 < places_.size(); ++j, ++row) {
    out.constraints[row] = clearance(now.phi[j], now.base[j], places_[j].u, v);
    if (!with_slopes || out.constraints[row] >= far - 1e-9) continue;
    J.row(row) = clearance_slope(now, j, v, out.constraints[row], turns[j]);
  }
}

}  // namespace stillbase
