// The list of constraints of a plan: values recomputed where the name says what they are.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

// Components whose axes are a matter of choice are compared by the norm over their group.
struct Group {
  double stated_squared = 0;
  double found = 0;  // norm
  double scale = 1;  // size that a difference is measured against
};

bool begins_with(const std::string& name, const std::string& prefix) {
  return name.compare(0, prefix.size(), prefix) == 0;
}

// Number of the axis in names that end in x, y, z; -1 otherwise.
int axis_of(const std::string& name) {
  const char last = name.empty() ? ' ' : name.back();
  return last == 'x' || last == 'y' || last == 'z' ? last - 'x' : -1;
}

class Recomputation {
 public:
  Recomputation(const Context& context, const ContactEvent& event, const PostureResponse& response)
      : context_(context),
        event_(event),
        response_(response),
        target_(context.motion == nullptr
                    ? std::nullopt
                    : std::optional(
                          context.motion->state(context.plan.configuration.contact_time).pose)),
        shapes_(context.problem, context.plan.configuration, target_ ? &*target_ : nullptr) {
    const ImpulseSpec& impulse = context.problem.impulse;
    Vector6d unit;  // wrench per unit of impulse
    unit << event.n, event.moment;
    if (impulse.source == ImpulseSource::Given) unit.tail<3>() /= impulse.magnitude;
    impact_ = response.impact(unit);
    scale_ = response.rounding_scale(unit);
    rates_ = response.impact(impulse_along(context.problem, event, response, event.n)).Delta_phidot;
    const Pose& base = context.plan.configuration.base;
    R_NB_ = base.orientation.toRotationMatrix();
    hand_N_ = base * Vector3d(response.dynamics.hand_position);
    if (const auto wanted = wanted_hand_axes(context.problem, event, context.plan.configuration)) {
      const Pose hand{
          {}, base.orientation * Eigen::Quaterniond(Matrix3d(response.dynamics.hand_rotation))};
      hand_error_ = pose_error(hand, {{}, *wanted}).angle;
    }
  }

  /// The value of a constraint with a meaning of its own; empty for one that is part of a group.
  std::optional<double> value(const std::string& name) const {
    const CaptureProblem& problem = context_.problem;
    const Pose& base = context_.plan.configuration.base;
    const int axis = axis_of(name);
    if (begins_with(name, "hand_position_") && axis >= 0) {
      if (problem.hand.position && problem.hand.frame == Frame::Base) {
        return (response_.dynamics.hand_position - *problem.hand.position)[axis];
      }
      if (const auto point = contact_point()) return (hand_N_ - *point)[axis];
    }
    if (begins_with(name, "base_position_") && axis >= 0) {
      if (const auto point = contact_point()) {
        return (*point - R_NB_ * response_.dynamics.hand_position)[axis];
      }
      return base.position[axis];
    }
    if (name == "closing_speed") return closing_speed(problem, event_, event_.n);
    if (name == "base_attitude_squared") {
      return rotation_log(problem.base.orientation.conjugate() * base.orientation).squaredNorm();
    }
    if (begins_with(name, "joint_limit_")) {
      for (int k = 0; k < problem.robot.n(); ++k) {
        if (problem.robot.joints[k].name == name.substr(12)) {
          return context_.plan.configuration.phi(k);
        }
      }
    }
    if (name == "base_attitude_cone") {
      const Vector3d& direction = problem.variables.base_attitude_axis;
      return direction.dot(base.orientation * (problem.base.orientation.conjugate() * direction));
    }
    if (begins_with(name, "joint_rate_")) {
      const int k = find_joint(problem.robot, name.substr(11));
      return k < 0 ? std::nullopt : std::optional(rates_[k]);
    }
    if (name == "coupling_singular_value") return coupling_singular_value(response_);
    if (name == "jacobian_singular_value") {
      return jacobian_singular_value(response_, problem.constraints.jacobian_length);
    }
    if (const auto pair = clearance_numbers(name)) {
      return shapes_.distance(pair->first, pair->second);
    }
    if (name == "hand_facing" && hand_error_) return 1 + 2 * std::cos(*hand_error_);
    if (name == "hand_facing" && problem.hand.constraint == HandConstraint::Axis) {
      return event_.n.dot(response_.dynamics.hand_rotation * problem.hand.approach_axis);
    }
    return std::nullopt;
  }

