#include "io/fields/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/rotation.hpp>

#include "io/field_reader.hpp"
#include "io/fields/describer.hpp"
#include "io/scan.hpp"

namespace stillbase::io {

namespace {

constexpr double kQuaternionTolerance = 1e-6;

std::string si_unit(Dimension dimension) {
  if (dimension == Dimension::JointPosition) return "rad (m)";
  const std::string units = units_of(dimension);
  return units.substr(0, units.find(','));
}

std::string range_text(const Range& range) {
  return range.text() == kAny.text() ? "" : range.text();
}

Json number_schema(Dimension dimension, const Range& range, Definitions& definitions) {
  Json schema = dimension == Dimension::None
                    ? Json{{"type", "number"}}
                    : quantity(name_of(dimension), units_of(dimension), definitions);
  if (!range_text(range).empty()) add_bounds(schema, range);
  return schema;
}

Json three_of(const Json& schema) {
  return {{"type", "array"}, {"items", schema}, {"minItems", 3}, {"maxItems", 3}};
}

/// A whole number in a text without sign of another kind, point or leading zeros.
template <class T>
bool read_whole(ReadContext& context, const Node& node, const std::string& path, T lower, T upper,
                const std::string& range, T& out) {
  T value = 0;
  const char* end = node.text.data() + node.text.size();
  const auto [stop, error] = std::from_chars(node.text.data(), end, value);
  const bool is_whole =
      node.kind == Node::Kind::Plain && error == std::errc() && stop == end &&
      (node.text.size() == 1 || scan_number(node.text).result == Scanned::Result::Good);
  if (is_whole && value >= lower && value <= upper) {
    out = value;
    return true;
  }
  context.add(
      node.line, is_whole ? "out-of-range" : "wrong-type",
      fmt::format("{}: {} is not allowed; must be an integer in {}", path, describe(node), range));
  return false;
}

}  // namespace

bool Number::read(ReadContext& context, const Node& node, const std::string& path) {
  const auto value = read_number(context, node, path, dimension_, range_);
  if (value) x_.set(*value);
  return value.has_value();
}

Shape Number::shape(Definitions& definitions) {
  return {number_schema(dimension_, range_, definitions),
          dimension_ == Dimension::None ? "1" : si_unit(dimension_), range_text(range_)};
}

bool Integer::read(ReadContext& context, const Node& node, const std::string& path) {
  int value = 0;
  if (!read_whole(context, node, path, lower_, upper_, fmt::format("[{}, {}]", lower_, upper_),
                  value)) {
    return false;
  }
  if (int_ != nullptr) {
    *int_ = value;
  } else {
    *long_ = value;
  }
  return true;
}

Shape Integer::shape(Definitions&) {
  return {{{"type", "integer"}, {"minimum", lower_}, {"maximum", upper_}},
          "",
          fmt::format("in [{}, {}]", lower_, upper_)};
}

bool Seed::read(ReadContext& context, const Node& node, const std::string& path) {
  return read_whole<std::uint64_t>(context, node, path, 0, ~std::uint64_t{0}, "[0, 2^64 - 1]", x_);
}

Shape Seed::shape(Definitions&) { return {{{"type", "integer"}, {"minimum", 0}}}; }

bool Flag::read(ReadContext& context, const Node& node, const std::string& path) {
  if (node.kind != Node::Kind::Plain || (node.text != "true" && node.text != "false")) {
    context.add(node.line, "wrong-type",
                fmt::format("{}: {} is not allowed; must be true or false", path, describe(node)));
    return false;
  }
  x_ = node.text == "true";
  return true;
}

Shape Flag::shape(Definitions&) { return {{{"type", "boolean"}}}; }

bool Text::read(ReadContext& context, const Node& node, const std::string& path) {
  const auto text = read_text(context, node, path);
  if (!text) return false;
  x_ = *text;
  return what_.empty() || check_name(context, node.line, path, x_, names_, what_.c_str());
}

Shape Text::shape(Definitions&) {
  if (names_.empty()) return {{{"type", "string"}}};
  return {{{"enum", Json(names_)}}};
}

bool Exactly::read(ReadContext& context, const Node& node, const std::string& path) {
  const auto text = read_text(context, node, path);
  if (!text) return false;
  if (*text == text_) return true;
  context.add(node.line, "format", fmt::format("{}: is '{}'; must be '{}'", path, *text, text_));
  return false;
}

Shape Exactly::shape(Definitions&) { return {{{"const", text_}}}; }

bool WordValue::read(ReadContext& context, const Node& node, const std::string& path) {
  const auto word = read_text(context, node, path);
  if (!word || !check_name(context, node.line, path, *word, words_, "allowed")) return false;
  choose(static_cast<std::size_t>(std::find(words_.begin(), words_.end(), *word) - words_.begin()));
  return true;
}

Shape WordValue::shape(Definitions&) { return {{{"enum", Json(words_)}}}; }

bool Vector::read(ReadContext& context, const Node& node, const std::string& path) {
  std::optional<Vector3d> value;
  if (kind_ == VectorKind::Direction) {
    value = read_direction(context, node, path);
  } else if (kind_ == VectorKind::Unit) {
    value = read_unit_vector(context, node, path);
  } else if (const auto x = read_numbers(context, node, path, dimension_, 3, range_)) {
    value = Vector3d((*x)[0], (*x)[1], (*x)[2]);
  }
  if (value) x_.set(*value);
  return value.has_value();
}

Shape Vector::shape(Definitions& definitions) {
  const char* range = kind_ == VectorKind::Any         ? ""
                      : kind_ == VectorKind::Direction ? "any length but zero"
                                                       : "norm 1, to 1e-6";
  return {three_of(number_schema(dimension_, range_, definitions)),
          dimension_ == Dimension::None ? "" : si_unit(dimension_),
          kind_ == VectorKind::Any ? range_text(range_) : range};
}

bool Deviation::read(ReadContext& context, const Node& node, const std::string& path) {
  if (!Scalar::looks_like_one(node)) return Vector::read(context, node, path);
  double value = 0;
  if (!Number(value, dimension_, range_).read(context, node, path)) return false;
  x_.set(Vector3d::Constant(value));
  return true;
}

Shape Deviation::shape(Definitions& definitions) {
  const Json one = number_schema(dimension_, range_, definitions);
  return {{{"anyOf", Json::array({one, three_of(one)})}},
          dimension_ == Dimension::None ? "1" : si_unit(dimension_),
          range_text(range_)};
}

namespace {

void orientation_fields(Table& t, Eigen::Quaterniond& q) {
  const bool has_rpy = t.states("rpy", false);
  if (has_rpy) {
    Vector3d rpy = Vector3d::Zero();
    t("rpy", Vector(rpy, Dimension::Angle), "", {.need = Need::Required});
    q = rotation_rpy(rpy.x(), rpy.y(), rpy.z());
    return;
  }
  const bool has_axis = t.states("axis", false);
  if (has_axis || (t.reader() != nullptr && t.reader()->has("angle"))) {
    Vector3d axis = Vector3d::UnitZ();
    double angle = 0;
    t("axis", Vector(axis, VectorKind::Direction), "", {.need = Need::Required});
    t("angle", Number(angle, Dimension::Angle), "", {.need = Need::Required});
    q = rotation_exp(axis * angle);
    return;
  }
  const About required{.need = Need::Required};
  t("w", Number(q.w()), "", required);
  t("x", Number(q.x()), "", required);
  t("y", Number(q.y()), "", required);
  t("z", Number(q.z()), "", required);
}

}  // namespace

bool Orientation::read(ReadContext& context, const Node& node, const std::string& path) {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  if (!Map([&q](Table& t) { orientation_fields(t, q); }).read(context, node, path)) return false;
  if (!(std::abs(q.norm() - 1) <= kQuaternionTolerance)) {
    context.add(node.line, "not-unit",
                fmt::format("{}: the quaternion has norm {}; must be 1", path, q.norm()));
    return false;
  }
  constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
  if (std::abs(q.squaredNorm() - 1) > kRounding) q.normalize();
  x_.set(q);
  return true;
}

Shape Orientation::shape(Definitions& definitions) {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  return Map([&q](Table& t) { orientation_fields(t, q); }, {.name = "orientation"})
      .shape(definitions);
}

void format_fields(Table& t, const std::string& format) {
  int version = 1;
  t("format", Exactly(format), "", {.need = Need::Required});
  t("version", Integer(version, 1, 1), "", {.need = Need::Required});
}

void pose_fields(Table& t, Pose& pose, const std::string& what, const std::string& frame) {
  t("position", Vector(pose.position, Dimension::Length), "origin of " + what, {.frame = frame});
  t("orientation", Orientation(pose.orientation), "axes of " + what,
    {.frame = frame, .without = "identity"});
}

}  // namespace stillbase::io
