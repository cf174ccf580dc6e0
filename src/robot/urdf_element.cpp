#include "robot/urdf_element.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/core/constants.hpp>

namespace stillbase::urdf {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr std::string_view kBlanks = " \t\r\n";

std::vector<std::string_view> split_at_blanks(std::string_view text) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return "";
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// ${...} and $(...), which xacro replaces.
bool has_macro(std::string_view text) {
  return text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos;
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(const std::vector<std::string_view>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, " "));
}

}  // namespace

const char* const kExpandMacros =
    "macros (xacro) must be expanded first: `xacro ROBOT.urdf.xacro > ROBOT.urdf`";

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string shown = "'" + std::string(text.substr(0, kLongest));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  // A cut through a multi-byte character would leave invalid UTF-8.
  if (text.size() > kLongest) {
    while ((static_cast<unsigned char>(shown.back()) & 0xc0) == 0x80) shown.pop_back();
    if (static_cast<unsigned char>(shown.back()) >= 0xc0) shown.pop_back();
    shown += "...";
  }
  return shown + "'";
}

void Findings::remark(int line, const std::string& rule, const std::string& message,
                      const std::string& subject) {
  Kind& kind = remarks_[{rule, message}];
  if (++kind.count == 1) kind.line = line;
  if (!subject.empty()) kind.subjects.push_back(subject);
}

std::vector<Finding> Findings::remarks() const {
  constexpr std::size_t kMostSubjects = 8;
  std::vector<Finding> list;
  for (const auto& [key, kind] : remarks_) {
    std::string message = key.second;
    if (!kind.subjects.empty()) {
      const std::size_t shown = std::min(kind.subjects.size(), kMostSubjects);
      message += fmt::format(
          ": {}",
          fmt::join(kind.subjects.begin(), kind.subjects.begin() + static_cast<long>(shown), ", "));
      if (shown < kind.subjects.size()) {
        message += fmt::format(" and {} more", kind.subjects.size() - shown);
      }
    }
    if (kind.count > 1) message += fmt::format(" ({} times, first here)", kind.count);
    list.push_back({source_, kind.line, key.first, std::move(message)});
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const Finding& a, const Finding& b) { return a.line < b.line; });
  constexpr std::size_t kMostKinds = 64;  // a page; every one is written into plans
  if (list.size() > kMostKinds) {
    const std::size_t more = list.size() - kMostKinds + 1;
    list.resize(kMostKinds - 1);
    list.push_back({source_, 0, "remarks", fmt::format("{} more kinds of remarks", more)});
  }
  return list;
}

void Element::report(int line, std::string rule, std::string message) {
  if (only_remarks_ && rule != "macro") {
    findings_.leave_out(line, rule, message);
  } else {
    findings_.add(line, std::move(rule), std::move(message));
  }
}

void Element::find_in(const char* attribute, std::string rule, const std::string& message) {
  report(xml_.FindAttribute(attribute)->GetLineNum(), std::move(rule),
         fmt::format("{} {}: {}", tag(), attribute, message));
}

const char* Element::value(const char* attribute, bool required) {
  attributes_.emplace_back(attribute);
  const char* text = xml_.Attribute(attribute);
  if (text == nullptr && required) {
    find("missing-attribute", fmt::format("{} needs the attribute {}", tag(), attribute));
  }
  return text;
}

std::string Element::text(const char* attribute, bool required) {
  const char* text = value(attribute, required);
  if (text == nullptr) return "";
  if (required && *text == '\0') find_in(attribute, "missing-attribute", "the value is empty");
  if (has_macro(text)) find_in(attribute, "macro", in_quotes(text) + ": " + kExpandMacros);
  return text;
}

std::string Element::path(const char* attribute) {
  constexpr std::string_view kFind = "$(find ";
  const char* text = value(attribute, true);
  if (text == nullptr) return "";
  std::string path = text;
  std::replace(path.begin(), path.end(), '\\', '/');
  const std::size_t begin = path.find(kFind);
  const std::size_t end = path.find(')', begin);
  if (end != path.npos && (begin == 0 || path.compare(0, begin, "file://") == 0)) {
    const std::string_view name =
        trimmed(std::string_view(path).substr(begin + kFind.size(), end - begin - kFind.size()));
    path = "package://" + std::string(name) + path.substr(end + 1);
  }
  if (!has_macro(path)) return path;
  find_in(attribute, "macro", in_quotes(path) + ": " + kExpandMacros);
  return "";
}

// One finite decimal number and nothing else but blanks around it. from_chars ignores the locale
// and takes no hexadecimals or trailing text; a plus sign, which it refuses, is legal in URDF.
double Element::parse(const char* attribute, std::string_view text, std::string_view part,
                      Sign sign, bool is_limit) {
  std::string_view digits = trimmed(part);
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const auto refuse = [&](const char* rule, const std::string& message) {
    find_in(attribute, rule, message);
    return kNaN;
  };
  if (error == std::errc::result_out_of_range) {
    if (digits.find("e-") != digits.npos || digits.find("E-") != digits.npos) return 0;
    if (is_limit) return digits.starts_with('-') ? -kInfinity : kInfinity;
    return refuse("not-finite", in_quotes(part) + " does not fit into a double");
  }
  if (error != std::errc() || end != digits.data() + digits.size()) {
    if (has_macro(text)) return refuse("macro", in_quotes(text) + ": " + kExpandMacros);
    const char* const hint =
        part.find(',') != std::string_view::npos ? " (the decimal separator is a point)" : "";
    return refuse("not-a-number", in_quotes(part) + " is not a number" + hint);
  }
  if (is_limit && std::isinf(number)) return number;
  if (!std::isfinite(number)) return refuse("not-finite", in_quotes(part) + " is not finite");
  if (is_limit && std::abs(number) >= kLargestNumber) {
    number = std::copysign(kInfinity, number);
  } else if (std::abs(number) > kLargestNumber) {
    return refuse("out-of-range",
                  fmt::format("{} is larger than {:g}", in_quotes(part), kLargestNumber));
  }
  if (sign == Sign::NonNegative && number < 0) {
    return refuse("out-of-range", in_quotes(text) + " must not be negative");
  }
  return number;
}

