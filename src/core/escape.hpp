// Text inside XML: SVG, HTML, URDF.
#pragma once

#include <string>

namespace stillbase {

std::string escape_markup(const std::string& text);

}  // namespace stillbase
