// What the readers of mesh files share: lines, words and numbers of a text.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace stillbase {

/// Largest coordinate that a mesh file may state, in its own unit, which a scale may make smaller:
/// a kilometre in micrometres.
inline constexpr double kMaxMeshCoordinate = 1e9;

/// @throws std::runtime_error more than kMaxMeshTriangles
void check_triangle_count(std::size_t count);

/// The text behind the mark of UTF-8 that some editors begin a file with.
std::string_view without_byte_order_mark(std::string_view text);

/// Which line of a text a place in it is in, from 1.
int line_of(std::string_view text, const char* place);

/// "line 7: ...", of the line of a text that a place is in.
std::runtime_error at_line(std::string_view text, const char* place, const std::string& message);

/// What is wrong with a coordinate of a vertex; empty: nothing.
std::string coordinate_fault(double value);

/// Takes the next word off a text, what stands between blanks or ends of lines; empty at the end.
std::string_view take_word(std::string_view& text);

/// A word as a number, which may be infinite or none.
/// @throws std::runtime_error it is no number
double number_in(std::string_view word);

/// A word as a coordinate of a vertex, rounded to single precision as in the binary formats.
/// @throws std::runtime_error it is no number, or see coordinate_fault()
double coordinate_in(std::string_view word);

}  // namespace stillbase
