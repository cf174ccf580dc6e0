// The constraints whose meaning is known by their name, at one configuration, by `reference`.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "verification/checks.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {

/// What a constraint of a plan should state.
struct KnownConstraint {
  double lower = 0, upper = 0;
  std::optional<double> value;  ///< empty: not recomputed, or part of a group
  std::string group;  ///< of components whose axes are arbitrary: only their norm is compared
  bool is_always_listed = false;  ///< even where it never changes
};

/// Equations that are components of one vector along axes that nobody states.
struct ConstraintGroup {
  double norm = 0;
  double scale = 1;  ///< size that a difference of the norm is measured against
  /// In axes that do not move with the direction of the impulse; empty: one equation.
  Vector3d vector = Vector3d::Zero();
};

class KnownConstraints {
 public:
  /// @param situation must outlive this object
  explicit KnownConstraints(const Situation& situation);

  std::optional<KnownConstraint> find(const std::string& name) const;
  const ConstraintGroup& group(const std::string& name) const { return groups_.at(name); }

  /// Names of the constraints that the problem demands, without those of groups. A plan may leave
  /// out one that holds wherever the robot is.
  std::vector<std::string> demanded() const;
  /// Groups that the problem demands.
  std::vector<std::string> demanded_groups() const;

 private:
  void add(const std::string& name, double lower, double upper, std::optional<double> value,
           bool is_always_listed = false);
  void add_group(const std::string& name, std::initializer_list<const char*> suffixes,
                 const Vector3d& vector, double scale, const Vector3d& along);
  std::optional<Vector3d> contact_point() const;
  void add_base();
  void add_hand();
  void add_joints();
  void add_case();

  const Situation& situation_;
  std::optional<Pose> target_;
  ContactShapes shapes_;
  std::map<std::string, KnownConstraint> known_;
  std::map<std::string, ConstraintGroup> groups_;
};

}  // namespace stillbase::verification
