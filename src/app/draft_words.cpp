#include "app/draft_words.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

namespace stillbase::app {

double rounded_to(double x, double step) { return std::max(step, std::round(x / step) * step); }

double rounded_mass(double x) { return rounded_to(x, std::pow(10, std::floor(std::log10(x)) - 1)); }

std::string vector_text(const Vector3d& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
}

std::string quaternion_text(const Eigen::Quaterniond& q) {
  return fmt::format("{{w: {:.17g}, x: {:.17g}, y: {:.17g}, z: {:.17g}}}", q.w(), q.x(), q.y(),
                     q.z());
}

std::string yaml_word(const std::string& text) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '.' || c == '-' || c >= 128;
  };
  const bool begins_well = !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) ||
                                             text[0] == '_' || text[0] == '/' || text[0] == '.');
  if (begins_well && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace stillbase::app
