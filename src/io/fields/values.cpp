#include "io/fields/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <stillbase/core/rotation.hpp>

#include "core/covariance.hpp"
#include "io/field_reader.hpp"
#include "io/fields/describer.hpp"

namespace stillbase::io {

namespace {

constexpr double kQuaternionTolerance = 1e-6;

std::string si_unit(Dimension dimension) {
  if (dimension == Dimension::JointPosition) return "rad (m)";
  const std::string units = units_of(dimension);
  return units.substr(0, units.find(','));
}

bool is_list(const Node& node) { return node.kind == Node::Kind::Sequence; }

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

/// Schemas are made with a robot without joints: what is empty then has one number per joint.
std::string extent_text(long size) { return size == 0 ? "n" : std::to_string(size); }

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

Number::Number(Slot<double> x, Dimension dimension, Range range) {
  read = [=](ReadContext& context, const Node& node, const std::string& path) {
    const auto value = read_number(context, node, path, dimension, range);
    if (value) x.set(*value);
    return value.has_value();
  };
  write = [x]() -> Json { return x.get(); };
  is_written = x.has();
  shape = [=](Definitions& definitions) -> Shape {
    return {number_schema(dimension, range, definitions),
            dimension == Dimension::None ? "1" : si_unit(dimension), range_text(range)};
  };
}

Integer::Integer(int lower, int upper, const std::function<Json()>& get,
                 const std::function<void(int)>& set) {
  read = [=](ReadContext& context, const Node& node, const std::string& path) {
    int value = 0;
    const std::string range = fmt::format("[{}, {}]", lower, upper);
    if (!read_whole(context, node, path, lower, upper, range, value)) return false;
    set(value);
    return true;
  };
  write = get;
  shape = [lower, upper](Definitions&) -> Shape {
    const bool is_bounded = upper < std::numeric_limits<int>::max() - 1;
    return {{{"type", "integer"}, {"minimum", lower}, {"maximum", upper}},
            "",
            is_bounded ? fmt::format("in [{}, {}]", lower, upper) : fmt::format(">= {}", lower)};
  };
}

Seed::Seed(std::uint64_t& x) {
  read = [&x](ReadContext& context, const Node& node, const std::string& path) {
    const std::string range = "[0, 2^64 - 1]";
    return read_whole<std::uint64_t>(context, node, path, 0, ~std::uint64_t{0}, range, x);
  };
  write = [&x]() -> Json { return x; };
  shape = [](Definitions&) -> Shape { return {{{"type", "integer"}, {"minimum", 0}}}; };
}

Flag::Flag(bool& x) {
  read = [&x](ReadContext& context, const Node& node, const std::string& path) {
    const bool is_flag =
        node.kind == Node::Kind::Plain && (node.text == "true" || node.text == "false");
    if (is_flag) {
      x = node.text == "true";
    } else {
      context.add(
          node.line, "wrong-type",
          fmt::format("{}: {} is not allowed; must be true or false", path, describe(node)));
    }
    return is_flag;
  };
  write = [&x]() -> Json { return x; };
  shape = [](Definitions&) -> Shape { return {{{"type", "boolean"}}}; };
}

Text::Text(std::string& x, const std::vector<std::string>& names, const std::string& what) {
  read = [&x, names, what](ReadContext& context, const Node& node, const std::string& path) {
    const auto text = read_text(context, node, path);
    if (!text) return false;
    x = *text;
    return what.empty() || check_name(context, node.line, path, x, names, what.c_str());
  };
  write = [&x]() -> Json { return x; };
  shape = [names](Definitions&) -> Shape {
    if (names.empty()) return {{{"type", "string"}}};
    return {{{"enum", Json(names)}}};
  };
}

Exactly::Exactly(const std::string& text) {
  read = [text](ReadContext& context, const Node& node, const std::string& path) {
    const auto stated = read_text(context, node, path);
    if (!stated || *stated == text) return stated.has_value();
    context.add(node.line, "format", fmt::format("{}: is '{}'; must be '{}'", path, *stated, text));
    return false;
  };
  write = [text]() -> Json { return text; };
  shape = [text](Definitions&) -> Shape { return {{{"const", text}}}; };
}

Word::Word(std::vector<std::string> list, std::function<void(std::size_t)> choose_word,
           const std::function<std::string()>& now) {
  read = [list, choose_word](ReadContext& context, const Node& node, const std::string& path) {
    const auto word = read_text(context, node, path);
    if (!word || !check_name(context, node.line, path, *word, list, "allowed")) return false;
    choose_word(
        static_cast<std::size_t>(std::find(list.begin(), list.end(), *word) - list.begin()));
    return true;
  };
  write = [now]() -> Json { return now(); };
  shape = [list](Definitions&) -> Shape { return {{{"enum", Json(list)}}}; };
  words = std::move(list);
  choose = std::move(choose_word);
}

Vector::Vector(Slot<Vector3d> x, Dimension dimension, Range range, VectorKind kind) {
  read = [=](ReadContext& context, const Node& node, const std::string& path) {
    std::optional<Vector3d> value;
    if (kind == VectorKind::Direction) {
      value = read_direction(context, node, path);
    } else if (kind == VectorKind::Unit) {
      value = read_unit_vector(context, node, path);
    } else {
      value = read_vector3(context, node, path, dimension, range);
    }
    if (value) x.set(*value);
    return value.has_value();
  };
  write = [x] { return array_json(x.get()); };
  is_written = x.has();
  shape = [=](Definitions& definitions) -> Shape {
    return {three_of(number_schema(dimension, range, definitions)),
            dimension == Dimension::None ? "" : si_unit(dimension),
            kind == VectorKind::Any         ? range_text(range)
            : kind == VectorKind::Direction ? "any length but zero"
                                            : "norm 1, to 1e-6",
            {},
            "3"};
  };
  fits = is_list;
}

Deviation::Deviation(Slot<Vector3d> x, Dimension dimension, Range range)
    : Value(Vector(x, dimension, range)) {
  read = [=, vector = read](ReadContext& context, const Node& node, const std::string& path) {
    if (!is_scalar(node)) return vector(context, node, path);
    const auto value = read_number(context, node, path, dimension, range);
    if (value) x.set(Vector3d::Constant(*value));
    return value.has_value();
  };
  shape = [=](Definitions& definitions) -> Shape {
    const Json one = number_schema(dimension, range, definitions);
    return {{{"anyOf", Json::array({one, three_of(one)})}},
            dimension == Dimension::None ? "1" : si_unit(dimension),
            range_text(range),
            {},
            "3"};
  };
}

Numbers::Numbers(int size, const std::function<std::vector<double>()>& get,
                 const std::function<void(const std::vector<double>&)>& set) {
  read = [=](ReadContext& context, const Node& node, const std::string& path) {
    const auto values = read_numbers(context, node, path, Dimension::None, size);
    if (values) set(*values);
    return values.has_value();
  };
  write = [get] { return Json(get()); };
  shape = [size](Definitions&) -> Shape {
    Json schema{{"type", "array"}, {"items", {{"type", "number"}}}};
    if (size > 0) schema.update({{"minItems", size}, {"maxItems", size}});
    return {schema, {}, {}, {}, size < 0 ? "k" : extent_text(size)};
  };
  fits = is_list;
}

namespace {

const Range kCovarianceRange{.lower = -kFastest * kFastest, .upper = kFastest * kFastest};

}  // namespace

Covariance::Covariance(Matrix6d& x) {
  read = [&x](ReadContext& context, const Node& node, const std::string& path) {
    if (node.kind != Node::Kind::Sequence) {
      context.add(node.line, "wrong-type",
                  fmt::format("{}: {} is not a list of 6 rows of 6 numbers", path, describe(node)));
      return false;
    }
    if (node.items.size() != 6) {
      context.add(
          node.line, "wrong-length",
          fmt::format("{}: has {} rows; must have 6 of 6 numbers", path, node.items.size()));
      return false;
    }
    Matrix6d A;
    bool is_read = true;
    for (int i = 0; i < 6; ++i) {
      const auto row =
          read_numbers(context, node.items[static_cast<std::size_t>(i)],
                       fmt::format("{}[{}]", path, i), Dimension::None, 6, kCovarianceRange);
      is_read = is_read && row.has_value();
      if (row) A.row(i) = Eigen::Map<const Vector6d>(row->data()).transpose();
    }
    if (!is_read) return false;
    if (const auto objection = covariance_objection(A)) {
      context.add(node.items[static_cast<std::size_t>(objection->row)].line, "not-a-covariance",
                  path + objection->text);
      return false;
    }
    x = (A + A.transpose()) / 2;
    return true;
  };
  write = [&x] {
    Json rows = Json::array();
    for (const auto& row : x.rowwise()) rows.push_back(array_json(row.transpose()));
    return rows;
  };
  shape = [](Definitions& definitions) -> Shape {
    const Json row{{"type", "array"},
                   {"items", number_schema(Dimension::None, kCovarianceRange, definitions)},
                   {"minItems", 6},
                   {"maxItems", 6}};
    return {
        {{"type", "array"}, {"items", row}, {"minItems", 6}, {"maxItems", 6}}, {}, {}, {}, "6 x 6"};
  };
  fits = is_list;
}

Rows::Rows(const Eigen::MatrixXd& matrix) {
  read = [](ReadContext&, const Node&, const std::string&) { return false; };
  write = [matrix] {
    Json rows = Json::array();
    for (const auto& row : matrix.rowwise()) rows.push_back(array_json(row.transpose()));
    return rows;
  };
  shape = [matrix](Definitions&) -> Shape {
    const Json row{{"type", "array"}, {"items", {{"type", "number"}}}};
    return {{{"type", "array"}, {"items", row}},
            {},
            {},
            {},
            extent_text(matrix.rows()) + " x " + extent_text(matrix.cols())};
  };
  fits = is_list;
}

namespace {

void orientation_fields(Table& t, Eigen::Quaterniond& q) {
  if (t.states("rpy", false)) {
    Vector3d rpy = Vector3d::Zero();
    t("rpy", Vector(rpy, Dimension::Angle), "", kNeeded);
    q = rotation_rpy(rpy.x(), rpy.y(), rpy.z());
    return;
  }
  const bool has_axis = t.states("axis", false);
  if (has_axis || (t.reader() != nullptr && t.reader()->has("angle"))) {
    Vector3d axis = Vector3d::UnitZ();
    double angle = 0;
    t("axis", Vector(axis, VectorKind::Direction), "", kNeeded);
    t("angle", Number(angle, Dimension::Angle), "", kNeeded);
    q = rotation_exp(axis * angle);
    return;
  }
  t("w", Number(q.w()), "", kNeeded);
  t("x", Number(q.x()), "", kNeeded);
  t("y", Number(q.y()), "", kNeeded);
  t("z", Number(q.z()), "", kNeeded);
}

}  // namespace

Orientation::Orientation(Slot<Eigen::Quaterniond> x) {
  read = [x](ReadContext& context, const Node& node, const std::string& path) {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    if (!Map([&q](Table& t) { orientation_fields(t, q); }).read(context, node, path)) return false;
    if (!(std::abs(q.norm() - 1) <= kQuaternionTolerance)) {
      context.add(node.line, "not-unit",
                  fmt::format("{}: the quaternion has norm {}; must be 1", path, q.norm()));
      return false;
    }
    constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
    if (std::abs(q.squaredNorm() - 1) > kRounding) q.normalize();
    x.set(q);
    return true;
  };
  write = [x] { return quaternion_json(x.get()); };
  is_written = x.has();
  shape = [](Definitions& definitions) {
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    return Map([&q](Table& t) { orientation_fields(t, q); }, {.name = "orientation"})
        .shape(definitions);
  };
  fits = [](const Node& node) { return node.kind == Node::Kind::Map; };
}

void format_fields(Table& t, const std::string& format) {
  int version = 1;
  t("format", Exactly(format), "`" + format + "`", kNeeded);
  t("version", Integer(version, 1, 1), "of the format", kNeeded);
}

void pose_fields(Table& t, Pose& pose, const std::string& what, const std::string& frame,
                 const Range& places) {
  t("position", Vector(pose.position, Dimension::Length, places), "origin of " + what,
    {.frame = frame});
  t("orientation", Orientation(pose.orientation), "axes of " + what,
    {.frame = frame, .without = "identity"});
}

}  // namespace stillbase::io
