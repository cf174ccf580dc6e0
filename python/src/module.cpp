// The module stillbase._stillbase: its parts, and errors as exceptions of Python.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <stillbase/core/error.hpp>
#ifdef STILLBASE_WITH_PROOF
#include <stillbase/proof/proof.hpp>
#endif

#include "long_call.hpp"
#include "objects.hpp"

namespace stillbase::python {

namespace {

void raise(const char* type_name, const py::tuple& arguments) {
  const py::object type = py::module_::import("stillbase._errors").attr(type_name);
  PyErr_SetObject(type.ptr(), arguments.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const InputError& error) {
    py::list findings;
    for (const Finding& f : error.findings()) {
      findings.append(py::make_tuple(f.file, f.line, f.rule, f.message));
    }
    raise("InputError", py::make_tuple(error.what(), findings));
  } catch (const FileError& error) {
    raise("FileError", py::make_tuple(error.what()));
  }
}

void* refuse_memory(std::size_t) {
  throw py::type_error("the object has not been made: it comes from __new__ alone");
}

/// Objects of __new__ alone are refused: where a function takes one, pybind11 would hand over
/// memory that nothing has been written to.
void refuse_unmade_objects(const py::module_& m) {
  for (const auto& [name, value] : m.attr("__dict__").cast<py::dict>()) {
    if (!py::isinstance<py::type>(value)) continue;
    auto* const type = reinterpret_cast<PyTypeObject*>(value.ptr());
    if (py::detail::type_info* known = py::detail::get_type_info(type)) {
      known->operator_new = &refuse_memory;
    }
  }
}

}  // namespace

}  // namespace stillbase::python

PYBIND11_MODULE(_stillbase, m) {
  using namespace stillbase::python;
  m.doc() = "The compiled part of stillbase.";
  m.attr("__version__") = STILLBASE_VERSION;
#ifdef STILLBASE_WITH_PROOF
  stillbase::enable_proofs();
#endif
  py::register_exception_translator(&translate);
  register_robot(m);
  register_impact(m);
  register_problem(m);
  register_formulation(m);
  register_plan(m);
  register_replanner(m);
  register_simulation(m);
  register_results(m);
  refuse_unmade_objects(m);
  end_long_calls_at_exit();
}
