// Single values of a parsed file: numbers with units, texts, vectors, orientations, names.
#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "io/scalars.hpp"

namespace stillbase::io {

namespace {

bool names_nan_or_infinity(std::string_view text) {
  std::string word;
  for (const char c : text) {
    if (c == ' ' && !word.empty()) break;
    if (c != '.' && c != '+' && c != '-')
      word += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  return word == "nan" || word == "inf" || word == "infinity";
}

std::string collapse_spaces(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c != ' ') {
      out += c;
    } else if (!out.empty() && out.back() != ' ') {
      out += ' ';
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// Insertions, deletions, substitutions and exchanges of neighbours between two words.
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d.back().back();
}

/// v / |v|, or v itself when its norm is 1 to rounding.
Vector3d normalized_once(const Vector3d& v) {
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  return std::abs(v.squaredNorm() - 1) <= kRounding ? v : Vector3d(v / v.norm());
}

constexpr double kUnitTolerance = 1e-6;

}  // namespace

bool is_scalar(const Node& node) {
  return node.kind == Node::Kind::Plain || node.kind == Node::Kind::Quoted;
}

std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Null:
      return "nothing";
    case Node::Kind::Plain:
    case Node::Kind::Quoted:
      return fmt::format("'{}'",
                         node.text.size() > 60 ? node.text.substr(0, 57) + "..." : node.text);
    case Node::Kind::Sequence:
      return fmt::format("a list of {}", node.items.size());
    case Node::Kind::Map:
      return "a map";
  }
  return {};
}

Scanned scan_number(std::string_view text) {
  Scanned scanned;
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  std::string_view unsigned_digits = digits;
  if (!unsigned_digits.empty() && unsigned_digits.front() == '-' && digits.size() == text.size()) {
    unsigned_digits.remove_prefix(1);
  }
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  // Also keeps "inf" and "nan", which from_chars would take, away from it.
  if (unsigned_digits.empty() ||
      !(is_digit(unsigned_digits.front()) || unsigned_digits.front() == '.'))
    return scanned;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), scanned.value);
  if (error == std::errc::invalid_argument) return scanned;
  scanned.remainder = digits.substr(static_cast<std::size_t>(end - digits.data()));
  if (error == std::errc::result_out_of_range || !std::isfinite(scanned.value)) {
    scanned.result = Scanned::Result::Overflow;
  } else if (unsigned_digits.size() > 1 && unsigned_digits[0] == '0' &&
             is_digit(unsigned_digits[1])) {
    scanned.result = Scanned::Result::LeadingZero;
  } else {
    scanned.result = Scanned::Result::Good;
  }
  return scanned;
}

std::string Range::text() const {
  // 1e+12, not 1000000000000.
  const auto word = [](double x) {
    return std::abs(x) >= 1e6 ? fmt::format("{:g}", x) : fmt::format("{}", x);
  };
  const bool has_lower = std::isfinite(lower), has_upper = std::isfinite(upper);
  if (has_lower && has_upper) {
    return fmt::format("in {}{}, {}]", is_lower_open ? '(' : '[', word(lower), word(upper));
  }
  if (has_lower) return fmt::format("{} {}", is_lower_open ? ">" : ">=", word(lower));
  if (has_upper) return fmt::format("<= {}", word(upper));
  return "any finite number";
}

std::optional<double> read_number(ReadContext& context, const Node& node, const std::string& path,
                                  Dimension dimension, const Range& range) {
  const std::string units = units_of(dimension);
  const std::string allowed =
      units.empty()
          ? "expected a number without unit"
          : fmt::format("expected a number in SI units, or a text with one of: {}", units);
  const auto refuse = [&](const char* rule, const std::string& what) {
    context.add(node.line, rule, fmt::format("{}: {}", path, what));
    return std::nullopt;
  };
  if (!is_scalar(node)) {
    return refuse("wrong-type", fmt::format("{} is not a number; {}", describe(node), allowed));
  }
  if (names_nan_or_infinity(node.text)) {
    return refuse("not-finite",
                  fmt::format("{} is not allowed; every number must be finite", describe(node)));
  }
  const Scanned scanned = scan_number(node.text);
  if (scanned.result == Scanned::Result::None) {
    return refuse("wrong-type", fmt::format("{} is not a number; {}", describe(node), allowed));
  }
  if (scanned.result == Scanned::Result::Overflow) {
    return refuse("not-finite", fmt::format("{} does not fit a double", describe(node)));
  }
  if (scanned.result == Scanned::Result::LeadingZero) {
    return refuse("wrong-type", fmt::format("{}: leading zeros are not allowed", describe(node)));
  }
  double value = scanned.value;
  if (scanned.remainder.empty()) {
    if (node.kind == Node::Kind::Quoted) {
      return refuse("wrong-type",
                    fmt::format("{} is text; write the number without quotes", describe(node)));
    }
  } else {
    if (scanned.remainder.front() != ' ') {
      return refuse("wrong-type", fmt::format("{} is not a number; {}", describe(node), allowed));
    }
    const std::string unit = collapse_spaces(scanned.remainder);
    const auto factor = unit_factor(unit, dimension);
    if (!factor) {
      return refuse(
          is_unit(unit) ? "wrong-unit" : "unknown-unit",
          fmt::format("{}: unit '{}' {}; {}", describe(node), unit,
                      is_unit(unit) ? "has the wrong dimension" : "is not known", allowed));
    }
    value *= *factor;
    if (!std::isfinite(value)) {
      return refuse("not-finite", fmt::format("{} does not fit a double", describe(node)));
    }
  }
  // rad per deg, of an angle without unit; else 0.
  const double degree = scanned.remainder.empty() ? unit_factor("deg", dimension).value_or(0) : 0;
  if (!range.contains(value)) {
    const bool may_be_degrees = degree > 0 && range.contains(value * degree);
    return refuse(
        "out-of-range",
        fmt::format("{} is not allowed; must be {}{}{}{}", describe(node), range.text(),
                    units.empty() ? "" : " ", units.substr(0, units.find(',')),
                    may_be_degrees ? fmt::format("; did you mean '{} deg'?", node.text) : ""));
  }
  if (degree > 0 && std::abs(value) > 2 * kPi) {
    context.remarks.push_back(
        {context.source, node.line, "no-unit",
         fmt::format("{}: {} without unit is {:.6g} deg; did you mean '{} deg'?", path, node.text,
                     value / degree, node.text)});
  }
  return value;
}

