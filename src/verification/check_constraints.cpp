// The list of constraints of a plan: values and bounds recomputed for every name that is known.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/clearance.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

/// Bounds are copied from the problem; those with a margin or a square are computed.
constexpr double kSameBound = 1e-12;

/// What a constraint of a plan should state.
struct KnownConstraint {
  double lower = 0, upper = 0;
  std::optional<double> value;  ///< empty: not recomputed, or part of a group
  std::string group;  ///< of components whose axes are arbitrary: only their norm is compared
};

struct Group {
  double norm = 0;
  double scale = 1;  ///< size that a difference of the norm is measured against
  double stated_squared = 0;
};

/// All constraints whose meaning is known by their name.
class KnownConstraints {
 public:
  explicit KnownConstraints(const Situation& situation)
      : situation_(situation),
        target_(situation.target_pose()),
        shapes_(situation.problem, situation.at, target_ ? &*target_ : nullptr) {
    add_base();
    add_hand();
    add_joints();
    add_case();
    const CaptureProblem& problem = situation.problem;
    const ConstraintSpec& wanted = problem.constraints;
    add("closing_speed", wanted.closing_speed_min, kInfinity,
        verification::closing_speed(problem, situation.event, situation.event.n));
    add("coupling_singular_value", wanted.coupling_singular_value_min, kInfinity,
        coupling_singular_value(situation.response));
    add("jacobian_singular_value", wanted.jacobian_singular_value_min, kInfinity,
        jacobian_singular_value(situation.response, wanted.jacobian_length));
  }

  std::optional<KnownConstraint> find(const std::string& name) const {
    // The name of a clearance starts with the numbers of its two shapes.
    if (const auto pair = clearance_numbers(name)) {
      return KnownConstraint{situation_.problem.constraints.clearance.value_or(-kInfinity),
                             kInfinity, shapes_.distance(pair->first, pair->second), ""};
    }
    const auto found = known_.find(name);
    return found == known_.end() ? std::nullopt : std::optional(found->second);
  }
  const Group& group(const std::string& name) const { return groups_.at(name); }

 private:
  void add(const std::string& name, double lower, double upper, std::optional<double> value) {
    known_[name] = {lower, upper, value, ""};
  }

  /// Equations <name><suffix> = 0 that are components of a vector of this norm.
  void add_group(const std::string& name, std::initializer_list<const char*> suffixes, double norm,
                 double scale) {
    groups_[name] = {norm, scale};
    for (const char* suffix : suffixes) known_[name + suffix] = {0, 0, std::nullopt, name};
  }

  std::optional<Vector3d> contact_point() const {
    if (situation_.problem.hand.position) return situation_.problem.hand.position;
    if (situation_.event.feature) return situation_.event.feature->point;
    return std::nullopt;
  }

