#include "robot/urdf_schema.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <system_error>

namespace stillbase::urdf {

namespace {

enum class Value { Text, Version, Number, NonNegative, Positive, Vector, PositiveVector, Axis };

struct AttributeRule {
  std::string_view name;
  Value value;
  bool required;
};

struct ChildRule {
  std::string_view name;
  int least, most;
};

constexpr int kAny = 1 << 20;

// Sums, products and squares of such numbers along a chain of fixed links stay finite.
constexpr double kLargestNumber = 1e60;

struct ElementRule {
  std::vector<AttributeRule> attributes = {};
  std::vector<ChildRule> children = {};
  std::vector<std::string_view> ignored = {};  ///< children that say nothing about mechanics
};

const std::map<std::string_view, ElementRule>& rules() {
  using enum Value;
  constexpr bool kRequired = true, kOptional = false;
  static const std::map<std::string_view, ElementRule> table = {
      {"robot",
       {{{"name", Text, kRequired}, {"version", Version, kOptional}},
        {{"link", 1, kAny}, {"joint", 0, kAny}},
        {"material", "transmission", "gazebo", "sensor"}}},
      {"link",
       {{{"name", Text, kRequired}, {"type", Text, kOptional}},
        {{"inertial", 0, 1}, {"collision", 0, kAny}},
        {"visual", "contact", "sensor", "gazebo"}}},
      {"inertial", {{}, {{"origin", 0, 1}, {"mass", 1, 1}, {"inertia", 1, 1}}}},
      {"origin", {{{"xyz", Vector, kOptional}, {"rpy", Vector, kOptional}}}},
      {"mass", {{{"value", NonNegative, kRequired}}}},
      {"inertia",
       {{{"ixx", Number, kRequired},
         {"iyy", Number, kRequired},
         {"izz", Number, kRequired},
         {"ixy", Number, kRequired},
         {"ixz", Number, kRequired},
         {"iyz", Number, kRequired}}}},
      {"collision",
       {{{"name", Text, kOptional}, {"group", Text, kOptional}},
        {{"origin", 0, 1}, {"geometry", 1, 1}},
        {"material", "verbose"}}},
      {"geometry", {{}, {{"sphere", 0, 1}, {"box", 0, 1}, {"cylinder", 0, 1}}}},
      {"sphere", {{{"radius", Positive, kRequired}}}},
      {"box", {{{"size", PositiveVector, kRequired}}}},
      {"cylinder", {{{"radius", Positive, kRequired}, {"length", Positive, kRequired}}}},
      {"joint",
       {{{"name", Text, kRequired}, {"type", Text, kRequired}},
        {{"origin", 0, 1},
         {"parent", 1, 1},
         {"child", 1, 1},
         {"axis", 0, 1},
         {"limit", 0, 1},
         {"dynamics", 0, 1}},
        {"calibration", "safety_controller"}}},
      {"parent", {{{"link", Text, kRequired}}}},
      {"child", {{{"link", Text, kRequired}}}},
      {"axis", {{{"xyz", Axis, kRequired}}}},
      {"limit",
       {{{"lower", Number, kOptional},
         {"upper", Number, kOptional},
         {"velocity", NonNegative, kRequired},
         {"effort", NonNegative, kRequired}}}},
      {"dynamics", {{{"damping", NonNegative, kOptional}, {"friction", NonNegative, kOptional}}}},
  };
  return table;
}

/// A complaint about one value, empty when there is none.
struct Complaint {
  std::string rule, message;
};

// One finite decimal number and nothing else. from_chars ignores the locale and takes no blanks,
// hexadecimals or trailing text; a plus sign, which it refuses, is legal in URDF.
Complaint parse_number(std::string_view text, double& number) {
  const std::string shown = quoted(text);
  std::string_view digits = text;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error == std::errc::result_out_of_range) {
    return {"not-finite", shown + " does not fit into a double"};
  }
  if (error != std::errc() || end != digits.data() + digits.size()) {
    const bool comma = text.find(',') != std::string_view::npos;
    return {"not-a-number",
            shown + " is not a number" + (comma ? " (the decimal separator is a point)" : "")};
  }
  if (!std::isfinite(number)) return {"not-finite", shown + " is not finite"};
  if (std::abs(number) > kLargestNumber) {
    return {"out-of-range", fmt::format("{} is larger than {:g}", shown, kLargestNumber)};
  }
  return {};
}

std::vector<std::string_view> split_at_blanks(std::string_view text) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

Complaint check_value(std::string_view text, Value kind, bool required) {
  if (kind == Value::Text) {
    return required && text.empty() ? Complaint{"missing-attribute", "the value is empty"}
                                    : Complaint{};
  }
  if (kind == Value::Version) {
    return text == "1.0" ? Complaint{} : Complaint{"version", quoted(text) + " must be 1.0"};
  }
  const bool is_vector =
      kind == Value::Vector || kind == Value::PositiveVector || kind == Value::Axis;
  const std::vector<std::string_view> parts =
      is_vector ? split_at_blanks(text) : std::vector<std::string_view>{text};
  if (is_vector && parts.size() != 3) {
    return {"not-a-vector", quoted(text) + " must be three numbers between blanks"};
  }
  double largest = 0;
  for (const std::string_view part : parts) {
    double number = 0;
    if (const Complaint complaint = parse_number(part, number); !complaint.rule.empty()) {
      return complaint;
    }
    largest = std::max(largest, std::abs(number));
    if ((kind == Value::Positive || kind == Value::PositiveVector) && !(number > 0)) {
      return {"out-of-range", quoted(text) + " must be greater than 0"};
    }
    if (kind == Value::NonNegative && number < 0) {
      return {"out-of-range", quoted(text) + " must not be negative"};
    }
  }
  if (kind == Value::Axis && largest == 0) {
    return {"joint-axis", quoted(text) + " has no direction"};
  }
  return {};
}

void check_attributes(const tinyxml2::XMLElement& element, const ElementRule& rule,
                      Findings& findings) {
  const std::string tag = fmt::format("<{}>", element.Name());
  for (const auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string name = a->Name();
    const auto known = std::find_if(rule.attributes.begin(), rule.attributes.end(),
                                    [&](const AttributeRule& r) { return r.name == name; });
    if (known == rule.attributes.end()) {
      if (name.rfind("xmlns", 0) == 0) continue;
      std::string allowed;
      for (const AttributeRule& r : rule.attributes) allowed += fmt::format(" {}", r.name);
      findings.add(a->GetLineNum(), "unknown-attribute",
                   fmt::format("{} has no attribute {}; allowed:{}", tag, quoted(name),
                               allowed.empty() ? " none" : allowed));
    } else if (const Complaint c = check_value(a->Value(), known->value, known->required);
               !c.rule.empty()) {
      findings.add(a->GetLineNum(), c.rule, fmt::format("{} {}: {}", tag, name, c.message));
    }
  }
  for (const AttributeRule& r : rule.attributes) {
    if (r.required && element.Attribute(r.name.data()) == nullptr) {
      findings.add(element.GetLineNum(), "missing-attribute",
                   fmt::format("{} needs the attribute {}", tag, r.name));
    }
  }
}

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

// Elements that URDF files do contain and that we refuse deserve a reason of their own.
std::string reason_against(std::string_view parent, std::string_view name) {
  if (name == "mimic") return "coupled joints (<mimic>) are not supported: each joint is free";
  if (parent == "geometry" && name == "mesh") {
    return "meshes are not supported as collision shapes: use sphere, box, cylinder or capsule";
  }
  if (parent == "geometry" && name == "capsule") {
    return "URDF has no <capsule>: write a <cylinder> in a <collision> whose name ends in _capsule";
  }
  if (name.find(':') != std::string_view::npos) return "macros (xacro) must be expanded first";
  return "";
}

void check_children(const tinyxml2::XMLElement& element, const ElementRule& rule,
                    Findings& findings) {
  const std::string tag = fmt::format("<{}>", element.Name());
  std::map<std::string_view, int> count;
  for (const auto* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr) {
      findings.add(node->GetLineNum(), "unexpected-text",
                   fmt::format("{} contains the text {}", tag, quoted(trimmed(node->Value()))));
    }
    const auto* child = node->ToElement();
    if (child == nullptr) continue;
    const std::string_view name = child->Name();
    if (std::find(rule.ignored.begin(), rule.ignored.end(), name) != rule.ignored.end()) continue;
    const auto known = std::find_if(rule.children.begin(), rule.children.end(),
                                    [&](const ChildRule& r) { return r.name == name; });
    if (known == rule.children.end()) {
      const std::string reason = reason_against(element.Name(), name);
      std::string allowed;
      for (const ChildRule& r : rule.children) allowed += fmt::format(" {}", r.name);
      findings.add(child->GetLineNum(), name == "mimic" ? "mimic" : "unknown-element",
                   reason.empty() ? fmt::format("{} in {}; allowed:{}", quoted(name), tag,
                                                allowed.empty() ? " none" : allowed)
                                  : reason);
      continue;
    }
    if (++count[known->name] == known->most + 1) {
      findings.add(child->GetLineNum(), "repeated-element",
                   fmt::format("{} holds more than one <{}>", tag, name));
    }
    check_element(*child, findings);
  }
  for (const ChildRule& r : rule.children) {
    if (count[r.name] < r.least) {
      findings.add(element.GetLineNum(), "missing-element",
                   fmt::format("{} needs a <{}>", tag, r.name));
    }
  }
}

}  // namespace

std::string quoted(std::string_view text) {
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

void check_element(const tinyxml2::XMLElement& element, Findings& findings) {
  const ElementRule& rule = rules().at(element.Name());
  check_attributes(element, rule, findings);
  check_children(element, rule, findings);
  if (std::string_view(element.Name()) != "geometry") return;
  int shapes = 0;
  for (const auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    ++shapes;
  }
  if (shapes != 1) {
    findings.add(element.GetLineNum(), "geometry",
                 fmt::format("<geometry> holds {} shapes, must be one", shapes));
  }
}

double number(const tinyxml2::XMLElement* element, const char* attribute, double otherwise) {
  const char* text = element != nullptr ? element->Attribute(attribute) : nullptr;
  double value = otherwise;
  if (text != nullptr) parse_number(text, value);
  return value;
}

Vector3d vector(const tinyxml2::XMLElement* element, const char* attribute,
                const Vector3d& otherwise) {
  const char* text = element != nullptr ? element->Attribute(attribute) : nullptr;
  if (text == nullptr) return otherwise;
  const std::vector<std::string_view> parts = split_at_blanks(text);
  Vector3d value;
  for (int i = 0; i < 3; ++i) parse_number(parts[i], value[i]);
  return value;
}

}  // namespace stillbase::urdf
