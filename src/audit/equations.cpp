#include "audit/equations.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

#include "verification/margins.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// How the equations are solved, and when a configuration is a solution of them.
struct EquationOptions {
  /// Beyond the ends of a box, rad (m): candidates satisfy their constraints to 1e-9, and distinct
  /// solutions are further apart than this.
  double near = 1e-6;
  double near_time = 1e-5;  ///< s, likewise: targets are slow
  /// Distance of a configuration from the solution that it is taken for: the tolerance of 1e-9
  /// leaves a double one an extent of its root.
  double solved_nearby = 1e-4;
  double solved = 1e-10;      ///< norm of the residual
  double difference = 1e-6;   ///< rad, m; step of the differences
  double independent = 1e-5;  ///< singular value of an equation that restricts variables
  double inside = 1e-6;       ///< margin of inequalities, for rounding
  int iterations = 25;        ///< of Gauss-Newton
  int halvings = 4;           ///< tries of each step, each half as long as the one before
  double beyond_time = 0.5;   ///< s beyond the bounds: so far the target's motion is known
};
constexpr EquationOptions kEquations;

double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

double beyond(double apart, const double lower, const double upper) {
  return std::abs(apart) - (upper - lower) / 2;
}

constexpr int kHandRows = 6, kRows = 15;
constexpr std::array<Vector3d reference::Impact::*, 3> kMomenta = {
    &reference::Impact::total, &reference::Impact::base, &reference::Impact::coupling};

bool has_hand_point(const CaptureProblem& problem) {
  return problem.hand.position || !problem.impulse.direction;
}

}  // namespace

bool reaches_every_angle(const CaptureProblem& problem, int k) {
  const Joint& joint = problem.robot.joints[k];
  // The angle itself counts: joints drag others along, or reach their stops in simulations.
  const std::vector<Coupling>& couplings = problem.robot.couplings;
  const auto drags = [k](const Coupling& c) { return c.joint == k && c.ratio != 1; };
  if (std::any_of(couplings.begin(), couplings.end(), drags)) return false;
  const auto is_moved = [k](const Coupling& c) { return c.joint == k; };
  if (std::count_if(couplings.begin(), couplings.end(), is_moved) > 1) return false;
  if (joint.type == JointType::Continuous) return true;
  if (simulates_turn(problem) || !problem.user.empty()) return false;
  const double room = joint.upper - joint.lower - 2 * problem.constraints.joint_limit_margin;
  return joint.type == JointType::Revolute && problem.variables.joints[k] && room >= 2 * kPi &&
         room < kInfinity;
}

FreeVariables::FreeVariables(const CaptureProblem& problem) : problem_(problem) {
  const VariableSpec& variables = problem.variables;
  std::vector<double> low, high;
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (!variables.joints[k]) continue;
    const bool wraps = reaches_every_angle(problem, k);
    const double middle = joint.type == JointType::Continuous ? 0 : (joint.lower + joint.upper) / 2;
    joints_.push_back(k);
    wraps_.push_back(wraps);
    low.push_back(wraps ? middle - kPi : joint.lower + margin);
    high.push_back(wraps ? middle + kPi : joint.upper - margin);
  }
  has_angle_ = variables.base_attitude == AttitudeFreedom::Axis;
  if (has_angle_) {
    const double most = std::min(variables.base_attitude_max, kPi);
    wraps_.push_back(most == kPi);
    low.push_back(-most);
    high.push_back(most);
  }
  if (variables.base_attitude == AttitudeFreedom::Cone ||
      variables.base_attitude == AttitudeFreedom::Free) {
    vector_ = static_cast<int>(low.size());
    wraps_.insert(wraps_.end(), 3, false);
    low.insert(low.end(), 3, -kPi);
    high.insert(high.end(), 3, kPi);
  }
  has_time_ = variables.contact_time_upper > variables.contact_time_lower;
  if (has_time_) {
    time_unit_ = (variables.contact_time_upper - variables.contact_time_lower) / (2 * kPi);
    wraps_.push_back(false);
    low.push_back(variables.contact_time_lower / time_unit_);
    high.push_back(variables.contact_time_upper / time_unit_);
  }
  lower = Eigen::Map<Eigen::VectorXd>(low.data(), static_cast<Eigen::Index>(low.size()));
  upper = Eigen::Map<Eigen::VectorXd>(high.data(), static_cast<Eigen::Index>(high.size()));
}

