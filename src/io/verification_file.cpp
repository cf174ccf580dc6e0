#include <cmath>

#include <stillbase/io/verification_file.hpp>

#include "io/json_trials.hpp"

namespace stillbase {

namespace {

using io::Json;

/// Numbers that an unfinished simulation does not have are null.
Json open_json(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json claim_json(const Claim& claim) {
  return {{"group", to_string(claim.group)},
          {"name", claim.name},
          {"value", claim.value ? *claim.value : Json(nullptr)},
          {"limit", claim.limit},
          {"unit", claim.unit},
          {"pass", claim.is_checked ? Json(claim.pass) : Json(nullptr)},
          {"detail", claim.detail}};
}

Json report_json(const ControllerReport& report) {
  return {{"controller", report.controller},
          {"finished", report.finished},
          {"horizon", open_json(report.horizon)},
          {"residual_base_rate", open_json(report.residual_base_rate)},
          {"peak_base_rate", open_json(report.peak_base_rate)},
          {"attitude_turned", open_json(report.attitude_turned)},
          {"peak_joint_rate", open_json(report.peak_joint_rate)},
          {"residual_joint_rate", open_json(report.residual_joint_rate)},
          {"peak_joint_torque", open_json(report.peak_joint_torque)},
          {"linear_momentum_drift", open_json(report.linear_momentum_drift)},
          {"angular_momentum_drift", open_json(report.angular_momentum_drift)},
          {"limits_met", report.limits_met},
          {"detail", report.detail}};
}

}  // namespace

std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256,
                                 const std::pair<TrialSetting, TrialReport>* trials) {
  Json json;
  json["format"] = "stillbase.verification";
  json["version"] = 1;
  json["content_sha256"] = content_sha256;
  json["verdict"] = verification.pass ? "pass" : "fail";
  if (verification.interrupted) json["interrupted"] = true;  // no verdict on the plan
  json["claims"] = Json::array();
  for (const Claim& claim : verification.claims) json["claims"].push_back(claim_json(claim));
  json["post_impact"] = Json::array();
  for (const ControllerReport& report : verification.reports) {
    json["post_impact"].push_back(report_json(report));
  }
  if (trials != nullptr) json["trials"] = io::trials_json(trials->first, trials->second);
  return io::pretty(json);
}

}  // namespace stillbase
