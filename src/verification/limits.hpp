// The limits that a problem sets on numbers of the contact, one record each.
//
// A new limit is one record in limits.cpp. From it follow what the list of constraints states,
// which limits it must state, their distances for the multipliers, and their checks.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// The formula of this room for a number with limits, written apart from the planner's.
struct LimitRecord {
  const char*
      name;  ///< of the constraint; of joints it ends with "_", and the joint's name follows
  const char* unit;  ///< of joints that slide "m/s" in place of "rad/s"
  bool is_of_joints = false;
  /// Listed even where it never changes.
  bool is_always_listed = false;
  /// Whether the problem has this limit; of joints: those whose range has an end.
  bool (*is_set)(const CaptureProblem&);
  Ends (*range)(const CaptureProblem&, int joint);
  /// One number, or one of each joint; empty: there is none.
  Eigen::VectorXd (*values)(const Situation&);
  /// Of a margin: its check and the words of that. Null: another check is about it.
  const char* check = nullptr;
  const char* words = "";
};

/// One limited number at one configuration.
struct ContactLimit {
  std::string name;
  std::string unit;
  std::string joint;  ///< empty: of none
  Ends range;
  double value;
  bool is_always_listed;

  /// Least distance from the ends of the range; negative beyond one.
  double room() const { return std::min(value - range.lower, range.upper - value); }
};

const std::vector<LimitRecord>& limit_records();

/// The numbers of a record, whether or not the problem limits them.
std::vector<ContactLimit> numbers_of(const LimitRecord& record, const Situation& situation);
/// Those that the problem limits.
std::vector<ContactLimit> limits_of(const LimitRecord& record, const Situation& situation);

}  // namespace stillbase::verification