Eigen::VectorXd FreeVariables::sample(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = lower + u.cwiseProduct(upper - lower);
  if (vector_ < 0) return x;
  // Direction of an axis, evenly over a cap of the sphere, and the roll about it.
  const VariableSpec& variables = problem_.variables;
  const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
  const double least = is_cone ? std::cos(variables.base_attitude_max) : -1;
  const Vector3d& axis = variables.base_attitude_axis;
  const double tilt = std::acos(1 - u[vector_] * (1 - least)), side = 2 * kPi * u[vector_ + 1];
  const Vector3d across = axis.unitOrthogonal();
  const Vector3d about = std::cos(side) * across + std::sin(side) * axis.cross(across);
  const Eigen::AngleAxisd rotation(Eigen::AngleAxisd(tilt, about) *
                                   Eigen::AngleAxisd(2 * kPi * u[vector_ + 2] - kPi, axis));
  x.segment<3>(vector_) = rotation.angle() * rotation.axis();
  return x;
}

bool FreeVariables::is_attitude_allowed(const Vector3d& rotation) const {
  const VariableSpec& variables = problem_.variables;
  if (variables.base_attitude != AttitudeFreedom::Cone) {
    return rotation.norm() <= variables.base_attitude_max;
  }
  const Vector3d& axis = variables.base_attitude_axis;
  const Eigen::AngleAxisd about(rotation.norm(), rotation.stableNormalized());
  return axis.dot(about * axis) >= std::cos(variables.base_attitude_max);
}

Configuration FreeVariables::at(const Eigen::VectorXd& x) const {
  Configuration out;
  out.phi = problem_.start;
  out.base = problem_.base;
  out.contact_time = problem_.variables.contact_time_lower;
  Eigen::Index i = 0;
  for (const int k : joints_) out.phi[k] = x[i++];
  if (has_angle_) {
    const Eigen::AngleAxisd rotation(x[i++], problem_.variables.base_attitude_axis);
    out.base.orientation = rotation * problem_.base.orientation;
  }
  if (vector_ >= 0) {
    const Vector3d rotation = x.segment<3>(vector_);
    out.base.orientation =
        Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()) * problem_.base.orientation;
    i += 3;
  }
  if (has_time_) {
    // A Newton step may leave the bounds.
    const VariableSpec& variables = problem_.variables;
    out.contact_time =
        std::clamp(x[i] * time_unit_, variables.contact_time_lower - kEquations.beyond_time,
                   variables.contact_time_upper + kEquations.beyond_time);
  }
  return out;
}

Eigen::VectorXd FreeVariables::of(const Configuration& at) const {
  Eigen::VectorXd x(size());
  Eigen::Index i = 0;
  for (const int k : joints_) x[i++] = at.phi[k];
  if (has_angle_) x[i++] = base_angle(at);
  if (vector_ >= 0) {
    x.segment<3>(vector_) =
        rotation_log(at.base.orientation * problem_.base.orientation.conjugate());
    i += 3;
  }
  if (has_time_) x[i] = at.contact_time / time_unit_;
  return x;
}

Eigen::VectorXd FreeVariables::units() const {
  Eigen::VectorXd out = Eigen::VectorXd::Ones(size());
  if (has_time_) out[size() - 1] = time_unit_;
  return out;
}

double FreeVariables::base_angle(const Configuration& at) const {
  const Eigen::AngleAxisd rotation(at.base.orientation * problem_.base.orientation.conjugate());
  return rotation.angle() * rotation.axis().dot(problem_.variables.base_attitude_axis);
}

Eigen::VectorXd FreeVariables::middle_of(const JointBox& box) const {
  Eigen::VectorXd x = (lower + upper) / 2;
  Eigen::Index i = 0;
  for (const int k : joints_) x[i++] = (box.lower[k] + box.upper[k]) / 2;
  if (has_angle_ && box.base_angle) x[i] = (box.base_angle->lower + box.base_angle->upper) / 2;
  i += has_angle_;
  if (has_time_ && box.contact_time) {
    x[i] = (box.contact_time->lower + box.contact_time->upper) / 2 / time_unit_;
  }
  return x;
}

