#include "app/trial_words.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace stillbase::app {

namespace {

/// Rank correlations below this are those of independent numbers in a few hundred trials.
constexpr double kLeastCorrelation = 0.1;

/// The input that the result depends on most, with its rank correlation.
std::string driver_words(const TrialReport& report, const std::string& output) {
  const auto strongest =
      std::find_if(report.sensitivities.begin(), report.sensitivities.end(),
                   [&output](const Sensitivity& s) { return s.output == output; });
  const bool is_known = strongest != report.sensitivities.end() &&
                        std::abs(strongest->rank_correlation) >= kLeastCorrelation;
  if (!is_known) return "no single error";
  return fmt::format("{} ({:.2f})", strongest->input, strongest->rank_correlation);
}

/// Largest value of a result with which a trial succeeds. Empty: any.
std::optional<double> limit_of(const std::string& result, const PostImpactSpec& spec) {
  if (spec.controllers.empty()) return std::nullopt;
  if (result == "residual_base_rate") return spec.residual_base_rate_max;
  if (result == "attitude_turned") return spec.attitude_change_max;
  if (result == "peak_rate_part" || result == "peak_torque_part") return 1.0;
  return std::nullopt;
}

}  // namespace

std::string success_words(const TrialReport& report) {
  std::string text = fmt::format(
      "{} trials: {} succeed, probability {:.4f} (95 % interval {:.4f} to {:.4f}, Wilson)",
      report.trials, report.successes, report.success_probability, report.success_lower,
      report.success_upper);
  const char* before = "; others fail by ";
  for (const auto& [failure, count] : report.failures) {
    text += fmt::format("{}{} ({})", before, failure, count);
    before = ", ";
  }
  return text;
}

std::string trial_words(const TrialReport& report, const PostImpactSpec* limits) {
  constexpr const char* kRow = "\n  {:<20} {:>10} {:>10} {:>10} {:>10}{} {:<6} {:>8}  {}";
  const auto limit_column = [&](const std::string& text) {
    return limits != nullptr ? fmt::format(" {:>10}", text) : "";
  };
  const auto number = [](double x) { return fmt::format("{:.4g}", x); };
  std::string text = success_words(report);
  text += fmt::format(kRow, "", "median", "95 % below", "99 % below", "worst",
                      limit_column("limit"), "", "in trial", "driven by (rank correlation)");
  for (const Spread& s : report.spreads) {
    const auto limit = limits != nullptr ? limit_of(s.name, *limits) : std::nullopt;
    text += fmt::format(kRow, s.name, number(s.p50), number(s.p95), number(s.p99), number(s.worst),
                        limit_column(limit ? number(*limit) : ""), s.unit, s.worst_trial,
                        driver_words(report, s.name));
  }
  return text;
}

}  // namespace stillbase::app
