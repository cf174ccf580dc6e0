#include "audit/equations.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/margins.hpp"

namespace stillbase::audit {
namespace {

constexpr double kSolved = 1e-10;      ///< norm of the residual
constexpr double kDifference = 1e-6;   ///< rad, m; step of the differences
constexpr double kIndependent = 1e-5;  ///< singular value of an equation that restricts variables
constexpr double kInside = 1e-6;       ///< margin of inequalities
constexpr int kIterations = 25;
constexpr int kHandRows = 6, kRows = 15;
constexpr Vector3d reference::Impact::*kMomenta[] = {
    &reference::Impact::total, &reference::Impact::base, &reference::Impact::coupling};

bool has_hand_point(const CaptureProblem& problem) {
  return problem.hand.position || !problem.impulse.direction;
}

bool is_short(const std::optional<double>& value, double least) {
  return value && *value < least + kInside;
}

}  // namespace

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
  return static_cast<int>((sigma.array() > kIndependent).count());
}

Equations::Equations(const CaptureProblem& problem, const FreeVariables& variables, Demand demand)
    : problem_(problem), variables_(variables) {
  if (demand != Demand::Hand) {
    auto momenta = vanishing_momenta(problem.constraints.impact_case).momenta;
    if (demand == Demand::Zero) {
      momenta.push_back(record_of(problem.objective.front().quantity).momentum);
    }
    for (std::size_t i = 0; i < vanishes_.size(); ++i) {
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
  const PostureResponse response = posture_dynamics(problem_, at.phi);
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(kRows);
  rows.head<kHandRows>() = hand_rows(problem_, event, at, response.dynamics);
  if (std::find(vanishes_.begin(), vanishes_.end(), true) == vanishes_.end()) return rows;
  const Vector6d unit = unit_wrench(problem_, event);
  const reference::Impact impact = response.impact(unit);
  const double scale = response.momentum_scale(unit);
  for (std::size_t i = 0; i < vanishes_.size(); ++i) {
    if (!vanishes_[i]) continue;
    rows.segment<3>(kHandRows + 3 * static_cast<Eigen::Index>(i)) = impact.*kMomenta[i] / scale;
  }
  return rows;
}

Eigen::MatrixXd Equations::jacobian(const Eigen::VectorXd& x) const {
  const Eigen::Index n = x.size();
  Eigen::MatrixXd J(kRows, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(n, i);
    J.col(i) = (residual(x + step) - residual(x - step)) / (2 * kDifference);
  }
  return J;
}

std::optional<Eigen::VectorXd> Equations::solve(Eigen::VectorXd x) const {
  Eigen::VectorXd r = residual(x);
  for (int i = 0; i < kIterations; ++i) {
    if (r.norm() <= kSolved) return x;
    const double threshold = Eigen::NumTraits<double>::epsilon() *
                             static_cast<double>(std::min<Eigen::Index>(kRows, x.size()));
    Eigen::VectorXd step = -least_norm_solution(jacobian(x), r, threshold);
    if (step.norm() > 1) step *= 1 / step.norm();
    bool better = false;
    for (int halved = 0; halved < 4 && !better; ++halved, step /= 2) {
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
      is_short(closing_speed(problem_, event, event.n), problem_.constraints.closing_speed_min)) {
    return false;
  }
  if (variables.base_position != PositionFreedom::Box || !has_hand_point(problem_)) return true;
  const Vector3d point = hand.position ? *hand.position : event.feature->point;
  const Vector3d station = point - at.base.orientation * Vector3d(dynamics.hand_position);
  return ((station - variables.base_position_lower).array() >= kInside).all() &&
         ((variables.base_position_upper - station).array() >= kInside).all();
}

bool Equations::keeps_margins(Configuration at) const {
  const ConstraintSpec& wanted = problem_.constraints;
  const bool has_rates = wanted.joint_rate_scale || wanted.joint_rate_max.size() > 0;
  if (!has_rates && !(wanted.coupling_singular_value_min > 0) &&
      !(wanted.jacobian_singular_value_min > 0) && !wanted.clearance) {
    return true;
  }
  const ContactEvent event = event_at(at);
  if (problem_.variables.base_position != PositionFreedom::Fixed && event.feature) {
    const auto dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
    at.base.position =
        event.feature->point - at.base.orientation * Vector3d(dynamics.hand_position);
  }
  const MarginNumbers found = margin_numbers(Situation(problem_, at));
  return !(found.rate_excess > -kInside) &&
         !is_short(found.coupling, wanted.coupling_singular_value_min) &&
         !is_short(found.jacobian, wanted.jacobian_singular_value_min) &&
         !(wanted.clearance && (is_short(found.distance, *wanted.clearance) ||
                                is_short(neighbours_distance(problem_, at), *wanted.clearance)));
}

}  // namespace stillbase::audit
