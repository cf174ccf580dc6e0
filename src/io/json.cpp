// The only file that knows nlohmann's JSON.
#include "io/json.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace stillbase::io {

namespace {

constexpr int kMaxDepth = 512;   ///< the functions below call themselves
constexpr std::size_t kFew = 4;  ///< keys of most objects

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

void add_text(std::string_view text, std::string& out) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return c >= 0x20 && c < 0x7F && c != '"' && c != '\\';
  });
  if (!is_plain) {
    out += Parsed(text).dump(-1, ' ', false, Parsed::error_handler_t::replace);
    return;
  }
  out += '"';
  out += text;
  out += '"';
}

/// How a document is laid out on one line.
struct Layout {
  std::string_view comma = ",", colon = ":";
  bool sorts_keys = false;
};

/// Appends the document on one line.
/// @param without keys that are left out where keys are sorted, not those of objects in it
void add_flat(const Json& json, const Layout& layout, std::string& out,
              std::initializer_list<std::string_view> without = {}) {
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
      out += json.text();
      return;
    case Json::Kind::Text:
      add_text(json.text(), out);
      return;
    case Json::Kind::Array:
    case Json::Kind::Object:
      break;
  }
  const bool is_sorted = layout.sorts_keys && json.is_object();
  std::vector<std::size_t> order;
  if (is_sorted) {
    const std::vector<std::string>& keys = json.keys();
    order.reserve(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (std::find(without.begin(), without.end(), keys[i]) == without.end()) order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&keys](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
  }
  const std::size_t size = is_sorted ? order.size() : json.size();
  out += json.is_array() ? '[' : '{';
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t place = is_sorted ? order[i] : i;
    if (i > 0) out += layout.comma;
    if (json.is_object()) {
      add_text(json.keys()[place], out);
      out += layout.colon;
    }
    add_flat(json.begin()[place], layout, out);
  }
  out += json.is_array() ? ']' : '}';
}

constexpr Layout kSpaced{", ", ": "};

/// At most the length on one line (quotes, escapes, whole numbers, true, false and null do not
/// count), or something above `most`.
std::size_t least_length(const Json& json, std::size_t most) {
  if (!json.is_structured()) return json.text().size();
  std::size_t length = 0;  // the brackets take as much as a comma behind the last one
  for (std::size_t i = 0; i < json.size() && length <= most; ++i) {
    if (json.is_object()) length += json.keys()[i].size() + kSpaced.colon.size();
    length += least_length(json.begin()[i], most) + kSpaced.comma.size();
  }
  return length;
}

void add_pretty(const Json& json, std::size_t depth, std::string& out) {
  constexpr std::size_t kLineLength = 100;
  const auto is_plain = [](const Json& value) { return !value.is_structured(); };
  const bool is_list = json.is_array() && std::all_of(json.begin(), json.end(), is_plain);
  if (!json.is_structured() || is_list) return add_flat(json, kSpaced, out);
  const std::size_t begin = out.size(), most = kLineLength - std::min(kLineLength, 2 * depth);
  if (least_length(json, most) <= most) {
    add_flat(json, kSpaced, out);
    if (out.size() <= begin + most) return;
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
    add_pretty(json.begin()[i], depth + 1, out);
  }
  out += '\n' + std::string(2 * depth, ' ');
  out += json.is_array() ? ']' : '}';
}

}  // namespace

Json::Json(double x) : kind_(Kind::Real), real_(x) {
  if (!std::isfinite(x)) {
    throw NotFiniteError("a number that is not finite cannot be written");
  }
  char digits[64];
  const char* const end = nlohmann::detail::to_chars(std::begin(digits), std::end(digits), x);
  digit_count_ = static_cast<std::size_t>(end - digits);
  std::copy_n(digits, digit_count_, digits_.begin());
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
  if (keys_.empty()) reserve(kFew);
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
  Json json = Json::object();
  json["w"] = q.w();
  json["x"] = q.x();
  json["y"] = q.y();
  json["z"] = q.z();
  return json;
}

std::string pretty(const Json& json) {
  std::string out;
  add_pretty(json, 0, out);
  out += '\n';
  return out;
}

bool is_json(std::string_view text) { return Parsed::accept(text); }

std::string canonical(const Json& json, std::initializer_list<std::string_view> without) {
  std::string out;
  add_flat(json, {.sorts_keys = true}, out, without);
  return out;
}

}  // namespace stillbase::io
