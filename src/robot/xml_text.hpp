// The bytes of an XML file as UTF-8.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "robot/urdf_findings.hpp"

namespace stillbase::urdf {

/// The text in UTF-8 where a file has another encoding: UTF-16 with a byte order mark, ISO 8859-1
/// or Windows 1252 where its declaration says so. In other files bytes of comments that are no
/// UTF-8 become question marks: they mean nothing to the robot. A remark says what was done.
/// @return nothing: the text is used as it is
std::optional<std::string> as_utf8(std::string_view text, Findings& findings);

/// The text with blanks in place of processing instructions, among them the declaration: a parser
/// that takes them at the very beginning alone reads it, with the same lines.
std::string without_instructions(std::string_view text);

}  // namespace stillbase::urdf
