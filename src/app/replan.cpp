// stillbase replan: a recorded stream of estimates played to a plan.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/io/estimate_file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/planner/replanner.hpp>

#include "app/command_line.hpp"
#include "app/quantity.hpp"
#include "app/words.hpp"
#include "core/escape.hpp"
#include "io/fields/replan.hpp"

namespace stillbase::app {

namespace {

using io::ReplanRecord;
using io::ReplanUpdate;

struct ReplanRequest {
  std::string plan, estimates, deadline, stay_within;
  OutputFile output;
  bool json = false, timing = false;
};

constexpr io::Range kTimeLimit{.lower = 0, .upper = kLongestTimeLimit, .is_lower_open = true};  // s
constexpr io::Range kStayWithin{.lower = 0, .upper = 3e7, .is_lower_open = true};  // rad, m

StopCondition stop_after(double seconds) {
  StopCondition stop = stop_condition();
  if (seconds > 0) stop.set_deadline_after(seconds);
  return stop;
}

bool is_feasible(const ReplanResult& result) {
  return result.status == ReplanStatus::Optimal || result.status == ReplanStatus::Feasible;
}

/// By how much the joint moved that moved most; a metre counts as a radian.
std::string largest_move(const RobotModel& robot, const Configuration& from,
                         const Configuration& to) {
  Eigen::Index joint = 0;
  const double moved = (to.phi - from.phi).cwiseAbs().maxCoeff(&joint);
  return robot.joints[static_cast<std::size_t>(joint)].is_prismatic()
             ? fmt::format("{:.3f} m", moved)
             : fmt::format("{:.2f}", moved * kDegrees);
}

/// Whether the last posture keeps the limits after the impact; empty: none are asked for, or there
/// was no time to simulate it.
std::string after_impact_of(const Replanner& replanner) {
  const CaptureProblem& problem = replanner.problem();
  if (problem.post_impact.controllers.empty() || !is_feasible(replanner.last()) ||
      stop_condition().reached()) {
    return "";
  }
  const Configuration& last = replanner.last().configuration;
  const std::string failure =
      post_impact_failure(problem, last, impact_at(problem, last), stop_condition());
  return failure.empty() ? "keeps the limits after the impact"
                         : "exceeds a limit after the impact: " + failure;
}

ReplanRecord play(const Plan& plan, const std::vector<StateEstimate>& estimates,
                  const ReplanOptions& options, double deadline) {
  const CaptureProblem& problem = plan.problem;
  ReplanRecord record;
  record.problem = problem.name;
  record.objective = objective_name(problem);
  record.unit = objective_unit_name(problem);
  record.robot = problem.robot;
  record.start = plan.configuration;
  Replanner replanner(plan, options);
  for (const StateEstimate& estimate : estimates) {
    if (stop_condition().reached()) break;
    record.updates.push_back(
        {estimate.state.time, replanner.replan(estimate, stop_after(deadline))});
  }
  record.after_impact = after_impact_of(replanner);
  return record;
}

/// At most so many updates, evenly spread, the first and the last among them.
std::vector<const ReplanUpdate*> spread_over(const std::vector<ReplanUpdate>& updates) {
  constexpr std::size_t kMost = 14;
  const std::size_t count = std::min(updates.size(), kMost);
  std::vector<const ReplanUpdate*> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(&updates[count == 1 ? 0 : i * (updates.size() - 1) / (count - 1)]);
  }
  return out;
}

/// The first update of each run of feasible or infeasible ones, the first few.
std::string changes_words(const ReplanRecord& record) {
  constexpr int kMost = 4;
  const auto feasible = std::count_if(record.updates.begin(), record.updates.end(),
                                      [](const ReplanUpdate& u) { return is_feasible(u.result); });
  std::string text = fmt::format("feasible    {} of {} updates", feasible, record.updates.size());
  int changes = 0;
  bool was_feasible = true;
  for (const ReplanUpdate& update : record.updates) {
    if (is_feasible(update.result) == was_feasible) continue;
    was_feasible = !was_feasible;
    if (++changes > kMost) continue;
    const ReplanResult& result = update.result;
    if (was_feasible) {
      text += fmt::format("; feasible again at {:g} s", update.time);
    } else if (result.status == ReplanStatus::Refused) {
      text += fmt::format("; the estimate at {:g} s is refused: {}", update.time, result.reason);
    } else {
      const auto worst =
          std::max_element(result.constraints.begin(), result.constraints.end(),
                           [](const auto& a, const auto& b) { return a.violation < b.violation; });
      text += fmt::format("; infeasible at {:g} s: {} by {:.3g}", update.time, worst->name,
                          worst->violation);
    }
  }
  if (changes > kMost) text += fmt::format("; {} more changes", changes - kMost);
  return text + '\n';
}

std::string record_words(const ReplanRecord& record) {
  const auto line = [](const auto& time, const auto& old, const auto& violation,
                       const auto& corrected, const auto& value, const auto& contact,
                       const auto& joints, const std::string& status) {
    return fmt::format("{:>8}  {:>10} {:>10}  {:>10} {:>10}  {:>9} {:>8}{}\n", time, old, violation,
                       corrected, value, contact, joints, status);
  };
  std::string text =
      line("estimate", "old", "violation", "corrected", "new", "contact", "joints", "  status") +
      line("s", record.unit, "", record.unit, record.unit, "s", "deg", "");
  for (const ReplanUpdate* update : spread_over(record.updates)) {
    const ReplanResult& result = update->result;
    text +=
        line(fmt::format("{:.2f}", update->time), fmt::format("{:.4g}", result.old.value),
             result.old.is_feasible() ? "none" : fmt::format("{:.3g}", result.old.max_violation),
             fmt::format("{:.4g}", result.corrected.value), fmt::format("{:.4g}", result.value),
             fmt::format("{:.3f}", result.configuration.contact_time),
             largest_move(record.robot, record.start, result.configuration),
             "  " + to_string(result.status) + (result.was_cut ? ", cut" : ""));
  }
  text += changes_words(record);
  if (!record.after_impact.empty()) {
    text += fmt::format("afterwards  the last posture {}\n", record.after_impact);
  }
  return text;
}

std::string latency_words(const ReplanRecord& record) {
  std::vector<double> seconds;
  long cut = 0;
  for (const ReplanUpdate& update : record.updates) {
    seconds.push_back(update.result.seconds);
    if (update.result.was_cut) ++cut;
  }
  std::sort(seconds.begin(), seconds.end());
  const auto quantile = [&seconds](double part) {
    const auto last = static_cast<double>(seconds.size() - 1);
    return 1e3 * seconds[static_cast<std::size_t>(std::ceil(part * last))];
  };
  return fmt::format("latency     median {:.3g} ms, 99 % {:.3g} ms, worst {:.3g} ms; {} of {} cut",
                     quantile(0.5), quantile(0.99), quantile(1), cut, seconds.size());
}

std::string record_json(ReplanRecord& record) {
  return io::pretty(io::written([&](io::Table& t) { io::replan_fields(t, record); }));
}

/// Numbers that are not known are empty cells.
std::string cell(double x) { return std::isfinite(x) ? fmt::format(",{}", x) : ","; }

std::string record_csv(const ReplanRecord& record) {
  std::string text =
      "time_s,status,cut,old_value,old_max_violation,corrected_value,value,nominal,worst_case,"
      "max_violation,kkt_residual,tightest,tightest_margin,contact_time_s";
  for (const Joint& joint : record.robot.joints) {
    text += ',' + csv_field(joint.name + (joint.is_prismatic() ? "_m" : "_rad"));
  }
  text +=
      ",base_x_m,base_y_m,base_z_m,base_qw,base_qx,base_qy,base_qz,contact_point_sd_m,"
      "contact_normal_half_angle_rad,closing_speed_sd_m_s,cone_half_angle_rad,after_impact,steps";
  if (record.with_seconds) text += ",seconds";
  text += '\n';
  for (std::size_t i = 0; i < record.updates.size(); ++i) {
    const ReplanUpdate& update = record.updates[i];
    const ReplanResult& result = update.result;
    const Configuration& at = result.configuration;
    const ConstraintValue* const tightest = io::tightest_constraint(result);
    text += fmt::format("{},{},{}", update.time, to_string(result.status), result.was_cut ? 1 : 0);
    for (const double x :
         {result.old.value, result.old.max_violation, result.corrected.value, result.value,
          result.nominal, result.worst_case, result.max_violation, result.kkt_residual}) {
      text += cell(x);
    }
    text += tightest == nullptr
                ? ",,"
                : fmt::format(",{},{}", csv_field(tightest->name), margin_of(*tightest));
    text += cell(at.contact_time);
    for (const double phi : at.phi) text += cell(phi);
    const Eigen::Quaterniond& q = at.base.orientation;
    for (const double x : {at.base.position.x(), at.base.position.y(), at.base.position.z(), q.w(),
                           q.x(), q.y(), q.z()}) {
      text += cell(x);
    }
    const ContactDeviations unknown{kInfinity, kInfinity, kInfinity};
    const ContactDeviations contact = result.contact.value_or(unknown);
    text += cell(contact.point) + cell(contact.half_angle) + cell(contact.closing_speed) +
            cell(result.cone_half_angle);
    const bool is_last = i + 1 == record.updates.size();  // that alone is simulated
    text += is_last ? ',' + csv_field(record.after_impact) : ",";
    text += fmt::format(",{}", result.steps);
    if (record.with_seconds) text += cell(result.seconds);
    text += '\n';
  }
  return text;
}

int exit_code_of(const ReplanRecord& record) {
  if (signal_exit_code() != 0) return signal_exit_code();
  if (!is_feasible(record.updates.back().result)) return kInfeasible;
  const bool was_cut =
      std::any_of(record.updates.begin(), record.updates.end(),
                  [](const ReplanUpdate& update) { return update.result.was_cut; });
  return was_cut ? kLimit : kDone;
}

int replan(const ReplanRequest& request) {
  request.output.check({".json", ".csv"});
  const double deadline = request.deadline.empty() ? 0
                                                   : read_quantity("--deadline", request.deadline,
                                                                   io::Dimension::Time, kTimeLimit);
  ReplanOptions options;
  if (!request.stay_within.empty()) {
    options.stay_within = read_quantity("--stay-within", request.stay_within,
                                        io::Dimension::JointPosition, kStayWithin);
  }
  for (const std::string& input : {request.plan, request.estimates}) {
    if (is_same_file(input, request.output.path)) {
      throw CommandLineError(request.output.path + ": is the input itself");
    }
  }
  const Plan plan = load_plan(request.plan).plan;
  const std::vector<StateEstimate> estimates = read_estimates(request.estimates);
  ReplanRecord record = [&] {
    try {
      return play(plan, estimates, options, deadline);
    } catch (const InputError& error) {
      std::vector<Finding> findings = error.findings();
      for (Finding& finding : findings) {
        finding.file = request.plan;
        if (finding.rule != "no-configuration") finding.message = "problem." + finding.message;
      }
      throw InputError(findings);
    }
  }();
  record.with_seconds = request.timing;
  if (record.updates.empty()) return signal_exit_code();  // before the first one
  if (request.output.is_given()) {
    const bool is_json = extension_of(request.output.path) == ".json";
    request.output.write(is_json ? record_json(record) : record_csv(record));
  }
  if (request.json) {
    write_stdout(record_json(record));
  } else {
    write_stdout(record_words(record));
  }
  say(latency_words(record));
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  return exit_code_of(record);
}

}  // namespace

Command replan_command() {
  auto request = std::make_shared<ReplanRequest>();
  return {"replan",
          "the posture of a plan while the estimate of its target moves: posture, contact time and "
          "impact, not the approach path",
          std::vector<Option>{
              {"plan", "PLAN.json", "plan file (JSON)", &request->plan, true},
              {.name = "--estimates",
               .value = "FILE.csv",
               .about = "estimates of the target over time, columns as docs/how-to/replan.md says",
               .target = &request->estimates,
               .is_required = true},
              {"--deadline", "TIME",
               "of each update, such as 10ms, without a unit s; the best so far is taken then",
               &request->deadline},
              {"--stay-within", "ANGLE",
               "that each joint may be from the plan's posture, such as 60deg, without a unit rad; "
               "default 0.1 rad. Farther postures are taken where no nearer one is feasible",
               &request->stay_within},
              {"--timing", "", "write how long each update took to the output file as well",
               &request->timing},
              {"--json", "", "print one JSON object in place of the table", &request->json}} +
              output_options(request->output, "-o,--output", "every update, as .json or .csv"),
          [request] { return replan(*request); }};
}

}  // namespace stillbase::app
