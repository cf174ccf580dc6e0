// Python objects as the tree that file readers take, written tables as Python objects, and numbers
// as numpy arrays.
#pragma once

#include <string>
#include <string_view>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stillbase/core/types.hpp>

#include "io/fields/table.hpp"

namespace stillbase::python {

namespace py = pybind11;

/// Numbers from Python, in rows; converted when they are of another type or layout.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// (key, value) of what is read as a map: a dict, another Mapping, a dataclass or a
/// SimpleNamespace. Null for other objects.
py::object items_of(py::handle object);

/// What items_of() knows as a map; lists, tuples and arrays as sequences; numbers,
/// texts, paths, booleans and None as a file would state them. Has no lines. What no file can
/// state, and what is nested too deeply, is a finding of the context.
io::Node node_of(py::handle object, io::ReadContext& context, const std::string& path = "");

/// Reads an object by the table of a file format, as a file would be read.
/// @throws InputError with every finding
void read_object(py::handle object, const std::string& source, const io::TableBody& body);

/// A JSON value as dict, list, str, float, int, bool or None. Lists of numbers become arrays, lists
/// of rows of one length arrays of two dimensions.
py::object python_of(const io::Json& json);
/// The object that a table writes.
py::object python_of(const io::TableBody& body);

/// @throws std::invalid_argument unless the array has this many finite numbers
Eigen::VectorXd vector_of(const Numbers& array, Eigen::Index size, const char* name);
/// @throws std::invalid_argument unless the array has this shape and finite numbers
Eigen::MatrixXd matrix_of(const Numbers& array, Eigen::Index rows, Eigen::Index columns,
                          const char* name);
/// Rows (k, n), or one row for all of them. @param count of rows; < 0: any, the array must be (k,
/// n)
/// @throws std::invalid_argument for other shapes and for numbers that are not finite
Eigen::MatrixXd rows_of(const Numbers& array, Eigen::Index count, Eigen::Index columns,
                        const char* name);

/// @throws std::invalid_argument unless all numbers of a result are finite: those that were given
/// are, but so large that the result is beyond the range of a double
template <class Derived>
void check_range(const Eigen::MatrixBase<Derived>& result) {
  if ((0 * result).sum() == 0) return;
  throw std::invalid_argument("the numbers are so large that the answer is not finite");
}

/// A new array, of one dimension for vectors.
template <class Derived>
py::array array_of(const Eigen::MatrixBase<Derived>& matrix) {
  if constexpr (Derived::ColsAtCompileTime == 1) {
    py::array_t<double> out(matrix.size());
    Eigen::Map<Eigen::VectorXd>(out.mutable_data(), matrix.size()) = matrix;
    return out;
  } else {
    py::array_t<double, py::array::f_style> out({matrix.rows(), matrix.cols()});
    Eigen::Map<Eigen::MatrixXd>(out.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
    return out;
  }
}

/// Numbers of a C++ object as an array that cannot be written. @param owner keeps them alive
py::array view_of(const double* data, py::array::ShapeContainer shape,
                  py::array::StridesContainer strides, py::handle owner);

/// A matrix or vector within an object, not copied.
template <class Derived>
py::array view_of(const Eigen::PlainObjectBase<Derived>& matrix, py::handle owner) {
  constexpr py::ssize_t kSize = sizeof(double);
  if constexpr (Derived::ColsAtCompileTime == 1) {
    return view_of(matrix.data(), {matrix.size()}, {kSize}, owner);
  } else {
    return view_of(matrix.data(), {matrix.rows(), matrix.cols()}, {kSize, kSize * matrix.rows()},
                   owner);
  }
}

/// One row for each element of a list, not copied: the numbers that `part` finds in an element.
/// The first element decides how many there are.
template <class T, class Part>
py::array views_of(const std::vector<T>& list, const Part& part, py::handle owner) {
  if (list.empty()) return py::array_t<double>(std::vector<py::ssize_t>{0, 0});
  const auto& first = part(list.front());
  return view_of(first.data(), {list.size(), static_cast<std::size_t>(first.size())},
                 {sizeof(T), sizeof(double)}, owner);
}

}  // namespace stillbase::python
