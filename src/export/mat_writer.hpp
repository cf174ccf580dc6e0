// Variables of MATLAB's level 5 file format ("MAT-File Format", The MathWorks), little-endian and
// not compressed. Each function gives the bytes of one array; the pieces of a cell or structure
// have no names of their own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace stillbase::mat {

std::string real_array(const Eigen::MatrixXd& values, std::string_view name = {});
std::string logical(bool value, std::string_view name = {});
/// A row of characters. @param text UTF-8
std::string text_row(std::string_view text, std::string_view name = {});
/// A column of cells.
std::string cell_column(const std::vector<std::string>& cells, std::string_view name = {});
/// A column of structures.
/// @param keys as MATLAB permits them (see field_name())
/// @param rows per structure the arrays of its keys, in their order
std::string structure_column(const std::vector<std::string>& keys,
                             const std::vector<std::vector<std::string>>& rows,
                             std::string_view name = {});

/// A word as a field name: letters, digits and underscores, a letter first, at most 63.
std::string field_name(std::string_view word);

/// A file of these variables. @param about at most 116 bytes; begins with "MATLAB 5.0 MAT-file"
std::string file(const std::string& about, const std::vector<std::string>& variables);

}  // namespace stillbase::mat
