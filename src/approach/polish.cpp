#include "approach/polish.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/nlp/optimizer.hpp>

#include "approach/base_motion.hpp"
#include "approach/spline_shift.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

constexpr int kControlPoints = 6;
constexpr int kIntervals = 48;       ///< of the samples at which everything is looked at
constexpr int kClearanceStride = 1;  ///< of those samples
constexpr double kSlowest = 1.5;     ///< times the planned time of motion, for the attitude
constexpr double kFastest = 0.2;
constexpr double kLargestShift = 1.5;    ///< rad
constexpr double kExtraClearance = 1.2;  ///< between the samples it may be less
constexpr double kFarAway = 0.2;         ///< m: distances beyond say nothing
constexpr double kDifference = 1e-5;     ///< rad
constexpr int kEvaluations = 150;
constexpr double kWorthwhile = 1e-6;  ///< relative gain

/// x = [control points, column by column; factor on the time of motion].
class PolishProblem final : public nlp::Problem {
 public:
  PolishProblem(const ApproachTask& task, const AttemptResult& found)
      : task_(task), n_(task.problem.robot.n()), motion_(found.motion), target_(found.target) {
    const JointPath& path = motion_.path;
    const double begin = path.times.front();
    duration_ = path.times.back() - begin;
    std::size_t segment = 0;
    for (int j = 0; j <= kIntervals; ++j) {
      const double t = std::min(begin + duration_ * j / kIntervals, path.times.back());
      while (segment + 2 < path.times.size() && path.times[segment + 1] < t) ++segment;
      const JointMotion at = motion_on_segment(path, segment, t);
      samples_.times.push_back(t);
      samples_.phi.push_back(at.phi);
      samples_.phidot.push_back(at.phidot);
      accelerations_.push_back(at.phiddot);
      basis_.push_back(spline_basis(static_cast<double>(j) / kIntervals, kControlPoints));
    }
  }

  int num_variables() const override { return n_ * kControlPoints + 1; }
  int num_constraints() const override {
    return 4 * n_ * (kIntervals - 1) + kIntervals / kClearanceStride - 1;
  }
  Eigen::VectorXd lower() const override {
    Eigen::VectorXd bound = -upper();
    bound[num_variables() - 1] = is_for_time() ? kFastest : kSlowest;
    return bound;
  }
  Eigen::VectorXd upper() const override {
    Eigen::VectorXd bound = Eigen::VectorXd::Zero(num_variables());
    for (const Eigen::Index k : task_.free) {
      for (int c = 0; c < kControlPoints; ++c) bound[c * n_ + k] = kLargestShift;
    }
    bound[num_variables() - 1] = is_for_time() ? 1.0 : kSlowest;
    return bound;
  }
  Eigen::VectorXd constraint_lower() const override {
    Eigen::VectorXd bound = Eigen::VectorXd::Zero(num_constraints());
    return bound;
  }
  Eigen::VectorXd constraint_upper() const override {
    return Eigen::VectorXd::Constant(num_constraints(), nlp::kInfinity);
  }

  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    evaluate_value(x, out);
    const JointPath path = shifted(x);
    out.gradient = Eigen::VectorXd::Zero(num_variables());
    if (is_for_time()) {
      out.gradient[num_variables() - 1] = 1;
    } else {
      Eigen::VectorXd beside = x;
      for (const Eigen::Index k : task_.free) {
        for (int c = 0; c < kControlPoints; ++c) {
          const Eigen::Index i = c * n_ + k;
          beside[i] += kDifference;
          const double ahead = excursion(shifted(beside));
          beside[i] -= 2 * kDifference;
          out.gradient[i] = (ahead - excursion(shifted(beside))) / (2 * kDifference);
          beside[i] = x[i];
        }
      }
    }
    out.jacobian = Eigen::MatrixXd::Zero(num_constraints(), num_variables());
    const double theta = x[num_variables() - 1];
    Eigen::Index row = 0;
    for (int j = 1; j < kIntervals; ++j) {
      const SplineBasis& basis = basis_[static_cast<std::size_t>(j)];
      for (int k = 0; k < n_; ++k) {
        const double rate = std::isfinite(task_.max_rate[k]) ? 1 / task_.max_rate[k] : 0;
        const double hard = 1 / task_.problem.approach.acceleration_limit[k];
        for (const double side : {1.0, -1.0}) {
          for (int c = 0; c < kControlPoints; ++c) {
            out.jacobian(row, c * n_ + k) = side * rate * basis.first[c] / duration_;
            out.jacobian(row + 1, c * n_ + k) =
                side * hard * basis.second[c] / (duration_ * duration_);
          }
          out.jacobian(row, num_variables() - 1) = 1;
          out.jacobian(row + 1, num_variables() - 1) = 2 * theta;
          row += 2;
        }
      }
    }
    const std::vector<Pose> bases = poses(path);
    for (int j = kClearanceStride; j < kIntervals; j += kClearanceStride, ++row) {
      const auto at = static_cast<std::size_t>(j);
      if (out.constraints[row] >= (kFarAway - needed()) / kFarAway) continue;
      for (const Eigen::Index k : task_.free) {
        JointVectord beside = path.phi[at];
        beside[k] += kDifference;
        const double slope =
            (clearance(beside, bases[at], path.times[at]) - out.constraints[row]) / kDifference;
        for (int c = 0; c < kControlPoints; ++c) {
          out.jacobian(row, c * n_ + k) = slope * basis_[at].value[c];
        }
      }
    }
  }

  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    const JointPath path = shifted(x);
    const double theta = x[num_variables() - 1];
    out.objective = is_for_time() ? theta : excursion(path);
    out.constraints.resize(num_constraints());
    Eigen::Index row = 0;
    for (int j = 1; j < kIntervals; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const JointVectord bent =
          accelerations_[at] + points(x) * basis_[at].second / (duration_ * duration_);
      for (int k = 0; k < n_; ++k) {
        const double rate =
            std::isfinite(task_.max_rate[k]) ? path.phidot[at][k] / task_.max_rate[k] : 0;
        const double hard = bent[k] / task_.problem.approach.acceleration_limit[k];
        for (const double side : {1.0, -1.0}) {
          out.constraints[row] = theta + side * rate;
          out.constraints[row + 1] = theta * theta + side * hard;
          row += 2;
        }
      }
    }
    const std::vector<Pose> bases = poses(path);
    for (int j = kClearanceStride; j < kIntervals; j += kClearanceStride) {
      const auto at = static_cast<std::size_t>(j);
      out.constraints[row++] = clearance(path.phi[at], bases[at], path.times[at]);
    }
  }

  Eigen::MatrixXd points(const Eigen::VectorXd& x) const {
    return Eigen::Map<const Eigen::MatrixXd>(x.data(), n_, kControlPoints);
  }

 private:
  bool is_for_time() const { return task_.problem.approach.polish == PathPolish::Time; }
  double needed() const { return kExtraClearance * task_.problem.approach.clearance; }

  JointPath shifted(const Eigen::VectorXd& x) const { return spline_shifted(samples_, points(x)); }

  std::vector<Pose> poses(const JointPath& path) const {
    std::vector<Pose> out(path.times.size(), motion_.base_poses.back());
    if (task_.problem.approach.base == BaseMode::Held) return out;
    for (std::size_t i = path.segments(); i-- > 0;) {
      out[i] = out[i + 1] *
               base_step(task_.problem.robot, path, i, path.times[i], path.times[i + 1]).inverse();
    }
    return out;
  }

  /// Mean square of the turn away from the final attitude, rad^2: the largest one is not smooth.
  double excursion(const JointPath& path) const {
    double sum = 0;
    const std::vector<Pose> bases = poses(path);
    for (const Pose& pose : bases) {
      sum += rotation_log(bases.back().orientation.conjugate() * pose.orientation).squaredNorm();
    }
    return sum / static_cast<double>(bases.size());
  }

  /// Distance beyond what is needed, over the distance at which it no longer matters.
  double clearance(const JointVectord& phi, const Pose& base, double time) const {
    const Pose target = target_ ? target_->state(time).pose : Pose{};
    const auto nearest = task_.scene.nearest(compute_kinematics<double>(task_.problem.robot, phi),
                                             base, target_ ? &target : nullptr, false);
    const double distance = nearest ? std::min(nearest->distance, kFarAway) : kFarAway;
    return (distance - needed()) / kFarAway;
  }

  const ApproachTask& task_;
  int n_;
  const TimedMotion& motion_;
  const std::optional<TargetMotion>& target_;
  double duration_ = 0;
  JointPath samples_;
  std::vector<JointVectord> accelerations_;
  std::vector<SplineBasis> basis_;
};

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