  /// The group that a name belongs to and what is found for it; empty for an unknown name.
  std::optional<std::pair<std::string, Group>> group(const std::string& name) const {
    if (begins_with(name, "case_coupling_column_")) {
      const int column = std::atoi(name.c_str() + 21) - 1;
      const auto& A = response_.dynamics.Htilde_omegaphi;
      if (column < 0 || column >= A.cols()) return std::nullopt;
      const Vector3d a = A.col(column);
      return std::pair{name, Group{0, std::abs(a.dot(impact_.coupling)), scale_ * a.norm()}};
    }
    if (begins_with(name, "case_total_")) {
      return std::pair{"case_total", Group{0, impact_.total.norm(), scale_}};
    }
    if (begins_with(name, "case_base_")) {
      return std::pair{"case_base", Group{0, impact_.base.norm(), scale_}};
    }
    if (begins_with(name, "case_coupling_")) {
      return std::pair{"case_coupling", Group{0, impact_.coupling.norm(), scale_}};
    }
    if (begins_with(name, "hand_rotation_") && hand_error_) {
      return std::pair{"hand_rotation", Group{0, std::sin(*hand_error_), 1}};
    }
    if (name == "hand_axis_1" || name == "hand_axis_2") {
      const Vector3d axis = response_.dynamics.hand_rotation * context_.problem.hand.approach_axis;
      return std::pair{"hand_axis", Group{0, (axis - event_.n * event_.n.dot(axis)).norm(), 1}};
    }
    return std::nullopt;
  }

 private:
  std::optional<Vector3d> contact_point() const {
    if (context_.problem.hand.position) return context_.problem.hand.position;
    if (event_.feature) return event_.feature->point;
    return std::nullopt;
  }

  const Context& context_;
  const ContactEvent& event_;
  const PostureResponse& response_;
  std::optional<Pose> target_;
  ContactShapes shapes_;
  reference::Impact impact_;
  Eigen::VectorXd rates_;  // of the joints after the impact
  double scale_ = 1;
  Matrix3d R_NB_;
  Vector3d hand_N_;
  std::optional<double> hand_error_;  // angle from the wanted axes, rad
};

}  // namespace

void check_constraints(const Context& context, const ContactEvent& event,
                       const PostureResponse& response, ClaimList& claims) {
  const Plan& plan = context.plan;
  const double allowed = context.options.constraint_tolerance;
  const Recomputation recomputation(context, event, response);
  double largest = 0, inconsistent = 0, difference = 0;
  std::string broken = "none", unknown, different;
  std::map<std::string, Group> groups;
  auto compare = [&](const std::string& name, double stated, double found, double scale) {
    const double error = std::abs(stated - found) / (std::abs(found) + scale);
    if (error > difference) {
      difference = error;
      different = name;
    }
  };
  for (const ConstraintValue& c : plan.constraints) {
    const double violation = std::max({c.lower - c.value, c.value - c.upper, 0.0});
    inconsistent = std::max(inconsistent, std::abs(violation - c.violation));
    if (violation > largest) {
      largest = violation;
      broken = c.name;
    }
    if (const auto value = recomputation.value(c.name)) {
      compare(c.name, c.value, *value, 1);
    } else if (auto group = recomputation.group(c.name)) {
      const auto at = groups.insert(*group).first;
      at->second.stated_squared += c.value * c.value;
    } else {
      unknown += " " + c.name;
    }
  }
  for (const auto& [name, group] : groups) {
    compare(name, std::sqrt(group.stated_squared), group.found, group.scale);
  }
  claims.at_most(
      "constraint_values", difference, context.options.recompute_tolerance, "1",
      fmt::format("largest difference of stated and recomputed value: {}; not "
                  "recomputed:{}",
                  different.empty() ? "none" : different, unknown.empty() ? " none" : unknown));
  claims.at_most("constraint_violation", largest, allowed, "1",
                 "largest violation by the stated values: " + broken);
  claims.at_most("constraint_stated_violations", inconsistent, 1e-12, "1",
                 "stated violations from those of the stated values and bounds");
  check_margins(context, event, response, claims);
  claims.at_most("certificate_violation", std::abs(plan.certificate.max_violation - largest), 1e-12,
                 "1", "largest violation of the certificate from that of the list");
}

}  // namespace stillbase::verification
