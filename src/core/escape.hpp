// Text inside XML (SVG, HTML, URDF) and comma-separated values.
#pragma once

#include <string>

namespace stillbase {

std::string escape_markup(const std::string& text);

/// A field of RFC 4180: quoted where a comma, a quote or an end of line makes it necessary.
std::string csv_field(const std::string& text);

}  // namespace stillbase
