#include "verification/claim_list.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace stillbase {

std::string to_string(ClaimGroup group) {
  constexpr const char* kNames[] = {"inputs",        "physics", "constraints",  "approach",
                                    "after_contact", "audit",   "search_record"};
  return kNames[static_cast<std::size_t>(group)];
}

bool all_hold(const std::vector<Claim>& claims) {
  return std::none_of(claims.begin(), claims.end(), [](const Claim& c) { return c.fails(); }) &&
         std::any_of(claims.begin(), claims.end(), [](const Claim& c) { return c.pass; });
}

namespace verification {

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
  const Eigen::Quaterniond change = a.orientation.conjugate() * b.orientation;
  return {(a.position - b.position).norm(),
          2 * std::atan2(change.vec().norm(), std::abs(change.w()))};
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
  claims_.push_back({name, value, limit, unit, pass, detail, group_});
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

void ClaimList::none_wrong(const std::string& name, const Objections& objections,
                           const std::string& detail) {
  const std::string list = fmt::format("{}", fmt::join(objections.list(), "; "));
  add(name, static_cast<double>(objections.list().size()), 0, "1", objections.none(),
      objections.none() ? detail : detail + ": " + list);
}

void ClaimList::not_evaluated(const std::string& name, double limit, const std::string& unit,
                              const std::string& reason) {
  claims_.push_back({name, std::nullopt, limit, unit, false, "not evaluated: " + reason, group_});
}

void ClaimList::not_verified(const std::string& name, const std::string& reason) {
  claims_.push_back({name, std::nullopt, 0, "1", false, "not verified: " + reason, group_, false});
}

void ClaimList::run(const std::string& name, const StopCondition& stop,
                    const std::function<void()>& checks) {
  if (stop.reached()) return not_evaluated(name, 0, "1", "stopped before it");
  try {
    checks();
  } catch (const std::exception& error) {
    not_evaluated(name, 0, "1", error.what());
  }
}

Verification ClaimList::result(const StopCondition& stop) const {
  Verification out;
  out.claims = claims_;
  const bool is_stopped = stop.reached();
  bool is_cut = false;  // a check has no value for the stop
  for (Claim& claim : out.claims) {
    if (!is_stopped || claim.value || !claim.is_checked) continue;
    claim.is_checked = false;
    is_cut = true;
  }
  out.pass = all_hold(out.claims) && !is_cut;
  out.interrupted = !out.pass && is_stopped;
  return out;
}

}  // namespace verification
}  // namespace stillbase
