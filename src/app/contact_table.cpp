#include "app/contact_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "app/exit_code.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

using io::Json;

std::vector<double> stiffnesses() {
  std::vector<double> list;
  for (int decade = 3; decade <= 9; ++decade) list.push_back(std::pow(10.0, decade));
  return list;
}

/// The case with a restitution that a spring-damper can leave.
ContactCase checked_case(ContactCase subject) {
  if (!subject.target || !(subject.impulse > 0) || !(subject.closing_speed > 0)) {
    throw CommandLineError("--contact-table: needs a target that closes in on the hand by a law");
  }
  if (subject.resistance.model == ResistanceModel::Locked) {
    throw CommandLineError("--contact-table: a contact that takes time knows no locked joints");
  }
  subject.restitution = std::max(subject.restitution, kLeastRestitution);
  return subject;
}

std::string words(const ContactCase& subject, const std::vector<ModelCheckRow>& rows) {
  const std::string model = to_string(subject.resistance.model);
  std::string text = fmt::format(
      "spring-damper contact against the instantaneous impact: joints {}, restitution {:g}, "
      "closing "
      "at {:.4g} m/s\n",
      model, subject.restitution, subject.closing_speed);
  text +=
      "  stiffness    duration  peak force  impulse off  velocity off  off if joints free  "
      "momentum off\n";
  for (const ModelCheckRow& row : rows) {
    if (!row.ended) {
      text += fmt::format("{:>7.0e} N/m  not over in time\n", row.stiffness);
      continue;
    }
    text +=
        fmt::format("{:>7.0e} N/m {:>8.3g} ms {:>9.4g} N {:>12.2e} {:>13.2e} {:>19.2e} {:>13.1e}\n",
                    row.stiffness, 1e3 * row.duration, row.peak_force, row.impulse_error,
                    row.velocity_error, row.free_error, row.momentum_error);
  }
  text +=
      "off: relative to the jump, velocities in the norm of kinetic energy; 'velocity off' is "
      "against "
      "the jump with\nthe joints as stated (servo: by its formula with the duration found), the "
      "next "
      "against that with free joints\n";
  return text;
}

}  // namespace

std::string contact_table(const ContactCase& stated, double friction, bool as_json,
                          const StopCondition& stop) {
  const ContactCase subject = checked_case(stated);
  std::vector<ModelCheckRow> rows;
  try {
    rows = check_stiffness(subject, friction, stiffnesses(), stop);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(std::string("--contact-table: ") + error.what());
  }
  if (!as_json) return words(subject, rows);
  Json list = Json::array();
  for (const ModelCheckRow& row : rows) {
    // A contact that is not over says nothing.
    const auto of_ended = [&row](double x) { return row.ended ? x : Json(nullptr); };
    list.push_back({{"stiffness", row.stiffness},
                    {"ended", row.ended},
                    {"duration", of_ended(row.duration)},
                    {"peak_force", of_ended(row.peak_force)},
                    {"impulse_error", of_ended(row.impulse_error)},
                    {"velocity_error", of_ended(row.velocity_error)},
                    {"velocity_error_free_joints", of_ended(row.free_error)},
                    {"momentum_error", of_ended(row.momentum_error)},
                    {"kinetic_energy_after", of_ended(row.kinetic_energy_after)}});
  }
  return io::pretty({{"format", "stillbase.contact_table"},
                     {"version", 1},
                     {"joint_resistance", to_string(subject.resistance.model)},
                     {"restitution", subject.restitution},
                     {"closing_speed", subject.closing_speed},
                     {"friction", friction},
                     {"rows", list}});
}

}  // namespace stillbase::app
