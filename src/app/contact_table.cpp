#include "app/contact_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/simulation/model_check.hpp>

#include "app/tool.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

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
  io::ContactTable table{subject.resistance.model, subject.restitution, subject.closing_speed,
                         friction, rows};
  return io::pretty(io::written([&](io::Table& t) { io::contact_table_fields(t, table); }));
}

}  // namespace stillbase::app
