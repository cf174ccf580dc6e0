#include "verification/known_constraints.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "verification/limits.hpp"

namespace stillbase::verification {

KnownConstraints::KnownConstraints(const Situation& situation)
    : situation_(situation),
      target_(situation.target_pose()),
      shapes_(situation.problem, situation.at, target_ ? &*target_ : nullptr) {
  add_base();
  add_hand();
  add_joints();
  add_case();
  for (const LimitRecord& record : limit_records()) {
    for (const ContactLimit& limit : numbers_of(record, situation)) {
      add(limit.name, limit.range.lower, limit.range.upper, limit.value, limit.is_always_listed);
    }
  }
}

std::optional<KnownConstraint> KnownConstraints::find(const std::string& name) const {
  // The name of a clearance starts with the numbers of its two shapes.
  if (const auto pair = clearance_numbers(name)) {
    return KnownConstraint{situation_.problem.constraints.clearance.value_or(-kInfinity), kInfinity,
                           shapes_.distance(pair->first, pair->second), "", false};
  }
  const auto found = known_.find(name);
  return found == known_.end() ? std::nullopt : std::optional(found->second);
}

void KnownConstraints::add(const std::string& name, double lower, double upper,
                           std::optional<double> value, bool is_always_listed) {
  known_[name] = {lower, upper, value, "", is_always_listed};
}

/// Equations <name><suffix> = 0 that are components of a vector in B.
/// @param along direction with which the components' axes turn
void KnownConstraints::add_group(const std::string& name,
                                 std::initializer_list<const char*> suffixes,
                                 const Vector3d& vector, double scale, const Vector3d& along) {
  groups_[name] = {vector.norm(), scale, rotation_between(along, Vector3d::UnitX()) * vector};
  for (const char* suffix : suffixes) known_[name + suffix] = {0, 0, std::nullopt, name, false};
}

std::optional<Vector3d> KnownConstraints::contact_point() const {
  if (situation_.problem.hand.position) return situation_.problem.hand.position;
  if (situation_.event.feature) return situation_.event.feature->point;
  return std::nullopt;
}

void KnownConstraints::add_base() {
  const CaptureProblem& problem = situation_.problem;
  const VariableSpec& free = problem.variables;
  const Pose& base = situation_.at.base;
  const auto point = contact_point();
  const Vector3d station =
      point ? Vector3d(*point - (situation_.hand_N - base.position)) : base.position;
  for (int i = 0; i < 3; ++i) {
    add(fmt::format("base_position_{}", "xyz"[i]), free.base_position_lower[i],
        free.base_position_upper[i], station[i]);
  }
  const Eigen::Quaterniond stated = problem.base.orientation.conjugate();
  add("base_attitude_squared", 0, free.base_attitude_max * free.base_attitude_max,
      rotation_log(stated * base.orientation).squaredNorm());
  const Vector3d& axis = free.base_attitude_axis;
  add("base_attitude_cone", std::cos(free.base_attitude_max), kInfinity,
      axis.dot(base.orientation * (stated * axis)));
}

void KnownConstraints::add_hand() {
  const HandSpec& hand = situation_.problem.hand;
  const reference::Dynamics& dynamics = situation_.response.dynamics;
  const auto point = contact_point();
  for (int i = 0; i < 3; ++i) {
    std::optional<double> offset;
    if (hand.position && hand.frame == Frame::Base) {
      offset = dynamics.hand_position[i] - (*hand.position)[i];
    } else if (point) {
      offset = situation_.hand_N[i] - (*point)[i];
    }
    add(fmt::format("hand_position_{}", "xyz"[i]), 0, 0, offset);
  }
  const Vector3d& n = situation_.event.n;
  const Vector3d axis = dynamics.hand_rotation * hand.approach_axis;
  add_group("hand_axis_", {"1", "2"}, axis - n * n.dot(axis), 1, n);
  add("hand_facing", -kInfinity, 0, n.dot(axis));
  if (hand.constraint != HandConstraint::Pose) return;
  std::optional<double> angle;
  if (const auto wanted = demanded_hand_axes(situation_.problem, situation_.event, situation_.at)) {
    angle = pose_error({{}, situation_.R_NH}, {{}, *wanted}).angle;
    const Eigen::Quaterniond rotation = situation_.R_NH.conjugate() * *wanted;
    const Vector3d about = rotation_log(rotation).stableNormalized();
    add_group("hand_rotation_", {"x", "y", "z"}, std::sin(*angle) * about, 1, n);
  }
  add("hand_facing", 0, kInfinity, angle ? std::optional(1 + 2 * std::cos(*angle)) : std::nullopt);
}

void KnownConstraints::add_joints() {
  const CaptureProblem& problem = situation_.problem;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    const double margin =
        joint.type == JointType::Continuous ? 0 : problem.constraints.joint_limit_margin;
    add("joint_limit_" + joint.name, joint.lower + margin, joint.upper - margin,
        situation_.at.phi(k), true);
  }
}