/// The shifted path with its own time law as fast as the limits allow, and with a new one.
std::vector<JointPath> timed(const ApproachTask& task, const JointPath& shifted) {
  const JointVectord& hardest = task.problem.approach.acceleration_limit;
  JointPath own = shifted;
  for (double& t : own.times) t -= shifted.times.front();
  stretch(own, stretch_for_limits(own, task.max_rate, hardest) * (1 + 1e-9));
  std::vector<JointPath> paths(1, std::move(own));
  const JointPath curve = over_length(shifted);
  if (curve.segments() > 0) paths.push_back(time_curve(curve, task.max_rate, hardest));
  return paths;
}

}  // namespace

void polish(const ApproachTask& task, double wait, const StopCondition& stop,
            AttemptResult& found) {
  if (task.problem.approach.polish == PathPolish::None || task.free.empty()) return;
  found.before_polish = found.after_polish = measure(task, found.motion);
  const PolishProblem problem(task, found);
  nlp::OptimizeOptions options;
  options.max_evaluations = kEvaluations;
  options.stop = stop;
  options.explain_infeasibility = false;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.num_variables());
  x[x.size() - 1] = problem.upper()[x.size() - 1];
  x = nlp::make_optimizer("ipopt-lbfgs")->minimize(problem, x, options).x;
  const AttemptResult planned = found;
  for (const double part : {1.0, 0.75, 0.5, 0.25}) {
    const JointPath shifted = spline_shifted(planned.motion.path, part * problem.points(x));
    for (JointPath& path : timed(task, shifted)) {
      AttemptResult trial = planned;
      finish_motion(task, std::move(path), wait, trial);
      if (trial.status != ApproachStatus::Found) continue;
      trial.after_polish = measure(task, trial.motion);
      if (trial.after_polish < found.after_polish * (1 - kWorthwhile)) found = std::move(trial);
    }
  }
}

}  // namespace stillbase
