// Collecting checks, and the measures by which stated and recomputed numbers are compared.
#pragma once

#include <functional>

#include <Eigen/Core>

#include <stillbase/verification/verification.hpp>

namespace stillbase::verification {

/// Largest |stated_i - recomputed_i| / (|recomputed_i| + scale / 100), scale = |recomputed| or the
/// given one when that is larger. Infinite when sizes differ or a number is not finite.
double relative_error(const Eigen::VectorXd& stated, const Eigen::VectorXd& recomputed,
                      double scale = 0);
double relative_error(double stated, double recomputed, double scale = 0);

/// Distance of two poses: position, m, and angle, rad.
struct PoseError {
  double position = 0, angle = 0;
  double largest() const { return position > angle ? position : angle; }
};
PoseError pose_error(const Pose& a, const Pose& b);

/// Angle between two directions, rad; exact for small ones.
double angle_between(const Vector3d& a, const Vector3d& b);

/// A running maximum and where it was found; not a number once one was taken.
struct Largest {
  double value = 0;
  std::string place = "none";

  void take(double candidate, const std::string& at) {
    if (candidate <= value || value != value) return;
    value = candidate;
    place = at;
  }
};

/// What is wrong with something, in words.
class Objections {
 public:
  void demand(bool holds, const std::string& objection) {
    if (!holds) list_.push_back(objection);
  }
  void add(const std::string& objection) { list_.push_back(objection); }
  const std::vector<std::string>& list() const { return list_; }
  bool none() const { return list_.empty(); }

 private:
  std::vector<std::string> list_;
};

class ClaimList {
 public:
  /// @param group of the checks that follow
  void begin(ClaimGroup group) { group_ = group; }

  /// Passes when value <= limit. A value that is not finite counts as not evaluated.
  void at_most(const std::string& name, double value, double limit, const std::string& unit,
               const std::string& detail);
  /// Passes when value >= limit - slack.
  void at_least(const std::string& name, double value, double limit, double slack,
                const std::string& unit, const std::string& detail);
  /// Passes when stated and recomputed value agree: error is their relative difference.
  void same(const std::string& name, double error, double tolerance, const std::string& detail);
  /// Passes without objections: the value is their number, the limit 0.
  void none_wrong(const std::string& name, const Objections& objections, const std::string& detail);
  /// Fails: the check could not be carried out.
  void not_evaluated(const std::string& name, double limit, const std::string& unit,
                     const std::string& reason);
  /// Neither passes nor fails: the check is not possible, for a reason that is no fault of the
  /// plan.
  void not_verified(const std::string& name, const std::string& reason);
  /// Runs a set of checks, which count as not evaluated under `name` when they are stopped or
  /// throw.
  void run(const std::string& name, const StopCondition& stop, const std::function<void()>& checks);

  const std::vector<Claim>& claims() const { return claims_; }
  bool all_pass() const { return all_hold(claims_); }
  /// The checks as a result. After a stop those without a value count as not checked, and there is
  /// no verdict: a failure too may be due to the stop.
  Verification result(const StopCondition& stop) const;

 private:
  void add(const std::string& name, double value, double limit, const std::string& unit, bool pass,
           const std::string& detail);

  ClaimGroup group_ = ClaimGroup::Inputs;
  std::vector<Claim> claims_;
};

}  // namespace stillbase::verification