bool FreeVariables::holds(const JointBox& box, const Configuration& at) const {
  for (int k = 0; k < problem_.robot.n(); ++k) {
    double apart = at.phi[k] - (box.lower[k] + box.upper[k]) / 2;
    if (reaches_every_angle(problem_, k)) apart = wrapped(apart);
    if (!(beyond(apart, box.lower[k], box.upper[k]) <= kEquations.near)) return false;
  }
  if (has_angle_ != box.base_angle.has_value() || has_time_ != box.contact_time.has_value()) {
    return false;
  }
  if (has_angle_) {
    const Ends& ends = *box.base_angle;
    const double apart = wrapped(base_angle(at) - (ends.lower + ends.upper) / 2);
    if (!(beyond(apart, ends.lower, ends.upper) <= kEquations.near)) return false;
  }
  if (has_time_) {
    const Ends& ends = *box.contact_time;
    const double apart = at.contact_time - (ends.lower + ends.upper) / 2;
    if (!(beyond(apart, ends.lower, ends.upper) <= kEquations.near_time)) return false;
  }
  return true;
}

double FreeVariables::distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  double largest = 0;
  for (int i = 0; i < size(); ++i) {
    const double d = a[i] - b[i];
    largest = std::max(largest, std::abs(wraps_[i] ? wrapped(d) : d));
  }
  return largest;
}

bool FreeVariables::bring_inside(Eigen::VectorXd& x) const {
  bool is_inside = true;
  for (int i = 0; i < size(); ++i) {
    const double middle = (lower[i] + upper[i]) / 2;
    if (wraps_[i]) x[i] = middle + wrapped(x[i] - middle);
    if (vector_ >= 0 && i >= vector_ && i < vector_ + 3) continue;
    is_inside = is_inside && x[i] >= lower[i] && x[i] <= upper[i];
  }
  if (vector_ < 0) return is_inside;
  const Vector3d rotation = x.segment<3>(vector_);
  const double angle = rotation.norm();
  if (angle > kPi) x.segment<3>(vector_) = rotation * (wrapped(angle) / angle);
  return is_inside && is_attitude_allowed(x.segment<3>(vector_));
}

Vector6d hand_rows(const CaptureProblem& problem, const ContactEvent& event,
                   const Configuration& at, const reference::Dynamics& dynamics) {
  Vector6d rows = Vector6d::Zero();
  const HandSpec& hand = problem.hand;
  if (hand.constraint == HandConstraint::None) return rows;
  if (has_hand_point(problem) && problem.variables.base_position == PositionFreedom::Fixed) {
    Vector3d wanted;
    if (hand.position && hand.frame == Frame::Base) {
      wanted = *hand.position;
    } else {
      wanted = at.base.inverse() * (hand.position ? *hand.position : event.feature->point);
    }
    rows.head<3>() = dynamics.hand_position - wanted;
  }
  if (hand.constraint == HandConstraint::Axis) {
    rows.tail<3>() = event.n.cross(Vector3d(dynamics.hand_rotation * hand.approach_axis));
  } else if (const auto wanted = demanded_hand_axes(problem, event, at)) {
    const Matrix3d D = (at.base.orientation.conjugate() * *wanted).toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      rows.tail<3>() += dynamics.hand_rotation.col(i).cross(D.col(i)) / 2;
    }
  }
  return rows;
}

double hand_residual(const Situation& situation) {
  return hand_rows(situation.problem, situation.event, situation.at, situation.response.dynamics)
      .cwiseAbs()
      .maxCoeff();
}

int rank_of(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd sigma = singular_values(jacobian);
  return static_cast<int>((sigma.array() > kEquations.independent).count());
}

Equations::Equations(const CaptureProblem& problem, const FreeVariables& variables, Demand demand)
    : problem_(problem), variables_(variables) {
  if (demand != Demand::Hand) {
    auto momenta = vanishing_momenta(problem.constraints.impact_case).momenta;
    if (demand == Demand::Zero) {
      momenta.push_back(record_of(problem.objective.front().quantity).momentum);
    }
    for (std::size_t i = 0; i < kMomenta.size(); ++i) {
      vanishes_[i] = std::find(momenta.begin(), momenta.end(), kMomenta[i]) != momenta.end();
    }
  }
  if (problem.impulse.direction) return;
  const Configuration last{problem.start, problem.base, problem.variables.contact_time_upper};
  motion_ = target_motion(problem, last, Vector3d::Zero(), problem.variables.contact_time_lower);
}

ContactEvent Equations::event_at(const Configuration& at) const {
  return contact_event(problem_, motion_ ? &*motion_ : nullptr, at);
}

