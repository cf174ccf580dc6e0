// Verification files, and trials.
#include <cmath>
#include <map>

#include <stillbase/core/error.hpp>
#include <stillbase/simulation/controllers.hpp>

#include "io/fields/results.hpp"
#include "io/fields/sections.hpp"

namespace stillbase {

namespace io {

namespace {

constexpr Range kProbability{.lower = 0, .upper = 1};

}  // namespace

static void fields(Table& t, Claim& claim) {
  t("group", Word(claim.group, names_up_to(ClaimGroup::SearchRecord)), "what the check is about",
    kNeeded);
  t("name", Text(claim.name), "of the check", kNeeded);
  t("value", OrNull(Number(claim.value), !claim.value), "null: could not be evaluated", kNeeded);
  t("limit", Number(claim.limit), "what the value is held against", kNeeded);
  t("unit", Text(claim.unit), "of value and limit", kNeeded);
  t("pass", OrNull(Flag(claim.pass), !claim.is_checked),
    "null: could not be checked, for the reason in detail", kNeeded);
  t("detail", Text(claim.detail), "what was compared, or why it could not be evaluated", kNeeded);
}

static void fields(Table& t, ControllerReport& report) {
  const auto open = [&t](const char* key, double& x, const char* text, const char* unit) {
    t(key, OrNull(Number(x), !std::isfinite(x)), text, needed(unit));
  };
  t("controller", Text(report.controller, controller_names(), "controllers"), "", kNeeded);
  t("finished", Flag(report.finished), "the simulation reached the horizon", kNeeded);
  open("horizon", report.horizon, "after the impact", "s");
  open("residual_base_rate", report.residual_base_rate, "at the horizon", "rad/s");
  open("peak_base_rate", report.peak_base_rate, "", "rad/s");
  open("attitude_turned", report.attitude_turned, "largest attitude change", "rad");
  open("peak_joint_rate", report.peak_joint_rate, "of the fastest joint", "rad/s (m/s)");
  open("residual_joint_rate", report.residual_joint_rate, "norm at the horizon", "rad/s");
  open("peak_joint_torque", report.peak_joint_torque, "within the torque limits", "N m (N)");
  open("peak_demanded_torque", report.peak_demanded_torque, "that the controller asks for",
       "N m (N)");
  open("linear_momentum_drift", report.linear_momentum_drift, "relative", "1");
  open("angular_momentum_drift", report.angular_momentum_drift, "relative", "1");
  t("limits_met", Texts(report.limits_met), "limits of joints and actuators that were reached",
    kNeeded);
  t("detail", Text(report.detail), "why it did not finish", kNeeded);
}

static void fields(Table& t, Perturbations& sizes) {
  const auto size = [&t](const char* key, double& x, const char* unit) {
    t(key, Number(x, kNonNegative), "", needed(unit));
  };
  size("cone_half_angle", sizes.cone_half_angle, "rad");
  size("closing_speed", sizes.closing_speed, "1");
  t("closing_speed_error", Number(sizes.closing_speed_error, kNonNegative),
    "where it is not 0, in place of closing_speed", needed("m/s"));
  size("restitution", sizes.restitution, "1");
  size("target_mass", sizes.target_mass, "1");
  size("target_inertia", sizes.target_inertia, "1");
  size("contact_point", sizes.contact_point, "m");
  size("contact_time", sizes.contact_time, "s");
  size("robot_mass", sizes.robot_mass, "1");
  size("base_rate_error", sizes.base_rate_error, "rad/s");
  size("joint_rate_error", sizes.joint_rate_error, "rad/s (m/s)");
  t("joint_position", Numbers(sizes.joint_position), "in the order of the joints; empty: none",
    needed("rad (m)"));
  EstimateDeviations estimate = sizes.estimate.value_or(EstimateDeviations{});
  t("estimate",
    Map([&](Table& m) { fields(m, estimate); }, {.is_written = sizes.estimate.has_value()}),
    "standard deviations of the target's estimate");
  ResidualVelocity residual = sizes.residual_velocity.value_or(ResidualVelocity{});
  Matrix6d covariance = residual.covariance.value_or(Matrix6d::Zero());
  t("residual_velocity",
    Map(
        [&](Table& m) {
          m("covariance", WrittenIf(Covariance(covariance), residual.covariance.has_value()),
            "as stated, linear and angular", {.unit = "m^2/s^2, m rad/s^2, rad^2/s^2"});
          m("frame", Word(residual.frame, kResidualFrameNames), "of the covariance");
          m("linear_tracking", Number(residual.linear_tracking, kNonNegative),
            "standard deviation of the hand's velocity", {.unit = "m/s"});
          m("angular_tracking", Number(residual.angular_tracking, kNonNegative), "",
            {.unit = "rad/s"});
        },
        {.is_written = sizes.residual_velocity.has_value()}),
    "of the relative velocity beside what the estimate's errors make of it");
}

static void fields(Table& t, Spread& spread) {
  const About of_spread = needed("`unit`");
  t("name", Text(spread.name), "of the quantity", kNeeded);
  t("unit", Text(spread.unit), "", kNeeded);
  t("mean", Number(spread.mean), "", of_spread);
  t("mean_half_width", Number(spread.mean_half_width), "of the mean's 95 % confidence interval",
    of_spread);
  t("p5", Number(spread.p5), "percentile", of_spread);
  t("p50", Number(spread.p50), "median", of_spread);
  t("p95", Number(spread.p95), "percentile", of_spread);
  t("p99", Number(spread.p99), "percentile", of_spread);
  t("worst", Number(spread.worst), "the largest", of_spread);
  t("worst_trial", Integer(spread.worst_trial, 0, kMany), "number of its trial", kNeeded);
}

static void fields(Table& t, Sensitivity& sensitivity) {
  t("input", Text(sensitivity.input), "what was drawn", kNeeded);
  t("rank_correlation", Number(sensitivity.rank_correlation, {.lower = -1, .upper = 1}),
    "Spearman's", kNeeded);
}

void trials_fields(Table& t, Trials& trials) {
  TrialSetting& setting = trials.first;
  TrialReport& report = trials.second;
  int wanted = setting.wanted < 0 ? report.trials : setting.wanted;
  bool is_interrupted = report.trials < wanted;
  double confidence = 0.95;
  std::vector<std::string> outputs;
  std::map<std::string, std::vector<Sensitivity>> by_output;
  for (const Sensitivity& s : report.sensitivities) {
    if (by_output.count(s.output) == 0) outputs.push_back(s.output);
    by_output[s.output].push_back(s);
  }
  t("count", Integer(report.trials, 0, kMany), "trials that were done", kNeeded);
  t("wanted", Integer(wanted, 0, kMany), "trials that were asked for", kNeeded);
  t("interrupted", Flag(is_interrupted), "fewer than wanted", kNeeded);
  t("seed", Seed(setting.seed), "of all draws", kNeeded);
  t("perturbations", map_of(setting.sizes), "half ranges and standard deviations", kNeeded);
  t("hits", Integer(report.hits, 0, kMany), "trials in which the contact takes place", kNeeded);
  t("finished", Integer(report.finished, 0, kMany), "simulations that reached the horizon",
    kNeeded);
  t("successes", Integer(report.successes, 0, kMany), "trials that keep all limits", kNeeded);
  t("success_probability", Number(report.success_probability, kProbability), "", kNeeded);
  t("success_interval", Map([&](Table& m) {
      m("method", Exactly("wilson"), "", kNeeded);
      m("confidence", Number(confidence), "", kNeeded);
      m("lower", Number(report.success_lower, kProbability), "", kNeeded);
      m("upper", Number(report.success_upper, kProbability), "", kNeeded);
    }),
    "of the success probability", kNeeded);
  t("distributions", maps_of(report.spreads), "of the results over the trials", kNeeded);
  t("sensitivities",
    DictionaryValue([&] { return outputs; },
                    [&](const std::string& output) { return maps_of(by_output[output]); },
                    [&] { return maps_of(by_output[""]); }),
    "per result, the strongest dependence first", kNeeded);
}

void verification_fields(Table& t, Verification& verification, std::string& content_sha256,
                         Trials* trials) {
  static constexpr auto kVerdicts = names<bool>({{"pass", true}, {"fail", false}});
  format_fields(t, "stillbase.verification");
  t("content_sha256", Text(content_sha256), "of the plan", kNeeded);
  t("verdict", Word(verification.pass, kVerdicts), "", kNeeded);
  t("interrupted", WrittenIf(Flag(verification.interrupted), verification.interrupted),
    "stopped before the end: no verdict on the plan");
  t("claims", maps_of(verification.claims), "the checks", kNeeded);
  t("post_impact", maps_of(verification.reports), "motion after the impact per controller",
    kNeeded);
  Trials none;
  t("trials",
    Map([&](Table& m) { trials_fields(m, trials == nullptr ? none : *trials); },
        {.name = "trials", .is_written = trials != nullptr}),
    "what happens when everything varies");
}

}  // namespace io

std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256, const TrialResult* trials) {
  Verification copy = verification;
  std::string sha256 = content_sha256;
  TrialResult result = trials == nullptr ? TrialResult{} : *trials;
  return io::pretty(io::written([&](io::Table& t) {
    io::verification_fields(t, copy, sha256, trials == nullptr ? nullptr : &result);
  }));
}

