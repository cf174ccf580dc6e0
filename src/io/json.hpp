// JSON documents: values that are written and values that were parsed.
//
// The header includes no JSON library. nlohmann parses, and prints numbers, in json.cpp alone.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <stillbase/core/rotation.hpp>

namespace stillbase::io {

/// A text that is no JSON, or a value that is not of the kind that was asked for.
class JsonError : public std::runtime_error {
 public:
  explicit JsonError(const std::string& message, std::size_t at = 0)
      : std::runtime_error(message), byte(at) {}
  std::size_t byte;  ///< of a parse error: number of bytes read
};

/// A number that JSON cannot hold.
class NotFiniteError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// One JSON value. Objects keep the order of their keys.
///
/// A list in braces is an object when each element is a pair whose first part is text, otherwise an
/// array: Json{{"a", 1}, {"b", {1, 2}}}.
class Json {
 public:
  enum class Kind { Null, Bool, Integer, Unsigned, Real, Text, Array, Object };

  Json(std::nullptr_t = nullptr) {}
  Json(bool x) : kind_(Kind::Bool), integer_(x) {}
  template <std::integral T>
  Json(T x) : kind_(Kind::Integer), integer_(static_cast<std::int64_t>(x)) {
    if (std::unsigned_integral<T>) kind_ = Kind::Unsigned;
  }
  /// @throws NotFiniteError unless x is finite
  Json(double x);
  Json(std::string text) : kind_(Kind::Text), text_(std::move(text)) {}
  Json(std::string_view text) : Json(std::string(text)) {}
  Json(const char* text) : Json(std::string(text)) {}
  Json(std::initializer_list<Json> list);
  template <class T>
  Json(const std::vector<T>& list) : kind_(Kind::Array) {
    items_.reserve(list.size());
    for (const T& x : list) items_.emplace_back(x);
  }

  static Json array(std::initializer_list<Json> items = {});
  static Json object() { return Json(Kind::Object); }
  /// @throws JsonError
  static Json parse(std::string_view text);

  Kind kind() const { return kind_; }
  bool is_null() const { return kind_ == Kind::Null; }
  bool is_text() const { return kind_ == Kind::Text; }
  bool is_number() const { return kind_ >= Kind::Integer && kind_ <= Kind::Real; }
  bool is_array() const { return kind_ == Kind::Array; }
  bool is_object() const { return kind_ == Kind::Object; }
  bool is_structured() const { return kind_ >= Kind::Array; }

  // Elements of an array, values of an object.
  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  Json& back() { return items_.back(); }
  /// Makes an array of a null.
  void push_back(Json x);
  void reserve(std::size_t size) {
    items_.reserve(size);
    if (is_object()) keys_.reserve(size);
  }

  const std::vector<std::string>& keys() const {
    return keys_;
  }  ///< of an object, beside its values
  std::vector<std::pair<std::string, const Json&>> items() const;  ///< of an object
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  const Json* find(std::string_view key) const;  ///< null: there is none
  /// The value of a key, null when it is new; makes an object of a null.
  Json& operator[](std::string_view key);
  /// @throws JsonError when there is none
  const Json& at(std::string_view key) const;
  const Json& at(std::size_t i) const;
  void erase(std::string_view key);
  /// Takes over the keys and values of another object.
  void update(const Json& other);

  /// Of a text, and of a real number as it is printed.
  std::string_view text() const {
    return kind_ == Kind::Real ? std::string_view(digits_.data(), digit_count_)
                               : std::string_view(text_);
  }
  /// bool, a number, std::string, a std::vector of those, or the value itself.
  /// @throws JsonError for another kind of value, and for a whole number that T does not hold
  template <class T>
  T get() const {
    if constexpr (std::is_same_v<T, Json>) {
      return *this;
    } else if constexpr (std::is_same_v<T, bool>) {
      require(kind_ == Kind::Bool, "true or false");
      return integer_ != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      require(is_number(), "a number");
      if constexpr (std::is_integral_v<T>) require(holds<T>(), "a whole number in range");
      if (kind_ == Kind::Real) return static_cast<T>(real_);
      return kind_ == Kind::Integer ? static_cast<T>(integer_)
                                    : static_cast<T>(static_cast<std::uint64_t>(integer_));
    } else if constexpr (std::is_same_v<T, std::string>) {
      require(kind_ == Kind::Text, "text");
      return text_;
    } else {
      require(is_array(), "a list");
      T list;
      for (const Json& item : items_) list.push_back(item.get<typename T::value_type>());
      return list;
    }
  }
  /// The value of a key, or what stands for it when there is none.
  template <class T>
  T value(std::string_view key, T absent) const {
    const Json* found = find(key);
    return found == nullptr ? absent : found->get<T>();
  }
  std::string value(std::string_view key, const char* absent) const {
    return value(key, std::string(absent));
  }

  /// On one line without white space. Bytes that are not UTF-8 are replaced by U+FFFD.
  std::string dump() const;

  bool operator==(const Json& other) const;

 private:
  explicit Json(Kind kind) : kind_(kind) {}
  static void require(bool is_so, const char* wanted);  ///< @throws JsonError "a value is not ..."
  /// Whether the whole number T can have the value of this number.
  template <std::integral T>
  bool holds() const {
    if (kind_ == Kind::Integer) return std::in_range<T>(integer_);
    if (kind_ == Kind::Unsigned) return std::in_range<T>(static_cast<std::uint64_t>(integer_));
    constexpr auto kHalf = static_cast<double>(std::numeric_limits<T>::max() / 2 + 1);
    return real_ == std::trunc(real_) && real_ < 2 * kHalf &&
           real_ >= static_cast<double>(std::numeric_limits<T>::min());
  }

  Kind kind_ = Kind::Null;
  std::int64_t integer_ = 0;  ///< Bool, Integer, Unsigned (its bits)
  double real_ = 0;
  std::array<char, 24> digits_ = {};  ///< Real: printed; -2.2250738585072014e-308 needs them all
  std::size_t digit_count_ = 0;
  std::string text_;
  std::vector<std::string> keys_;  ///< Object: beside items_
  std::vector<Json> items_;
};

/// Elements of a vector as an array.
/// @throws NotFiniteError
Json array_json(const Eigen::Ref<const Eigen::VectorXd>& v);
/// {"w", "x", "y", "z"}
Json quaternion_json(const Eigen::Quaterniond& q);

/// Text of a document for people and programs: objects indented, arrays of plain values on one
/// line, a newline at the end.
std::string pretty(const Json& json);

/// Whether a text is one JSON document.
bool is_json(std::string_view text);

/// Text for fingerprints: keys sorted, no white space. Does not depend on how a file is laid out.
/// @param without keys of the document that are left out, not those of objects in it
std::string canonical(const Json& json, std::initializer_list<std::string_view> without = {});

}  // namespace stillbase::io
