// Collecting claims, and the measures by which stated and recomputed numbers are compared.
#pragma once

#include <Eigen/Dense>

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

class ClaimList {
 public:
  /// Passes when value <= limit. A value that is not finite counts as not evaluated.
  void at_most(const std::string& name, double value, double limit, const std::string& unit,
               const std::string& detail);
  /// Passes when value >= limit - slack.
  void at_least(const std::string& name, double value, double limit, double slack,
                const std::string& unit, const std::string& detail);
  /// Passes when both are the same within the relative tolerance.
  void same(const std::string& name, double error, double tolerance, const std::string& detail);
  /// A yes or no: value is the number of objections, limit 0.
  void none_wrong(const std::string& name, const std::vector<std::string>& objections,
                  const std::string& detail);
  void not_evaluated(const std::string& name, double limit, const std::string& unit,
                     const std::string& reason);

  const std::vector<Claim>& claims() const { return claims_; }
  bool all_pass() const;

 private:
  void add(const std::string& name, double value, double limit, const std::string& unit, bool pass,
           const std::string& detail);
  std::vector<Claim> claims_;
};

}  // namespace stillbase::verification
