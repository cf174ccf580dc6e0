#include "verification/claim_list.hpp"

#include <cmath>

namespace stillbase::verification {

double relative_error(const Eigen::VectorXd& stated, const Eigen::VectorXd& recomputed,
                      double scale) {
  if (stated.size() != recomputed.size() || !stated.allFinite() || !recomputed.allFinite()) {
    return kInfinity;
  }
  const double floor = 0.01 * std::max(scale, recomputed.norm());
  double worst = 0;
  for (Eigen::Index i = 0; i < stated.size(); ++i) {
    const double difference = std::abs(stated(i) - recomputed(i));
    if (difference > 0) worst = std::max(worst, difference / (std::abs(recomputed(i)) + floor));
  }
  return worst;
}

double relative_error(double stated, double recomputed, double scale) {
  return relative_error(Eigen::VectorXd::Constant(1, stated),
                        Eigen::VectorXd::Constant(1, recomputed), scale);
}

PoseError pose_error(const Pose& a, const Pose& b) {
  // Twice the vector part of the relative rotation: exact where the logarithm loses digits.
  const Eigen::Quaterniond turn = a.orientation.conjugate() * b.orientation;
  return {(a.position - b.position).norm(), 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()))};
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

void ClaimList::add(const std::string& name, double value, double limit, const std::string& unit,
                    bool pass, const std::string& detail) {
  if (!std::isfinite(value)) {
    not_evaluated(name, limit, unit, "not a finite number: " + detail);
    return;
  }
  claims_.push_back({name, value, limit, unit, pass, detail});
}

void ClaimList::at_most(const std::string& name, double value, double limit,
                        const std::string& unit, const std::string& detail) {
  add(name, value, limit, unit, value <= limit, detail);
}

void ClaimList::at_least(const std::string& name, double value, double limit, double slack,
                         const std::string& unit, const std::string& detail) {
  add(name, value, limit, unit, value >= limit - slack, "at least: " + detail);
}

void ClaimList::same(const std::string& name, double error, double tolerance,
                     const std::string& detail) {
  add(name, error, tolerance, "1", error <= tolerance,
      detail + ", relative difference of stated and recomputed value");
}

void ClaimList::none_wrong(const std::string& name, const std::vector<std::string>& objections,
                           const std::string& detail) {
  std::string text = detail;
  for (std::size_t i = 0; i < objections.size(); ++i)
    text += (i == 0 ? ": " : "; ") + objections[i];
  add(name, static_cast<double>(objections.size()), 0, "1", objections.empty(), text);
}

void ClaimList::not_evaluated(const std::string& name, double limit, const std::string& unit,
                              const std::string& reason) {
  claims_.push_back({name, std::nullopt, limit, unit, false, "not evaluated: " + reason});
}

bool ClaimList::all_pass() const {
  for (const Claim& claim : claims_) {
    if (!claim.pass) return false;
  }
  return !claims_.empty();
}

}  // namespace stillbase::verification