double Element::number(const char* attribute, Sign sign, std::optional<double> otherwise) {
  const char* text = value(attribute, !otherwise);
  return text != nullptr ? parse(attribute, text, text, sign) : otherwise.value_or(kNaN);
}

double Element::limit(const char* attribute) {
  const char* text = value(attribute, false);
  return text != nullptr ? parse(attribute, text, text, Sign::Any, true) : 0;
}

double Element::rounding(const char* attribute) const {
  const char* const text = xml_.Attribute(attribute);
  if (text == nullptr) return 0;
  const std::string_view digits = trimmed(text);
  const std::size_t end = std::min(digits.find_first_of("eE"), digits.size());
  const std::string_view mantissa = digits.substr(0, end);
  if (mantissa.find_first_of("123456789") == mantissa.npos) return 0;
  int exponent = 0;
  if (end < digits.size()) {
    std::string_view power = digits.substr(end + 1);
    if (power.starts_with('+')) power.remove_prefix(1);
    std::from_chars(power.data(), power.data() + power.size(), exponent);
  }
  const std::size_t point = mantissa.find('.');
  const auto places = point == mantissa.npos ? 0 : static_cast<int>(mantissa.size() - point) - 1;
  return 0.5 * std::pow(10, exponent - places);
}

bool Element::says_the_same(const tinyxml2::XMLElement& other) const {
  const auto text_of = [](const tinyxml2::XMLElement& element) {
    tinyxml2::XMLPrinter printer(nullptr, true);
    element.Accept(&printer);
    return std::string(printer.CStr());
  };
  return text_of(xml_) == text_of(other);
}

Vector3d Element::vector(const char* attribute, Sign sign,
                         const std::optional<Vector3d>& otherwise) {
  Vector3d result = otherwise.value_or(Vector3d::Constant(kNaN));
  const char* text = value(attribute, !otherwise);
  if (text == nullptr) return result;
  const std::vector<std::string_view> parts = split_at_blanks(text);
  if (parts.size() != 3 && has_macro(text)) {
    find_in(attribute, "macro", in_quotes(text) + ": " + kExpandMacros);
    return Vector3d::Constant(kNaN);
  }
  if (parts.size() != 3) {
    find_in(attribute, "not-a-vector", in_quotes(text) + " must be three numbers between blanks");
    return Vector3d::Constant(kNaN);
  }
  for (int i = 0; i < 3; ++i) result[i] = parse(attribute, text, parts[i], sign);
  return result;
}

Vector3d Element::scale(const char* attribute) {
  const char* text = xml_.Attribute(attribute);
  if (text == nullptr || split_at_blanks(text).size() != 1) {
    return vector(attribute, Sign::Any, Vector3d::Ones());
  }
  remark("scale", tag() + " of one number: it scales all three axes");
  return Vector3d::Constant(number(attribute, Sign::Any));
}

std::vector<double> Element::numbers(const char* attribute) {
  std::vector<double> list;
  const char* text = value(attribute, true);
  if (text == nullptr) return list;
  for (const std::string_view part : split_at_blanks(text)) {
    list.push_back(parse(attribute, text, part, Sign::Any));
  }
  return list;
}

void Element::leave_out(const char* name, const std::string& reason) {
  for (const auto* e = xml_.FirstChildElement(name); e; e = e->NextSiblingElement(name)) {
    findings_.remark(e->GetLineNum(), "not-used", fmt::format("<{}>: {}", name, reason));
  }
  children_.emplace_back(name);
}

void Element::finish() {
  for (const auto* a = xml_.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view name = a->Name();
    if (contains(attributes_, name) || name.starts_with("xmlns")) continue;
    findings_.remark(a->GetLineNum(), "unknown-attribute",
                     fmt::format("{} {}: is not read; known there: {}", tag(), in_quotes(name),
                                 listed(attributes_)));
  }
  for (const auto* node = xml_.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr && !trimmed(node->Value()).empty()) {
      findings_.remark(
          node->GetLineNum(), "unexpected-text",
          fmt::format("{} contains the text {}", tag(), in_quotes(trimmed(node->Value()))));
    }
    if (node->ToElement() == nullptr) continue;
    const std::string_view name = node->Value();
    if (contains(children_, name)) continue;
    const bool defines = name == "xacro:property" || name == "xacro:arg" || name == "xacro:macro";
    if (defines) {
      findings_.remark(node->GetLineNum(), "not-used",
                       "definitions of macros (xacro) that are left over");
      continue;
    }
    if (name.starts_with("xacro:")) {
      findings_.add(node->GetLineNum(), "macro", kExpandMacros);
      continue;
    }
    findings_.remark(node->GetLineNum(), "unknown-element",
                     fmt::format("{} in {}: is not read; known there: {}", in_quotes(name), tag(),
                                 listed(children_)));
  }
}

}  // namespace stillbase::urdf