std::string trial_outcomes_to_text(const std::vector<TrialOutcome>& outcomes) {
  io::Json list = io::Json::array();
  for (const TrialOutcome& o : outcomes) {
    list.push_back({io::Json(o.inputs), o.hit, o.finished, o.success, o.impulse, o.objective,
                    o.base_rate_jump, o.residual_base_rate, o.attitude_turned, o.peak_rate_part,
                    o.peak_torque_part, o.stop_hits, o.peak_grip_part, o.peak_wheel_part, o.rests});
  }
  return list.dump();
}

std::vector<TrialOutcome> trial_outcomes_from_text(const std::string& text) {
  std::vector<TrialOutcome> outcomes;
  try {
    const io::Json rows = io::Json::parse(text);
    if (!rows.is_array()) throw io::JsonError("the outcomes are not a list");
    for (const io::Json& row : rows) {
      const auto number = [&row](std::size_t i) { return row.at(i).get<double>(); };
      if (!row.is_array() || row.size() != 15) {
        throw io::JsonError("an outcome is not a list of 15 values");
      }
      if (row.at(0).size() != trial_input_names().size()) {
        throw InputError({{"trials", 0, "not-trials", "drawn by another version of stillbase"}});
      }
      outcomes.push_back({row.at(0).get<std::vector<double>>(), row.at(1).get<bool>(),
                          row.at(2).get<bool>(), row.at(3).get<bool>(), number(4), number(5),
                          number(6), number(7), number(8), number(9), number(10),
                          row.at(11).get<int>(), number(12), number(13), row.at(14).get<bool>()});
    }
  } catch (const io::JsonError& error) {
    throw InputError({{"trials", 0, "not-trials", error.what()}});
  }
  return outcomes;
}

}  // namespace stillbase