std::optional<std::string> read_text(ReadContext& context, const Node& node,
                                     const std::string& path) {
  const bool is_plain_word = node.kind == Node::Kind::Plain && !names_nan_or_infinity(node.text) &&
                             node.text != "true" && node.text != "false" &&
                             !(scan_number(node.text).result != Scanned::Result::None &&
                               scan_number(node.text).remainder.empty());
  if (node.kind != Node::Kind::Quoted && !is_plain_word) {
    context.add(node.line, "wrong-type",
                fmt::format("{}: {} is not text; put quotes around it if it is meant", path,
                            describe(node)));
    return std::nullopt;
  }
  return node.text;
}

std::optional<std::vector<double>> read_numbers(ReadContext& context, const Node& node,
                                                const std::string& path, Dimension dimension,
                                                int size, const Range& range) {
  if (node.kind != Node::Kind::Sequence) {
    context.add(node.line, "wrong-type",
                fmt::format("{}: {} is not a list of numbers", path, describe(node)));
    return std::nullopt;
  }
  if (size >= 0 && static_cast<int>(node.items.size()) != size) {
    context.add(node.line, "wrong-length",
                fmt::format("{}: has {} elements; must have {}", path, node.items.size(), size));
    return std::nullopt;
  }
  std::vector<double> values;
  values.reserve(node.items.size());
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto value =
        read_number(context, node.items[i], fmt::format("{}[{}]", path, i), dimension, range);
    if (value) values.push_back(*value);
  }
  if (values.size() != node.items.size()) return std::nullopt;
  return values;
}

std::optional<Vector3d> read_vector3(ReadContext& context, const Node& node,
                                     const std::string& path, Dimension dimension,
                                     const Range& range) {
  const auto values = read_numbers(context, node, path, dimension, 3, range);
  if (!values) return std::nullopt;
  return Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<Vector3d> read_direction(ReadContext& context, const Node& node,
                                       const std::string& path) {
  const auto vector = read_vector3(context, node, path, Dimension::None);
  if (!vector) return std::nullopt;
  const double norm = vector->norm();
  if (!(norm > 1e-12) || !std::isfinite(norm)) {
    context.add(node.line, "zero-direction",
                fmt::format("{}: a vector of length {} has no direction", path, norm));
    return std::nullopt;
  }
  return normalized_once(*vector);
}

std::optional<Vector3d> read_unit_vector(ReadContext& context, const Node& node,
                                         const std::string& path) {
  const auto vector = read_vector3(context, node, path, Dimension::None);
  if (!vector) return std::nullopt;
  if (!(std::abs(vector->norm() - 1) <= kUnitTolerance)) {
    context.add(node.line, "not-unit",
                fmt::format("{}: has norm {}; must be a unit vector", path, vector->norm()));
    return std::nullopt;
  }
  return normalized_once(*vector);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string* best = nullptr;
  int best_distance = 1 + std::max(1, static_cast<int>(word.size()) / 3);
  for (const std::string& candidate : candidates) {
    const int distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = &candidate;
      best_distance = distance;
    }
  }
  return best == nullptr ? std::string() : fmt::format("; did you mean '{}'?", *best);
}

std::string list_of(const std::vector<std::string>& words) {
  return words.empty() ? "(none)" : fmt::format("{}", fmt::join(words, ", "));
}

bool check_name(ReadContext& context, int line, const std::string& path, const std::string& word,
                const std::vector<std::string>& known, const char* what) {
  if (std::find(known.begin(), known.end(), word) != known.end()) return true;
  context.add(line, "unknown-name",
              fmt::format("{}: '{}' is not known{}; {}: {}", path, word, did_you_mean(word, known),
                          what, list_of(known)));
  return false;
}

}  // namespace stillbase::io
