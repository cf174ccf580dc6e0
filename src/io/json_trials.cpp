#include "io/json_trials.hpp"

#include <stillbase/core/error.hpp>

namespace stillbase {
namespace io {

Json trials_json(const TrialSetting& setting, const TrialReport& report) {
  const Perturbations& sizes = setting.sizes;
  Json spreads = Json::array();
  for (const Spread& s : report.spreads) {
    spreads.push_back({{"name", s.name},
                       {"unit", s.unit},
                       {"mean", s.mean},
                       {"mean_half_width", s.mean_half_width},
                       {"p5", s.p5},
                       {"p50", s.p50},
                       {"p95", s.p95},
                       {"p99", s.p99},
                       {"worst", s.worst},
                       {"worst_trial", s.worst_trial}});
  }
  Json sensitivities = Json::object();
  for (const Sensitivity& s : report.sensitivities) {
    sensitivities[s.output].push_back(
        {{"input", s.input}, {"rank_correlation", s.rank_correlation}});
  }
  const int wanted = setting.wanted < 0 ? report.trials : setting.wanted;
  return {{"count", report.trials},
          {"wanted", wanted},
          {"interrupted", report.trials < wanted},
          {"seed", setting.seed},
          {"perturbations",
           {{"cone_half_angle", sizes.cone_half_angle},
            {"closing_speed", sizes.closing_speed},
            {"restitution", sizes.restitution},
            {"target_mass", sizes.target_mass},
            {"target_inertia", sizes.target_inertia},
            {"contact_point", sizes.contact_point},
            {"contact_time", sizes.contact_time},
            {"robot_mass", sizes.robot_mass},
            {"base_rate_error", sizes.base_rate_error},
            {"joint_rate_error", sizes.joint_rate_error}}},
          {"hits", report.hits},
          {"finished", report.finished},
          {"successes", report.successes},
          {"success_probability", report.success_probability},
          {"success_interval",
           {{"method", "wilson"},
            {"confidence", 0.95},
            {"lower", report.success_lower},
            {"upper", report.success_upper}}},
          {"distributions", spreads},
          {"sensitivities", sensitivities}};
}

}  // namespace io

std::string trial_report_to_json(const TrialSetting& setting, const TrialReport& report) {
  return io::pretty(io::trials_json(setting, report));
}

std::string trial_outcomes_to_text(const std::vector<TrialOutcome>& outcomes) {
  io::Json list = io::Json::array();
  for (const TrialOutcome& o : outcomes) {
    io::Json inputs = io::Json::array();
    for (const double x : o.inputs) inputs.push_back(x);
    list.push_back({inputs, o.hit, o.finished, o.success, o.impulse, o.objective, o.base_rate_jump,
                    o.residual_base_rate, o.attitude_turned, o.peak_rate_part, o.peak_torque_part,
                    o.stop_hits});
  }
  return list.dump();
}

std::vector<TrialOutcome> trial_outcomes_from_text(const std::string& text) {
  std::vector<TrialOutcome> outcomes;
  try {
    for (const io::Json& row : io::Json::parse(text)) {
      TrialOutcome o;
      o.inputs = row.at(0).get<std::vector<double>>();
      o.hit = row.at(1).get<bool>();
      o.finished = row.at(2).get<bool>();
      o.success = row.at(3).get<bool>();
      double* const numbers[] = {
          &o.impulse,         &o.objective,      &o.base_rate_jump,  &o.residual_base_rate,
          &o.attitude_turned, &o.peak_rate_part, &o.peak_torque_part};
      for (std::size_t i = 0; i < std::size(numbers); ++i)
        *numbers[i] = row.at(4 + i).get<double>();
      o.stop_hits = row.at(11).get<int>();
      outcomes.push_back(std::move(o));
    }
  } catch (const io::JsonError& error) {
    throw InputError({{"trials", 0, "not-trials", error.what()}});
  }
  return outcomes;
}

}  // namespace stillbase
