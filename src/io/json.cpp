// The only file that knows nlohmann's JSON.
#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

namespace stillbase::io {

namespace {

constexpr int kMaxDepth = 512;  ///< the functions below call themselves

using Parsed = nlohmann::ordered_json;

Json json_of(const Parsed& parsed) {
  switch (parsed.type()) {
    case Parsed::value_t::boolean:
      return parsed.get<bool>();
    case Parsed::value_t::number_integer:
      return parsed.get<std::int64_t>();
    case Parsed::value_t::number_unsigned:
      return parsed.get<std::uint64_t>();
    case Parsed::value_t::number_float:
      return parsed.get<double>();
    case Parsed::value_t::string:
      return parsed.get_ref<const std::string&>();
    case Parsed::value_t::array: {
      Json array = Json::array();
      for (const Parsed& item : parsed) array.push_back(json_of(item));
      return array;
    }
    case Parsed::value_t::object: {
      Json object = Json::object();
      for (const auto& [key, item] : parsed.items()) object[key] = json_of(item);
      return object;
    }
    default:
      return nullptr;
  }
}

void add_text(const std::string& text, std::string& out) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return c >= 0x20 && c < 0x7F && c != '"' && c != '\\';
  });
  out += is_plain ? '"' + text + '"'
                  : Parsed(text).dump(-1, ' ', false, Parsed::error_handler_t::replace);
}

void add_real(double x, std::string& out) {
  char digits[64];
  out.append(digits, nlohmann::detail::to_chars(std::begin(digits), std::end(digits), x));
}

/// How a document is laid out on one line.
struct Layout {
  const char *comma = ",", *colon = ":";
  bool sorts_keys = false;
};

/// Appends the document on one line.
/// @param most length of `out` beyond which the rest may be left out
void add_flat(const Json& json, const Layout& layout, std::string& out,
              std::size_t most = std::string::npos) {
  switch (json.kind()) {
    case Json::Kind::Null:
      out += "null";
      return;
    case Json::Kind::Bool:
      out += json.get<bool>() ? "true" : "false";
      return;
    case Json::Kind::Integer:
      out += std::to_string(json.get<std::int64_t>());
      return;
    case Json::Kind::Unsigned:
      out += std::to_string(json.get<std::uint64_t>());
      return;
    case Json::Kind::Real:
      add_real(json.get<double>(), out);
      return;
    case Json::Kind::Text:
      add_text(json.get<std::string>(), out);
      return;
    case Json::Kind::Array:
    case Json::Kind::Object:
      break;
  }
  std::vector<std::size_t> order;
  if (layout.sorts_keys && json.is_object()) {
    order.resize(json.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&json](std::size_t a, std::size_t b) { return json.keys()[a] < json.keys()[b]; });
  }
  out += json.is_array() ? '[' : '{';
  for (std::size_t i = 0; i < json.size() && out.size() <= most; ++i) {
    const std::size_t place = order.empty() ? i : order[i];
    if (i > 0) out += layout.comma;
    if (json.is_object()) {
      add_text(json.keys()[place], out);
      out += layout.colon;
    }
    add_flat(json.at(place), layout, out, most);
  }
  out += json.is_array() ? ']' : '}';
}

void add_pretty(const Json& json, std::size_t depth, std::string& out) {
  constexpr Layout kSpaced{", ", ": "};
  constexpr std::size_t kLineLength = 100;
  const auto is_plain = [](const Json& value) { return !value.is_structured(); };
  const bool is_list = json.is_array() && std::all_of(json.begin(), json.end(), is_plain);
  if (!json.is_structured() || is_list) return add_flat(json, kSpaced, out);
  if (2 * depth < kLineLength) {
    const std::size_t begin = out.size(), most = begin + kLineLength - 2 * depth;
    add_flat(json, kSpaced, out, most);
    if (out.size() <= most) return;
    out.resize(begin);
  }
  const std::string indent(2 * (depth + 1), ' ');
  out += json.is_array() ? "[\n" : "{\n";
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (i > 0) out += ",\n";
    out += indent;
    if (json.is_object()) {
      add_text(json.keys()[i], out);
      out += kSpaced.colon;
    }
    add_pretty(json.at(i), depth + 1, out);
  }
  out += '\n' + std::string(2 * depth, ' ');
  out += json.is_array() ? ']' : '}';
}

}  // namespace

