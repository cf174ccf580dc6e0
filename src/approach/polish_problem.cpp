#include "approach/polish_problem.hpp"

#include <algorithm>
#include <cmath>

#include "approach/base_motion.hpp"
#include "approach/effort.hpp"

namespace stillbase {

namespace {

constexpr double kJointStep = 1e-6;  ///< rad and what belongs to it
/// Of an interval: where the base's motion is looked at.
constexpr double kGaussPoints[] = {0.21132486540518713, 0.7886751345948129};

Vector3d turning(const RobotModel& robot, const JointVectord& phi, const JointVectord& first) {
  return base_velocity(robot, {phi, first, first}).tail<3>();
}

}  // namespace

PolishProblem::PolishProblem(const ApproachTask& task, const AttemptResult& found, double wait)
    : task_(task),
      planned_(found.motion),
      target_(found.target),
      planned_duration_(found.motion.path.times.back() - found.motion.path.times.front()),
      arrival_(found.motion.contact_time - wait),
      spline_(found.motion.path.phi.front(), found.motion.path.phi.back(),
              task.options.polish.intervals) {
  const int count = options().intervals * options().places_per_interval;
  for (int j = 0; j <= count; ++j) {
    const double u = static_cast<double>(j) / count;
    places_.push_back({u, spline_.weights(u, 0), spline_.weights(u, 1), spline_.weights(u, 2)});
  }
  const Eigen::MatrixXd fitted = spline_.fitted(planned_.path);
  x_start_.resize(num_variables());
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  for (Eigen::Index c = 0; c < fitted.cols(); ++c) {
    for (Eigen::Index i = 0; i < m; ++i) {
      x_start_[c * m + i] = fitted(task_.free[static_cast<std::size_t>(i)], c);
    }
  }
  set_bounds();
  x_start_[num_points()] = is_for_time() ? options().first_speed : options().slowest;
  x_start_ = x_start_.cwiseMax(lower_).cwiseMin(upper_);
  const int n = task_.problem.robot.n();
  effort_ = JointVectord::Constant(n, kInfinity);
  if (effort_used(task_.problem, planned_.path, task_.options.effort) > options().small_torque) {
    for (int k = 0; k < n; ++k) {
      effort_[k] = task_.problem.robot.joints[static_cast<std::size_t>(k)].max_effort;
    }
    torque_rows_ = n * (options().intervals + 1);
  }
}

// Rows: rates at all places but the ends, accelerations at knots, torques at knots, clearances at
// all places but the ends.
int PolishProblem::num_constraints() const {
  const int inner = options().intervals * options().places_per_interval - 1;
  const auto m = static_cast<int>(task_.free.size());
  return m * inner + m * (options().intervals + 1) + torque_rows_ + inner;
}

void PolishProblem::set_bounds() {
  lower_.resize(num_variables());
  upper_.resize(num_variables());
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index k = task_.free[static_cast<std::size_t>(i)];
    const Joint& joint = task_.problem.robot.joints[static_cast<std::size_t>(k)];
    double least = kInfinity, most = -kInfinity;
    for (const JointVectord& phi : planned_.path.phi) {
      least = std::min(least, phi[k]);
      most = std::max(most, phi[k]);
    }
    for (Eigen::Index c = 0; c < spline_.points(); ++c) {
      lower_[c * m + i] = std::max(least - options().room, std::min(joint.lower, least));
      upper_[c * m + i] = std::min(most + options().room, std::max(joint.upper, most));
    }
  }
  lower_[num_points()] = is_for_time() ? options().first_speed / 2 : options().slowest;
  upper_[num_points()] = is_for_time() ? options().fastest : options().slowest;
}

Eigen::VectorXd PolishProblem::constraint_lower() const {
  const int inner = options().intervals * options().places_per_interval - 1;
  Eigen::VectorXd bound = Eigen::VectorXd::Constant(num_constraints(), -options().usable);
  bound.tail(inner).setZero();
  return bound;
}