  void add_base() {
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

  void add_hand() {
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
    add_group("hand_axis_", {"1", "2"}, (axis - n * n.dot(axis)).norm(), 1);
    add("hand_facing", -kInfinity, 0, n.dot(axis));
    if (hand.constraint != HandConstraint::Pose) return;
    std::optional<double> angle;
    if (const auto wanted =
            demanded_hand_axes(situation_.problem, situation_.event, situation_.at)) {
      angle = pose_error({{}, situation_.R_NH}, {{}, *wanted}).angle;
      add_group("hand_rotation_", {"x", "y", "z"}, std::sin(*angle), 1);
    }
    add("hand_facing", 0, kInfinity,
        angle ? std::optional(1 + 2 * std::cos(*angle)) : std::nullopt);
  }

  void add_joints() {
    const CaptureProblem& problem = situation_.problem;
    const auto rates = situation_.response.impact(situation_.impulse()).Delta_phidot;
    for (int k = 0; k < problem.robot.n(); ++k) {
      const Joint& joint = problem.robot.joints[k];
      const double rate = joint_rate_limit(problem, k);
      add("joint_rate_" + joint.name, -rate, rate, rates[k]);
      const double margin =
          joint.type == JointType::Continuous ? 0 : problem.constraints.joint_limit_margin;
      add("joint_limit_" + joint.name, joint.lower + margin, joint.upper - margin,
          situation_.at.phi(k));
    }
  }

  void add_case() {
    const PostureResponse& response = situation_.response;
    const Vector6d unit = unit_wrench(situation_.problem, situation_.event);
    const reference::Impact impact = response.impact(unit);
    const double scale = response.rounding_scale(unit);
    add_group("case_total_", {"1", "2", "3"}, impact.total.norm(), scale);
    add_group("case_base_", {"1", "2", "3"}, impact.base.norm(), scale);
    add_group("case_coupling_", {"1", "2", "3"}, impact.coupling.norm(), scale);
    const Eigen::MatrixXd& A = response.dynamics.Htilde_omegaphi;
    for (Eigen::Index k = 0; k < A.cols(); ++k) {
      const Vector3d column = A.col(k);
      add_group(fmt::format("case_coupling_column_{}", k + 1), {""},
                std::abs(column.dot(impact.coupling)), scale * column.norm());
    }
  }

  const Situation& situation_;
  std::optional<Pose> target_;
  ContactShapes shapes_;
  std::map<std::string, KnownConstraint> known_;
  std::map<std::string, Group> groups_;
};

double bound_difference(double stated, double wanted) {
  if (stated == wanted) return 0;  // infinities included
  return std::abs(stated - wanted) / (1 + std::abs(wanted));
}

void check_collision(const Context& context, ClaimList& claims) {
  Objections touching;
  const CollisionScene scene(context.problem);
  if (const auto pair = contact_collision(context.problem, scene, context.situation.at)) {
    touching.add(to_string(*pair));
  }
  claims.none_wrong("contact_collision", touching,
                    "bodies that touch at the contact, hand and target at the feature excepted");
}

}  // namespace

void check_constraints(const Context& context, ClaimList& claims) {
  const KnownConstraints known(context.situation);
  Largest violated, inconsistent, different, bounds;
  std::string unknown;
  const auto compare = [&](const std::string& name, double stated, double found, double scale) {
    different.take(std::abs(stated - found) / (std::abs(found) + scale), name);
  };
  std::map<std::string, Group> stated;
  for (const ConstraintValue& c : context.plan.constraints) {
    const double violation = std::max({c.lower - c.value, c.value - c.upper, 0.0});
    inconsistent.take(std::abs(violation - c.violation), c.name);
    violated.take(violation, c.name);
    const auto wanted = known.find(c.name);
    if (wanted) {
      bounds.take(std::max(bound_difference(c.lower, wanted->lower),
                           bound_difference(c.upper, wanted->upper)),
                  c.name);
    }
    if (wanted && wanted->value) {
      compare(c.name, c.value, *wanted->value, 1);
    } else if (wanted && !wanted->group.empty()) {
      Group& group = stated.emplace(wanted->group, known.group(wanted->group)).first->second;
      group.stated_squared += c.value * c.value;
    } else {
      unknown += " " + c.name;
    }
  }
  for (const auto& [name, group] : stated) {
    compare(name, std::sqrt(group.stated_squared), group.norm, group.scale);
  }
  claims.at_most(
      "constraint_values", different.value, context.options.recompute_tolerance, "1",
      fmt::format("largest difference of stated and recomputed value: {}; not recomputed:{}",
                  different.place, unknown.empty() ? " none" : unknown));
  claims.at_most("constraint_bounds", bounds.value, kSameBound, "1",
                 "stated bounds from those of the problem: " + bounds.place);
  claims.at_most("constraint_violation", violated.value, context.options.constraint_tolerance, "1",
                 "largest violation by the stated values: " + violated.place);
  claims.at_most("constraint_stated_violations", inconsistent.value, 1e-12, "1",
                 "stated violations from those of the stated values and bounds");
  check_margins(context.situation, context.options, claims);
  check_collision(context, claims);
}

}  // namespace stillbase::verification
