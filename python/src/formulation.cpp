// The capture problem as a nonlinear program.
#include <fmt/format.h>

#include <pybind11/stl.h>

#include "convert.hpp"
#include "interpreter.hpp"
#include "objects.hpp"

namespace stillbase::python {

namespace {

Eigen::VectorXd point_of(const Formulation& formulation, const Numbers& x) {
  return vector_of(x, formulation.num_variables(), "x");
}

}  // namespace

void register_formulation(py::module_& m) {
  py::class_<nlp::Evaluation> evaluation(m, "Evaluation",
                                         "Values and first derivatives at one point.");
  evaluation.def_readonly("objective", &nlp::Evaluation::objective,
                          "f = 1/2 |y|^2, y the objective's quantities over their typical sizes.");
  const auto add = [&evaluation](const char* name, auto member, const char* doc) {
    evaluation.def_property_readonly(
        name,
        [member](py::handle self) {
          return view_of(self.cast<const nlp::Evaluation&>().*member, self);
        },
        doc);
  };
  add("gradient", &nlp::Evaluation::gradient, "df/dx, (N,).");
  add("constraints", &nlp::Evaluation::constraints, "g, (m,), of order one.");
  add("jacobian", &nlp::Evaluation::jacobian, "dg/dx, (m, N).");

  py::class_<Formulation> formulation(m, "Formulation",
                                      "Variables, objective and constraints of a problem.");
  formulation.def(py::init([](const Problem& problem) { return new Formulation(problem.data); }),
                  py::arg("problem"),
                  "Raises InputError when fewer variables are free than there are equations.");
  const auto vector = [&formulation](const char* name, Eigen::VectorXd (Formulation::*get)() const,
                                     const char* doc) {
    formulation.def_property_readonly(
        name, [get](const Formulation& f) { return array_of((f.*get)()); }, doc);
  };
  vector("lower", &Formulation::lower, "Lower bounds of the variables, (N,).");
  vector("upper", &Formulation::upper, "Upper bounds of the variables, (N,).");
  vector("constraint_lower", &Formulation::constraint_lower,
         "Lower bounds of the constraints, (m,); equal to the upper ones for equations.");
  vector("constraint_upper", &Formulation::constraint_upper,
         "Upper bounds of the constraints, (m,).");
  formulation.def(
      "evaluate",
      [](const Formulation& f, const Numbers& x, bool derivatives) {
        const Eigen::VectorXd at = point_of(f, x);
        nlp::Evaluation out;
        const Unlocked unlocked;
        if (derivatives) {
          f.evaluate(at, out);
        } else {
          f.evaluate_value(at, out);
        }
        return out;
      },
      py::arg("x"), py::arg("derivatives") = true,
      "Objective and constraints at x (N,), with derivatives unless they are not wanted.");
  formulation.def(
      "start_point",
      [](const Formulation& f, const Numbers& u) {
        const Eigen::VectorXd at = point_of(f, u);
        if (at.minCoeff() < 0 || at.maxCoeff() >= 1) {
          throw std::invalid_argument("u: must be in [0, 1)");
        }
        return array_of(f.start_point(at));
      },
      py::arg("u"),
      "A start point (N,) for u in [0, 1)^N: joints within their limits, attitudes uniform over\n"
      "rotations, times uniform.");
  formulation.def(
      "configuration",
      [](const Formulation& f, const Numbers& x) { return f.configuration(point_of(f, x)); },
      py::arg("x"), "The configuration of the variables x (N,).");
  formulation.def(
      "variables",
      [](const Formulation& f, const Configuration& configuration) {
        const Eigen::VectorXd any = Eigen::VectorXd::Zero(f.num_variables());
        check_fits(f.configuration(any).phi.size(), configuration);
        return array_of(f.variables(configuration));
      },
      py::arg("configuration"), "The variables (N,) of a configuration. Raises ValueError.");
  formulation.def(
      "value_of",
      [](const Formulation& f, double objective) {
        const double length = std::sqrt(2 * objective) * f.objective_unit();
        return f.objective_power().value(length);
      },
      py::arg("objective"), "The objective's quantity, in its own unit, of a value of f.");
}

}  // namespace stillbase::python