Eigen::VectorXd PolishProblem::constraint_upper() const {
  const int inner = options().intervals * options().places_per_interval - 1;
  Eigen::VectorXd bound = Eigen::VectorXd::Constant(num_constraints(), options().usable);
  bound.tail(inner).setConstant(nlp::kInfinity);
  return bound;
}

Eigen::MatrixXd PolishProblem::points(const Eigen::VectorXd& x) const {
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  Eigen::MatrixXd all(task_.problem.robot.n(), spline_.points());
  for (Eigen::Index c = 0; c < all.cols(); ++c) {
    all.col(c) = planned_.path.phi.front();
    for (Eigen::Index i = 0; i < m; ++i) {
      all(task_.free[static_cast<std::size_t>(i)], c) = x[c * m + i];
    }
  }
  return all;
}

JointPath PolishProblem::motion(const Eigen::VectorXd& x) const {
  constexpr int kStored = 4;  // samples per interval
  JointPath path = spline_.motion(points(x), planned_duration_ / x[num_points()], kStored);
  std::vector<bool> moves(path.phi.front().size(), false);
  for (const Eigen::Index k : task_.free) moves[static_cast<std::size_t>(k)] = true;
  for (std::size_t i = 0; i < path.phi.size(); ++i) {
    for (Eigen::Index k = 0; k < path.phi[i].size(); ++k) {
      if (moves[static_cast<std::size_t>(k)]) continue;
      path.phi[i][k] = path.phi.front()[k];
      path.phidot[i][k] = 0;
    }
  }
  return path;
}

JointMotion PolishProblem::motion_at(const Place& place, const Eigen::MatrixXd& points,
                                     double v) const {
  const double rate = v / planned_duration_;
  return {spline_.at(place.value, points), rate * spline_.at(place.first, points),
          rate * rate * spline_.at(place.second, points)};
}

