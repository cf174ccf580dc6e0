#include <fmt/format.h>

#include "core/escape.hpp"
#include "export/columns.hpp"

namespace stillbase {

namespace {

/// "rad/s^2" as a part of a name: "rad_per_s2". None of a number without dimension.
std::string unit_suffix(const std::string& unit) {
  if (unit == "1") return "";
  std::string text = "_";
  for (const char c : unit) {
    if (c == '/') {
      text += "_per_";
    } else if (c == ' ') {
      text += '_';
    } else if (c != '^') {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::string trajectory_csv(const Plan& plan) {
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  const std::vector<SampleColumns> columns = sample_columns(plan);
  std::string text;
  for (const SampleColumns& column : columns) {
    for (std::size_t i = 0; i < column.labels.size(); ++i) {
      text += text.empty() ? "" : ",";
      text += csv_field(column.labels[i] + unit_suffix(column.units[i]));
    }
  }
  for (const TrajectorySample& sample : samples) {
    char separator = '\n';
    for (const SampleColumns& column : columns) {
      for (const double x : column.values(sample)) {
        text += separator + fmt::format("{}", x);
        separator = ',';
      }
    }
  }
  return text + "\n";
}

}  // namespace stillbase