void KnownConstraints::add_case() {
  const PostureResponse& response = situation_.response;
  const Vector6d unit = case_wrench(situation_.problem, situation_.event, response);
  const reference::Impact impact = response.impact(unit);
  const double scale = response.rounding_scale(unit);
  // The moment of a force alone is normal to it: two components, whichever way the force turns.
  const Vector3d f = unit.head<3>();
  const bool is_force = unit.tail<3>().isZero(0) && !f.isZero(0);
  const Vector3d along = is_force ? Vector3d(f.normalized()) : situation_.event.n;
  add_group("case_total_", {"1", "2", "3"}, impact.total, scale, along);
  add_group("case_base_", {"1", "2", "3"}, impact.base, scale, along);
  add_group("case_coupling_", {"1", "2", "3"}, impact.coupling, scale, along);
  const Eigen::MatrixXd& A = response.dynamics.Htilde_omegaphi;
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    const Vector3d column = A.col(k);
    add_group(fmt::format("case_coupling_column_{}", k + 1), {""},
              column.dot(impact.coupling) * Vector3d::UnitX(), scale * column.norm(), along);
  }
}

std::vector<std::string> KnownConstraints::demanded() const {
  const CaptureProblem& problem = situation_.problem;
  const VariableSpec& free = problem.variables;
  const HandConstraint hand = problem.hand.constraint;
  const bool follows_target = !problem.impulse.direction;
  const bool has_point = problem.hand.position || follows_target;
  std::vector<std::string> out;
  for (const char axis : {'x', 'y', 'z'}) {
    if (has_point && hand != HandConstraint::None && free.base_position == PositionFreedom::Fixed) {
      out.push_back(fmt::format("hand_position_{}", axis));
    }
    if (has_point && free.base_position == PositionFreedom::Box) {
      out.push_back(fmt::format("base_position_{}", axis));
    }
  }
  if (hand == HandConstraint::Axis || hand == HandConstraint::Pose) out.push_back("hand_facing");
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (!free.joints[k] || joint.type == JointType::Continuous) continue;
    out.push_back("joint_limit_" + joint.name);
  }
  for (const LimitRecord& record : limit_records()) {
    for (const ContactLimit& limit : limits_of(record, situation_)) out.push_back(limit.name);
  }
  if (free.base_attitude == AttitudeFreedom::Cone) out.push_back("base_attitude_cone");
  if (free.base_attitude == AttitudeFreedom::Free && free.base_attitude_max < kEveryAttitude) {
    out.push_back("base_attitude_squared");
  }
  for (int i = 1; problem.constraints.clearance && i <= shapes_.count(); ++i) {
    for (int j = i + 1; j <= shapes_.count(); ++j) {
      if (!shapes_.must_be_apart(i, j) || !shapes_.distance(i, j)) continue;
      out.push_back(fmt::format("clearance_{}_{}_{}_{}", i, j, shapes_.name(i), shapes_.name(j)));
    }
  }
  return out;
}

std::vector<std::string> KnownConstraints::demanded_groups() const {
  std::vector<std::string> out;
  const HandConstraint hand = situation_.problem.hand.constraint;
  if (hand == HandConstraint::Axis) out.push_back("hand_axis_");
  if (hand == HandConstraint::Pose) out.push_back("hand_rotation_");
  switch (situation_.problem.constraints.impact_case) {
    case CaseConstraint::C2:
      out.push_back("case_coupling_");
      [[fallthrough]];
    case CaseConstraint::C:
    case CaseConstraint::C1:
      out.push_back("case_total_");
      break;
    case CaseConstraint::G2:
      out.push_back("case_base_");
      break;
    case CaseConstraint::G3:
      out.push_back("case_coupling_");
      break;
    case CaseConstraint::None:
      break;
  }
  return out;
}

}  // namespace stillbase::verification