// Between two places the base turns by the velocities at two Gauss points; here the places are near
// and one in the middle would do, but the same steps as everywhere keep one meaning.
PolishProblem::State PolishProblem::state(const Eigen::VectorXd& x) const {
  const Eigen::MatrixXd all = points(x);
  State out;
  JointPath path;
  for (const Place& place : places_) {
    path.times.push_back(place.u);
    path.phi.push_back(spline_.at(place.value, all));
    path.phidot.push_back(spline_.at(place.first, all));
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

double PolishProblem::time_at(double u, double v) const {
  return arrival_ - (1 - u) * planned_duration_ / v;
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
                                                   const Eigen::VectorXd& x) const {
  const RobotModel& robot = task_.problem.robot;
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  const Eigen::MatrixXd all = points(x);
  std::vector<TurnSlopes> slopes(places_.size(), TurnSlopes::Zero(3, num_points()));
  if (task_.problem.approach.base == BaseMode::Held) return slopes;
  for (std::size_t i = places_.size() - 1; i-- > 0;) {
    slopes[i] = slopes[i + 1];
    const Matrix3d seen =
        (state.base.back().orientation.conjugate() * state.base[i + 1].orientation)
            .toRotationMatrix();
    const double h = places_[i + 1].u - places_[i].u;
    for (const double part : kGaussPoints) {
      const double u = places_[i].u + part * h;
      const RestSpline::Weights value = spline_.weights(u, 0), first = spline_.weights(u, 1);
      JointVectord phi = spline_.at(value, all), rate = spline_.at(first, all);
      const Vector3d here = turning(robot, phi, rate);
      for (Eigen::Index c = 0; c < spline_.points(); ++c) {
        if (value.points[c] == 0 && first.points[c] == 0) continue;
        for (Eigen::Index row = 0; row < m; ++row) {
          const Eigen::Index k = task_.free[static_cast<std::size_t>(row)];
          const double phi_k = phi[k], rate_k = rate[k];
          phi[k] += kJointStep * value.points[c];
          rate[k] += kJointStep * first.points[c];
          slopes[i].col(c * m + row) -=
              h / (2 * kJointStep) * (seen * (turning(robot, phi, rate) - here));
          phi[k] = phi_k;
          rate[k] = rate_k;
        }
      }
    }
  }
  return slopes;
}

// d|log Q|^2 = 2 log(Q) . w for exp(w) Q.
Eigen::VectorXd PolishProblem::excursion_slope(const State& state,
                                               const std::vector<TurnSlopes>& turns) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(num_points());
  for (std::size_t j = 0; j < places_.size(); ++j) {
    const Vector3d turned =
        rotation_log(state.base.back().orientation.conjugate() * state.base[j].orientation);
    slope += 2 / static_cast<double>(places_.size()) * (turns[j].transpose() * turned);
  }
  return slope;
}

// The joints move the base about the system's centroid, which stays where it is.
Eigen::RowVectorXd PolishProblem::clearance_slope(const State& state, std::size_t j, double v,
                                                  double here, const TurnSlopes& turns) const {
  constexpr double kDistanceStep = 1e-5;  // rad; distances are less exact than dynamics
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  const RobotModel& robot = task_.problem.robot;
  const bool floats = task_.problem.approach.base != BaseMode::Held;
  const JointVectord& phi = state.phi[j];
  const Pose& base = state.base[j];
  const double time = time_at(places_[j].u, v);
  const auto centroid_at = [&](const JointVectord& at) {
    return system_centroid(robot, compute_kinematics<double>(robot, at));
  };
  const Vector3d centroid = centroid_at(phi);
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(num_variables());
  for (Eigen::Index i = 0; i < m; ++i) {
    JointVectord beside = phi;
    beside[task_.free[static_cast<std::size_t>(i)]] += kDistanceStep;
    Pose moved = base;
    if (floats) moved.position += base.orientation * Vector3d(centroid - centroid_at(beside));
    const double d = (clearance(beside, moved, time) - here) / kDistanceStep;
    for (Eigen::Index c = 0; c < spline_.points(); ++c) {
      slope[c * m + i] = d * places_[j].value.points[c];
    }
  }
  if (floats) {
    const Eigen::Quaterniond& last = state.base.back().orientation;
    Vector3d by_turn;
    for (int axis = 0; axis < 3; ++axis) {
      Pose moved;
      moved.orientation = last * rotation_exp(kDistanceStep * Vector3d::Unit(axis)) *
                          last.conjugate() * base.orientation;
      moved.position = base * centroid - moved.orientation * centroid;
      by_turn[axis] = (clearance(phi, moved, time) - here) / kDistanceStep;
    }
    slope.head(num_points()) += by_turn.transpose() * turns;
  }
  if (target_) {
    slope[num_points()] =
        (clearance(phi, base, time_at(places_[j].u, v * (1 + kDistanceStep))) - here) /
        (v * kDistanceStep);
  }
  return slope;
}

Eigen::VectorXd PolishProblem::torques(const Place& knot, const Eigen::MatrixXd& points,
                                       double v) const {
  return joint_torques(task_.problem, motion_at(knot, points, v)).cwiseQuotient(effort_);
}

double PolishProblem::needed() const {
  return options().extra_clearance * task_.problem.approach.clearance;
}

double PolishProblem::clearance(const JointVectord& phi, const Pose& base, double time) const {
  const Pose target = target_ ? target_->state(time).pose : Pose{};
  const auto nearest = task_.scene.nearest(compute_kinematics<double>(task_.problem.robot, phi),
                                           base, target_ ? &target : nullptr, false);
  const double distance =
      nearest ? std::min(nearest->distance, options().far_away) : options().far_away;
  return (distance - needed()) / options().far_away;
}

void PolishProblem::evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  const State now = state(x);
  const Eigen::MatrixXd all = points(x);
  const double v = x[num_points()], rate = v / planned_duration_;
  out.objective = is_for_time() ? 1 / v : excursion(now);
  out.constraints.resize(num_constraints());
  Eigen::Index row = 0;
  for (std::size_t j = 1; j + 1 < places_.size(); ++j) {
    for (const Eigen::Index k : task_.free) {
      out.constraints[row++] = rate * now.first[j][k] / task_.max_rate[k];
    }
  }
  const JointVectord& hardest = task_.problem.approach.acceleration_limit;
  for (std::size_t j = 0; j < places_.size(); j += knot_stride()) {
    const JointVectord second = spline_.at(places_[j].second, all);
    for (const Eigen::Index k : task_.free) {
      out.constraints[row++] = rate * rate * second[k] / hardest[k];
    }
  }
  for (std::size_t j = 0; j < places_.size() && has_torque_rows(); j += knot_stride()) {
    const Eigen::VectorXd used = torques(places_[j], all, v);
    out.constraints.segment(row, used.size()) = used;
    row += used.size();
  }
  for (std::size_t j = 1; j + 1 < places_.size(); ++j) {
    out.constraints[row++] = clearance(now.phi[j], now.base[j], time_at(places_[j].u, v));
  }
}

