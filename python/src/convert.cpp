#include "convert.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace stillbase::python {

namespace {

class TreeBuilder {
 public:
  explicit TreeBuilder(io::ReadContext& context) : context_(context) {}

  io::Node build(py::handle object, const std::string& path, int depth) {
    if (depth > limits_.depth) {
      fail(path, "too-deep", fmt::format("nested deeper than {} levels", limits_.depth));
    }
    if (++count_ > limits_.nodes) {
      fail(path, "too-large", fmt::format("more than {} values", limits_.nodes));
    }
    io::Node node;
    if (object.is_none()) return node;
    if (py::isinstance<py::str>(object)) {
      return scalar(io::Node::Kind::Quoted, object.cast<std::string>());
    }
    if (PyBool_Check(object.ptr()) || py::isinstance(object, bool_)) {
      return scalar(io::Node::Kind::Plain, object.cast<bool>() ? "true" : "false");
    }
    if (PyFloat_Check(object.ptr()) || py::isinstance(object, floating_)) {
      return scalar(io::Node::Kind::Plain, fmt::format("{}", object.cast<double>()));
    }
    if (py::hasattr(object, "tolist")) {  // arrays, and the other numbers of numpy
      // Some numbers of numpy give themselves, a mock gives a mock: neither has an end.
      const py::object plain = object.attr("tolist")();
      if (py::isinstance(plain, floating_) || !py::hasattr(plain, "tolist")) {
        return build(plain, path, depth);
      }
      return refuse_type(object, path);
    }
    if (PyLong_Check(object.ptr())) {
      return scalar(io::Node::Kind::Plain, py::str(object).cast<std::string>());
    }
    if (const py::object items = items_of(object)) return map(items, path, depth);
    if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
      node.kind = io::Node::Kind::Sequence;
      for (const py::handle item : object) {
        node.items.push_back(
            build(item, fmt::format("{}[{}]", path, node.items.size()), depth + 1));
      }
      return node;
    }
    if (py::hasattr(object, "__fspath__")) {
      return scalar(io::Node::Kind::Quoted,
                    py::module_::import("os").attr("fspath")(object).cast<std::string>());
    }
    return refuse_type(object, path);
  }

 private:
  static io::Node scalar(io::Node::Kind kind, std::string text) {
    io::Node node;
    node.kind = kind;
    node.text = std::move(text);
    return node;
  }

  io::Node map(const py::object& items, const std::string& path, int depth) {
    io::Node node;
    node.kind = io::Node::Kind::Map;
    for (const py::handle entry : items) {
      const auto pair = entry.cast<py::tuple>();
      if (!py::isinstance<py::str>(pair[0])) {
        refuse(path, "wrong-type",
               fmt::format("the key {} must be text", py::repr(pair[0]).cast<std::string>()));
        continue;
      }
      const auto key = pair[0].cast<std::string>();
      node.items.push_back(build(pair[1], path.empty() ? key : path + "." + key, depth + 1));
      node.keys.push_back(key);
      node.key_lines.push_back(0);
    }
    return node;
  }

  io::Node refuse_type(py::handle object, const std::string& path) {
    refuse(path, "wrong-type",
           fmt::format("an object of type {} is nothing that a file can state",
                       Py_TYPE(object.ptr())->tp_name));
    return {};
  }
  void refuse(const std::string& path, const char* rule, const std::string& what) {
    context_.add(0, rule, path.empty() ? what : path + ": " + what);
  }
  [[noreturn]] void fail(const std::string& path, const char* rule, const std::string& what) {
    refuse(path, rule, what);
    throw InputError(context_.findings);
  }

  io::ReadContext& context_;
  const io::DocumentLimits limits_;
  const py::object bool_ = py::module_::import("numpy").attr("bool_");
  const py::object floating_ = py::module_::import("numpy").attr("floating");
  std::size_t count_ = 0;
};

/// All items are numbers. @param are_whole whether all are whole
bool are_numbers(const io::Json& list, bool& are_whole) {
  for (const io::Json& item : list) {
    if (!item.is_number()) return false;
    are_whole = are_whole && item.kind() != io::Json::Kind::Real;
  }
  return !list.empty();
}

/// Rows of numbers of one length.
bool are_rows(const io::Json& list) {
  for (const io::Json& row : list) {
    bool are_whole = true;
    if (!row.is_array() || row.size() != list.begin()->size() || !are_numbers(row, are_whole)) {
      return false;
    }
  }
  return !list.empty();
}

template <class T>
py::array_t<T> array_of_list(const io::Json& list) {
  py::array_t<T> out(static_cast<py::ssize_t>(list.size()));
  T* at = out.mutable_data();
  for (const io::Json& item : list) *at++ = item.get<T>();
  return out;
}