Eigen::VectorXd Equations::residual(const Eigen::VectorXd& x) const {
  const Configuration at = variables_.at(x);
  const ContactEvent event = event_at(at);
  PostureResponse response = posture_dynamics(problem_, at.phi);
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(kRows);
  rows.head<kHandRows>() = hand_rows(problem_, event, at, response.dynamics);
  if (std::find(vanishes_.begin(), vanishes_.end(), true) == vanishes_.end()) return rows;
  prepare_contact(problem_, event, at, response);
  const Vector6d unit = case_wrench(problem_, event, response);
  const reference::Impact impact = response.impact(unit);
  const double scale = response.momentum_scale(unit);
  for (std::size_t i = 0; i < kMomenta.size(); ++i) {
    if (!vanishes_[i]) continue;
    rows.segment<3>(kHandRows + 3 * static_cast<Eigen::Index>(i)) = impact.*kMomenta[i] / scale;
  }
  return rows;
}

Eigen::MatrixXd Equations::jacobian(const Eigen::VectorXd& x) const {
  const Eigen::Index n = x.size();
  Eigen::MatrixXd J(kRows, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd step = kEquations.difference * Eigen::VectorXd::Unit(n, i);
    J.col(i) = (residual(x + step) - residual(x - step)) / (2 * kEquations.difference);
  }
  return J;
}

std::optional<Eigen::VectorXd> Equations::solve(Eigen::VectorXd x) const {
  Eigen::VectorXd r = residual(x);
  for (int i = 0; i < kEquations.iterations; ++i) {
    if (r.norm() <= kEquations.solved) return x;
    const double threshold = Eigen::NumTraits<double>::epsilon() *
                             static_cast<double>(std::min<Eigen::Index>(kRows, x.size()));
    Eigen::VectorXd step = -least_norm_solution(jacobian(x), r, threshold);
    if (step.norm() > 1) step *= 1 / step.norm();
    bool better = false;
    for (int halved = 0; halved < kEquations.halvings && !better; ++halved, step /= 2) {
      const Eigen::VectorXd next = residual(x + step);
      if (!(next.norm() < r.norm())) continue;
      x += step;
      r = next;
      better = true;
      break;
    }
    if (!better) return std::nullopt;
  }
  return std::nullopt;
}

bool Equations::leads_to(const JointBox& box, const Configuration& at) const {
  if (variables_.holds(box, at)) return true;
  const Eigen::VectorXd x = variables_.of(at);
  const auto solved = solve(x);
  return solved && variables_.distance(*solved, x) <= kEquations.solved_nearby &&
         variables_.holds(box, variables_.at(*solved));
}

bool Equations::keeps_inequalities(const Configuration& at) const {
  const reference::Dynamics dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
  const ContactEvent event = event_at(at);
  const VariableSpec& variables = problem_.variables;
  const HandSpec& hand = problem_.hand;
  if (hand.constraint == HandConstraint::Axis &&
      event.n.dot(dynamics.hand_rotation * hand.approach_axis) > 0) {
    return false;
  }
  if (const auto wanted = demanded_hand_axes(problem_, event, at)) {
    const Matrix3d D = (at.base.orientation.conjugate() * *wanted).toRotationMatrix();
    if ((dynamics.hand_rotation.transpose() * D).trace() < 0) return false;
  }
  const bool time_is_free = variables.contact_time_upper > variables.contact_time_lower;
  if (event.feature && (time_is_free || problem_.impulse.source != ImpulseSource::Given) &&
      closing_speed(problem_, event, event.n) <
          problem_.constraints.closing_speed_min + kEquations.inside) {
    return false;
  }
  if (variables.base_position != PositionFreedom::Box || !has_hand_point(problem_)) return true;
  const Vector3d point = hand.position ? *hand.position : event.feature->point;
  const Vector3d station = point - at.base.orientation * Vector3d(dynamics.hand_position);
  return ((station - variables.base_position_lower).array() >= kEquations.inside).all() &&
         ((variables.base_position_upper - station).array() >= kEquations.inside).all();
}

bool Equations::keeps_margins(Configuration at) const {
  if (!demands_margins(problem_)) return true;
  const ContactEvent event = event_at(at);
  if (problem_.variables.base_position != PositionFreedom::Fixed && event.feature) {
    const auto dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
    at.base.position =
        event.feature->point - at.base.orientation * Vector3d(dynamics.hand_position);
  }
  return !(least_margin(Situation(problem_, at)) < kEquations.inside);
}

}  // namespace stillbase::audit
