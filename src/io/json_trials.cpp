#include "io/json_trials.hpp"

#include <nlohmann/json.hpp>

#include <stillbase/core/error.hpp>

namespace stillbase {
namespace io {

Json trials_json(const TrialSetting& setting, const TrialReport& report) {
  const Perturbations& sizes = setting.sizes;
  Json spreads = Json::array();
  for (const Spread& s : report.spreads) {
    spreads.push_back({{"name", s.name},
                       {"unit", s.unit},
                       {"mean", number_json(s.mean)},
                       {"mean_half_width", number_json(s.mean_half_width)},
                       {"p5", number_json(s.p5)},
                       {"p50", number_json(s.p50)},
                       {"p95", number_json(s.p95)},
                       {"p99", number_json(s.p99)},
                       {"worst", number_json(s.worst)},
                       {"worst_trial", s.worst_trial}});
  }
  Json sensitivities = Json::object();
  for (const Sensitivity& s : report.sensitivities) {
    sensitivities[s.output].push_back(
        {{"input", s.input}, {"rank_correlation", number_json(s.rank_correlation)}});
  }
  const int wanted = setting.wanted < 0 ? report.trials : setting.wanted;
  return {{"count", report.trials},
          {"wanted", wanted},
          {"interrupted", report.trials < wanted},
          {"seed", setting.seed},
          {"perturbations",
           {{"cone_half_angle", number_json(sizes.cone_half_angle)},
            {"closing_speed", number_json(sizes.closing_speed)},
            {"restitution", number_json(sizes.restitution)},
            {"target_mass", number_json(sizes.target_mass)},
            {"target_inertia", number_json(sizes.target_inertia)},
            {"contact_point", number_json(sizes.contact_point)},
            {"contact_time", number_json(sizes.contact_time)},
            {"robot_mass", number_json(sizes.robot_mass)},
            {"base_rate_error", number_json(sizes.base_rate_error)},
            {"joint_rate_error", number_json(sizes.joint_rate_error)}}},
          {"hits", report.hits},
          {"finished", report.finished},
          {"successes", report.successes},
          {"success_probability", number_json(report.success_probability)},
          {"success_interval",
           {{"method", "wilson"},
            {"confidence", 0.95},
            {"lower", number_json(report.success_lower)},
            {"upper", number_json(report.success_upper)}}},
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
    for (const double x : o.inputs) inputs.push_back(io::number_json(x));
    list.push_back({inputs, o.hit, o.finished, o.success, io::number_json(o.impulse),
                    io::number_json(o.objective), io::number_json(o.base_rate_jump),
                    io::number_json(o.residual_base_rate), io::number_json(o.attitude_turned),
                    io::number_json(o.peak_rate_part), io::number_json(o.peak_torque_part),
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
  } catch (const nlohmann::json::exception& error) {
    throw InputError({{"trials", 0, "not-trials", error.what()}});
  }
  return outcomes;
}

}  // namespace stillbase