py::object python_of_list(const io::Json& list) {
  bool are_whole = true;
  if (are_numbers(list, are_whole)) {
    if (are_whole) return array_of_list<std::int64_t>(list);
    return array_of_list<double>(list);
  }
  if (are_rows(list)) {
    py::array_t<double> out({list.size(), list.begin()->size()});
    double* at = out.mutable_data();
    for (const io::Json& row : list) {
      for (const io::Json& item : row) *at++ = item.get<double>();
    }
    return out;
  }
  py::list out;
  for (const io::Json& item : list) out.append(python_of(item));
  return out;
}

void check_finite(const double* data, py::ssize_t size, const char* name) {
  // The sum of zero times each number is zero unless one is not finite; unlike a loop with a way
  // out, it is worked out several numbers at a time.
  if ((0 * Eigen::Map<const Eigen::VectorXd>(data, size)).sum() == 0) return;
  for (py::ssize_t i = 0; i < size; ++i) {
    if (!std::isfinite(data[i])) {
      throw std::invalid_argument(fmt::format("{}: number {} is not finite", name, i));
    }
  }
}

std::string shape_words(const Numbers& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

}  // namespace

py::object items_of(py::handle object) {
  if (py::hasattr(object, "tolist") || py::isinstance<py::type>(object)) return {};
  if (PyMapping_Check(object.ptr()) && py::hasattr(object, "items")) return object.attr("items")();
  if (py::hasattr(object, "__fspath__")) return {};
  if (py::hasattr(object, "__dataclass_fields__") ||
      py::isinstance(object, py::module_::import("types").attr("SimpleNamespace"))) {
    return py::module_::import("builtins").attr("vars")(object).attr("items")();
  }
  return {};
}

io::Node node_of(py::handle object, io::ReadContext& context, const std::string& path) {
  return TreeBuilder(context).build(object, path, 0);
}

void read_object(py::handle object, const std::string& source, const io::TableBody& body) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = node_of(object, context);
  io::Map(body).read(context, root, "");
  context.throw_if_any();
}

py::object python_of(const io::Json& json) {
  switch (json.kind()) {
    case io::Json::Kind::Null:
      return py::none();
    case io::Json::Kind::Bool:
      return py::bool_(json.get<bool>());
    case io::Json::Kind::Integer:
      return py::int_(json.get<std::int64_t>());
    case io::Json::Kind::Unsigned:
      return py::int_(json.get<std::uint64_t>());
    case io::Json::Kind::Real:
      return py::float_(json.get<double>());
    case io::Json::Kind::Text:
      return py::str(json.get<std::string>());
    case io::Json::Kind::Array:
      return python_of_list(json);
    case io::Json::Kind::Object:
      break;
  }
  py::dict out;
  for (const auto& [key, value] : json.items()) out[py::str(key)] = python_of(value);
  return out;
}

py::object python_of(const io::TableBody& body) { return python_of(io::written(body)); }

Eigen::VectorXd vector_of(const Numbers& array, Eigen::Index size, const char* name) {
  if (array.ndim() != 1 || array.shape(0) != size) {
    throw std::invalid_argument(
        fmt::format("{}: has the shape {}, must have ({},)", name, shape_words(array), size));
  }
  check_finite(array.data(), size, name);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), size);
}

Eigen::MatrixXd matrix_of(const Numbers& array, Eigen::Index rows, Eigen::Index columns,
                          const char* name) {
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != columns) {
    throw std::invalid_argument(fmt::format("{}: has the shape {}, must have ({}, {})", name,
                                            shape_words(array), rows, columns));
  }
  return rows_of(array, rows, columns, name);
}

Eigen::MatrixXd rows_of(const Numbers& array, Eigen::Index count, Eigen::Index columns,
                        const char* name) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const bool is_one = count >= 0 && array.ndim() == 1 && array.shape(0) == columns;
  const bool are_rows =
      array.ndim() == 2 && array.shape(1) == columns && (count < 0 || array.shape(0) == count);
  if (!is_one && !are_rows) {
    throw std::invalid_argument(
        fmt::format("{}: has the shape {}, must have {}", name, shape_words(array),
                    count < 0 ? fmt::format("(k, {})", columns)
                              : fmt::format("({}, {}) or ({},)", count, columns, columns)));
  }
  check_finite(array.data(), array.size(), name);
  if (is_one) {
    Eigen::MatrixXd same(count, columns);
    for (Eigen::Index k = 0; k < columns; ++k) same.col(k).setConstant(array.data()[k]);
    return same;
  }
  const Eigen::Map<const Rows> rows(array.data(), array.shape(0), columns);
  Eigen::MatrixXd out(rows.rows(), columns);
  // Rows that stay in the nearest cache while the columns are filled.
  constexpr Eigen::Index kBlock = 64;
  for (Eigen::Index k = 0; k < rows.rows(); k += kBlock) {
    const Eigen::Index some = std::min(kBlock, rows.rows() - k);
    out.middleRows(k, some) = rows.middleRows(k, some);
  }
  return out;
}

py::array view_of(const double* data, py::array::ShapeContainer shape,
                  py::array::StridesContainer strides, py::handle owner) {
  py::array out(py::dtype::of<double>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

}  // namespace stillbase::python
