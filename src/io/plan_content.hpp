// What the fingerprint of a plan file covers.
#pragma once

#include <string>

#include "io/json.hpp"

namespace stillbase::io {

/// SHA-256 of a plan document without `tool`, `timing`, `verification` and `content_sha256`.
std::string content_sha256(Json document);

}  // namespace stillbase::io