void PolishProblem::evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  evaluate_value(x, out);
  const State now = state(x);
  const Eigen::MatrixXd all = points(x);
  const double v = x[num_points()], rate = v / planned_duration_;
  const auto m = static_cast<Eigen::Index>(task_.free.size());
  const Eigen::Index last = num_points();
  const std::vector<TurnSlopes> turns = turn_slopes(now, x);
  out.gradient = Eigen::VectorXd::Zero(num_variables());
  if (is_for_time()) {
    out.gradient[last] = -1 / (v * v);
  } else {
    out.gradient.head(num_points()) = excursion_slope(now, turns);
  }
  Eigen::MatrixXd& J = out.jacobian;
  J = Eigen::MatrixXd::Zero(num_constraints(), num_variables());
  const auto joint = [&](Eigen::Index i) { return task_.free[static_cast<std::size_t>(i)]; };
  Eigen::Index row = 0;
  for (std::size_t j = 1; j + 1 < places_.size(); ++j) {
    for (Eigen::Index i = 0; i < m; ++i, ++row) {
      const double scale = rate / task_.max_rate[joint(i)];
      for (Eigen::Index c = 0; c < spline_.points(); ++c) {
        J(row, c * m + i) = scale * places_[j].first.points[c];
      }
      J(row, last) = out.constraints[row] / v;
    }
  }
  const JointVectord& hardest = task_.problem.approach.acceleration_limit;
  for (std::size_t j = 0; j < places_.size(); j += knot_stride()) {
    for (Eigen::Index i = 0; i < m; ++i, ++row) {
      const double scale = rate * rate / hardest[joint(i)];
      for (Eigen::Index c = 0; c < spline_.points(); ++c) {
        J(row, c * m + i) = scale * places_[j].second.points[c];
      }
      J(row, last) = 2 * out.constraints[row] / v;
    }
  }
  for (std::size_t j = 0; j < places_.size() && has_torque_rows(); j += knot_stride()) {
    const Eigen::VectorXd used = out.constraints.segment(row, effort_.size());
    Eigen::MatrixXd beside = all;
    for (Eigen::Index c = 0; c < spline_.points(); ++c) {
      if (places_[j].value.points[c] == 0 && places_[j].second.points[c] == 0) continue;
      for (Eigen::Index i = 0; i < m; ++i) {
        beside(joint(i), c) += kJointStep;
        J.block(row, c * m + i, effort_.size(), 1) =
            (torques(places_[j], beside, v) - used) / kJointStep;
        beside(joint(i), c) = all(joint(i), c);
      }
    }
    J.block(row, last, effort_.size(), 1) = 2 / v * used;  // all torques go with the square of v
    row += effort_.size();
  }
  for (std::size_t j = 1; j + 1 < places_.size(); ++j, ++row) {
    const double far = (options().far_away - needed()) / options().far_away - 1e-9;
    if (out.constraints[row] >= far) continue;
    J.row(row) = clearance_slope(now, j, v, out.constraints[row], turns[j]);
  }
}

}  // namespace stillbase
