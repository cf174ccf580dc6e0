#include <stillbase/io/verification_file.hpp>

#include <nlohmann/json.hpp>

#include "io/json.hpp"

namespace stillbase {

namespace {

using io::Json;
using io::number_json;

Json claim_json(const Claim& claim) {
  return {{"name", claim.name},
          {"value", claim.value ? number_json(*claim.value) : Json(nullptr)},
          {"limit", number_json(claim.limit)},
          {"unit", claim.unit},
          {"pass", claim.pass},
          {"detail", claim.detail}};
}

Json report_json(const ControllerReport& report) {
  return {{"controller", report.controller},
          {"finished", report.finished},
          {"horizon", number_json(report.horizon)},
          {"residual_base_rate", number_json(report.residual_base_rate)},
          {"peak_base_rate", number_json(report.peak_base_rate)},
          {"attitude_turned", number_json(report.attitude_turned)},
          {"peak_joint_rate", number_json(report.peak_joint_rate)},
          {"residual_joint_rate", number_json(report.residual_joint_rate)},
          {"peak_joint_torque", number_json(report.peak_joint_torque)},
          {"linear_momentum_drift", number_json(report.linear_momentum_drift)},
          {"angular_momentum_drift", number_json(report.angular_momentum_drift)},
          {"limits_met", report.limits_met},
          {"detail", report.detail}};
}

}  // namespace

std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256) {
  Json claims = Json::array(), controllers = Json::array();
  for (const Claim& claim : verification.claims) claims.push_back(claim_json(claim));
  for (const ControllerReport& report : verification.reports) {
    controllers.push_back(report_json(report));
  }
  return io::pretty({{"format", "stillbase.verification"},
                     {"version", 1},
                     {"content_sha256", content_sha256},
                     {"verdict", verification.pass ? "pass" : "fail"},
                     {"claims", claims},
                     {"controllers", controllers}});
}

}  // namespace stillbase
