// JSON pieces that several files share. Every number is checked: nlohmann writes null for NaN and
// infinity without a word.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <stillbase/core/rotation.hpp>

namespace stillbase::io {

using Json = nlohmann::ordered_json;

/// A number that JSON cannot hold.
class NotFiniteError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// @throws NotFiniteError unless x is finite
Json number_json(double x);
/// Elements of a vector as an array.
Json array_json(const Eigen::Ref<const Eigen::VectorXd>& v);
/// {"w", "x", "y", "z"}
Json quaternion_json(const Eigen::Quaterniond& q);
/// {"position", "orientation"}
Json pose_json(const Pose& pose);

/// Text of a document for people and programs: objects indented, arrays of plain values on one
/// line, a newline at the end.
std::string pretty(const Json& json);

/// Whether a text is one JSON document.
bool is_json(std::string_view text);

/// Text for fingerprints: keys sorted, no white space. Does not depend on how a file is laid out.
std::string canonical(const Json& json);

}  // namespace stillbase::io