Json::Json(double x) : kind_(Kind::Real), real_(x) {
  if (!std::isfinite(x)) {
    throw NotFiniteError("a number that is not finite cannot be written");
  }
}

Json::Json(std::initializer_list<Json> list) : kind_(Kind::Array) {
  const bool is_object = std::all_of(list.begin(), list.end(), [](const Json& item) {
    return item.is_array() && item.size() == 2 && item.items_[0].is_text();
  });
  if (!is_object) {
    items_ = list;
    return;
  }
  kind_ = Kind::Object;
  for (const Json& item : list) (*this)[item.items_[0].text_] = item.items_[1];
}

Json Json::array(std::initializer_list<Json> items) {
  Json array(Kind::Array);
  array.items_ = items;
  return array;
}

Json Json::parse(std::string_view text) {
  try {
    return json_of(Parsed::parse(text, [](int depth, Parsed::parse_event_t, Parsed&) {
      if (depth > kMaxDepth) throw JsonError("nested too deep");
      return true;
    }));
  } catch (const Parsed::parse_error& error) {
    throw JsonError(error.what(), error.byte);
  } catch (const Parsed::exception& error) {
    throw JsonError(error.what());
  }
}

void Json::push_back(Json x) {
  if (is_null()) kind_ = Kind::Array;
  items_.push_back(std::move(x));
}

std::vector<std::pair<std::string, const Json&>> Json::items() const {
  std::vector<std::pair<std::string, const Json&>> out;
  for (std::size_t i = 0; i < keys_.size(); ++i) out.emplace_back(keys_[i], items_[i]);
  return out;
}

const Json* Json::find(std::string_view key) const {
  const auto at = std::find(keys_.begin(), keys_.end(), key);
  return at == keys_.end() ? nullptr : &items_[static_cast<std::size_t>(at - keys_.begin())];
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) kind_ = Kind::Object;
  if (const Json* found = find(key)) return const_cast<Json&>(*found);
  keys_.emplace_back(key);
  return items_.emplace_back();
}

const Json& Json::at(std::string_view key) const {
  const Json* found = find(key);
  if (found == nullptr) throw JsonError("key '" + std::string(key) + "' not found");
  return *found;
}

const Json& Json::at(std::size_t i) const {
  if (i >= items_.size()) throw JsonError("there is no element " + std::to_string(i));
  return items_[i];
}

void Json::erase(std::string_view key) {
  const auto at = std::find(keys_.begin(), keys_.end(), key);
  if (at == keys_.end()) return;
  items_.erase(items_.begin() + (at - keys_.begin()));
  keys_.erase(at);
}

void Json::update(const Json& other) {
  for (std::size_t i = 0; i < other.size(); ++i) (*this)[other.keys_[i]] = other.items_[i];
}

void Json::require(bool is_so, const char* wanted) {
  if (!is_so) throw JsonError(std::string("a value is not ") + wanted);
}

std::string Json::dump() const {
  std::string out;
  add_flat(*this, {}, out);
  return out;
}

bool Json::operator==(const Json& other) const {
  if (is_number() && other.is_number()) return get<double>() == other.get<double>();
  return kind_ == other.kind_ && integer_ == other.integer_ && text_ == other.text_ &&
         keys_ == other.keys_ && items_ == other.items_;
}

Json array_json(const Eigen::Ref<const Eigen::VectorXd>& v) {
  Json array = Json::array();
  array.reserve(static_cast<std::size_t>(v.size()));
  for (const double x : v) array.push_back(x);
  return array;
}

Json quaternion_json(const Eigen::Quaterniond& q) {
  return {{"w", q.w()}, {"x", q.x()}, {"y", q.y()}, {"z", q.z()}};
}

std::string pretty(const Json& json) {
  std::string out;
  add_pretty(json, 0, out);
  return out + '\n';
}

bool is_json(std::string_view text) { return Parsed::accept(text); }

std::string canonical(const Json& json) {
  std::string out;
  add_flat(json, {.sorts_keys = true}, out);
  return out;
}

}  // namespace stillbase::io
