// Capture problems from files and from Python objects, and functions of the user.
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/io/problem_file.hpp>

#include "convert.hpp"
#include "interpreter.hpp"
#include "io/problem_reader.hpp"
#include "long_call.hpp"
#include "objects.hpp"

namespace stillbase::python {

namespace {

/// A dict of sections with the two keys that say what a file is, unless they are stated.
py::dict with_format(const py::dict& sections) {
  py::dict out;
  out["format"] = "stillbase.problem";
  out["version"] = 1;
  for (const auto& [key, value] : sections) out[key] = value;
  return out;
}

std::shared_ptr<Problem> read_problem_object(const py::handle& object, const std::string& source,
                                             const io::ProblemSources& sources) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = node_of(object, context);
  context.throw_if_any();
  CaptureProblem problem = io::read_problem_map(root, context, "", sources);
  context.throw_if_any();
  return make_problem(std::move(problem));
}

std::shared_ptr<Problem> problem_from_dict(const py::dict& sections,
                                           const std::filesystem::path& folder,
                                           const std::optional<std::string>& urdf,
                                           const std::string& source) {
  return read_problem_object(with_format(sections), source,
                             {.urdf = urdf, .folder = folder.string()});
}

py::dict problem_dict(const Problem& problem) {
  return python_of(io::problem_json(problem.data)).cast<py::dict>();
}

/// Values of one map, given by its items, in place of those of a dict; maps key by key.
void merge(const py::dict& into, const py::object& changes) {
  for (const py::handle item : changes) {
    const auto pair = item.cast<py::tuple>();
    const py::object key = pair[0], value = pair[1];
    const bool was_map = into.contains(key) && py::isinstance<py::dict>(into[key]);
    if (const py::object inner = was_map ? items_of(value) : py::object()) {
      merge(py::reinterpret_borrow<py::dict>(into[key]), inner);
    } else {
      into[key] = value;
    }
  }
}

/// The problem with other user functions: `data.user` follows from the tuples.
std::shared_ptr<Problem> with_functions(const Problem& problem, py::tuple terms,
                                        py::tuple constraints);

std::shared_ptr<Problem> replace_sections(const Problem& problem, const py::kwargs& changes) {
  const py::dict stated = problem_dict(problem);
  merge(stated, items_of(changes));
  const auto changed =
      read_problem_object(stated, problem.data.source, {.urdf = problem.data.urdf, .folder = "."});
  return with_functions(*changed, problem.terms, problem.constraints);
}

Impact impact_for_user(const SharedRobot& robot, const ImpactSummary& summary) {
  return {summary, robot};
}

UserFunction value_function(const SharedRobot& robot, const std::string& name,
                            const py::object& function) {
  return [robot, name, shared = shared_function(function)](const Configuration& configuration,
                                                           const ImpactSummary& impact) {
    return with_interpreter([&] {
      const py::object out =
          call(*shared, py::make_tuple(configuration, impact_for_user(robot, impact)));
      try {
        return out.cast<double>();
      } catch (const py::cast_error&) {
        throw py::type_error(fmt::format("{}: must return a number, returned an object of type {}",
                                         name, Py_TYPE(out.ptr())->tp_name));
      }
    });
  };
}

UserGradient gradient_function(const SharedRobot& robot, const std::string& name,
                               const py::object& function) {
  if (function.is_none()) return {};
  return [robot, name, shared = shared_function(function)](const Configuration& configuration,
                                                           const ImpactSummary& impact) {
    return with_interpreter([&] {
      const auto out = call(*shared, py::make_tuple(configuration, impact_for_user(robot, impact)))
                           .cast<Numbers>();
      if (out.ndim() != 1) {
        throw std::invalid_argument(fmt::format(
            "{}: the gradient has {} dimensions, must be an array (N,) of the variables", name,
            out.ndim()));
      }
      return vector_of(out, out.size(), name.c_str());
    });
  };
}

std::shared_ptr<Problem> with_functions(const Problem& problem, py::tuple terms,
                                        py::tuple constraints) {
  auto out = std::make_shared<Problem>(problem);
  out->data.user = {};
  for (const py::handle item : terms) {
    const auto t = item.cast<py::tuple>();
    const auto name = t[0].cast<std::string>();
    out->data.user.terms.push_back({name, t[1].cast<std::string>(), t[2].cast<double>(),
                                    value_function(problem.robot, name, t[3]),
                                    gradient_function(problem.robot, name, t[4])});
  }
  for (const py::handle item : constraints) {
    const auto c = item.cast<py::tuple>();
    const auto name = c[0].cast<std::string>();
    out->data.user.constraints.push_back(
        {name, c[1].cast<std::string>(), c[2].cast<double>(), c[3].cast<double>(),
         value_function(problem.robot, name, c[4]), gradient_function(problem.robot, name, c[5])});
  }
  out->terms = std::move(terms);
  out->constraints = std::move(constraints);
  return out;
}

void warn_of_differences(const std::string& name, const py::object& gradient) {
  if (!gradient.is_none()) return;
  const std::string text = fmt::format(
      "'{}' has no gradient: central differences call it 2 N times more for every evaluation of "
      "the search, N its number of variables",
      name);
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

py::tuple appended(const py::tuple& list, const py::tuple& item) {
  return py::tuple(list + py::make_tuple(item));
}

std::shared_ptr<Problem> with_term(const Problem& problem, const std::string& name,
                                   const py::function& value, const std::string& unit, double size,
                                   const py::object& gradient) {
  if (!(size > 0 && size < kInfinity)) throw std::invalid_argument("size: must be > 0 and finite");
  warn_of_differences(name, gradient);
  return with_functions(problem,
                        appended(problem.terms, py::make_tuple(name, unit, size, value, gradient)),
                        problem.constraints);
}

std::shared_ptr<Problem> with_constraint(const Problem& problem, const std::string& name,
                                         const py::function& value, double lower, double upper,
                                         const std::string& unit, const py::object& gradient) {
  if (!(lower <= upper)) throw std::invalid_argument("lower and upper: must be lower <= upper");
  warn_of_differences(name, gradient);
  return with_functions(
      problem, problem.terms,
      appended(problem.constraints, py::make_tuple(name, unit, lower, upper, value, gradient)));
}

py::tuple state_of(const Problem& problem) {
  return py::make_tuple(problem_to_json(problem.data), problem.data.source, problem.data.urdf,
                        problem.terms, problem.constraints);
}

std::shared_ptr<Problem> from_state(const py::tuple& state) {
  const auto read = make_problem(read_problem_text(
      state[0].cast<std::string>(), state[1].cast<std::string>(), state[2].cast<std::string>()));
  return with_functions(*read, state[3], state[4]);
}

}  // namespace

std::shared_ptr<Problem> make_problem(CaptureProblem data) {
  auto robot = make_robot(data.robot, data.urdf);
  return std::make_shared<Problem>(
      Problem{std::move(data), std::move(robot), py::tuple(), py::tuple()});
}

void check_fits(Eigen::Index num_joints, const Configuration& configuration) {
  if (configuration.phi.size() != num_joints) {
    throw std::invalid_argument(
        fmt::format("configuration: has {} joint positions, the robot has "
                    "{} joints",
                    configuration.phi.size(), num_joints));
  }
}

void register_problem(py::module_& m) {
  py::class_<Problem, std::shared_ptr<Problem>> problem(
      m, "Problem",
      "A capture problem: what a problem file states. It does not change; replace(), with_term()\n"
      "and with_constraint() return another one. Files, dicts and keywords go through the same\n"
      "reader: unknown keys, wrong units and values that contradict each other are refused.\n"
      "\n"
      "Problem(purpose='...', robot={...}, impact={...}, objective='...') takes the sections as\n"
      "keywords.");
  problem.def(py::init([](const std::filesystem::path& folder,
                          const std::optional<std::string>& urdf, const py::kwargs& sections) {
                return problem_from_dict(sections, folder, urdf, "problem");
              }),
              py::kw_only(), py::arg("folder") = ".", py::arg("urdf") = py::none(),
              "Sections of a problem file as keywords, each a dict, dataclass or SimpleNamespace.\n"
              "Files are named relative to `folder`; with `urdf` the text of the robot file is\n"
              "given. Raises InputError with the key and the rule of everything wrong, FileError.");
  problem.def_static(
      "from_file",
      [](const std::filesystem::path& path) { return make_problem(read_problem(path.string())); },
      py::arg("path"),
      "Reads a problem file (YAML) with the robot and target files that it names. Raises\n"
      "InputError with file, line, rule and text of everything wrong, FileError.");
  problem.def_static("from_dict", &problem_from_dict, py::arg("sections"), py::kw_only(),
                     py::arg("folder") = ".", py::arg("urdf") = py::none(),
                     py::arg("source") = "problem",
                     "Reads the sections of a problem file from a dict; `source` names it in\n"
                     "messages. Raises InputError with the key and the rule of everything wrong.");
  problem.def(
      "replace", &replace_sections,
      "The problem with other values: replace(search={'starts': 8}) keeps everything else.\n"
      "The whole is read again. Raises InputError.");
  problem.def("to_dict", &problem_dict,
              "Every field in SI units, defaults included, as in a problem file.");
  problem.def(
      "to_json", [](const Problem& p) { return problem_to_json(p.data); },
      "The same as JSON text.");
  problem.def_property_readonly(
      "name", [](const Problem& p) { return p.data.name; }, "Short name.");
  problem.def_property_readonly(
      "purpose", [](const Problem& p) { return p.data.purpose; }, "One sentence.");
  problem.def_readonly("robot", &Problem::robot, "The robot.");
  problem.def(
      "start_configuration", [](const Problem& p) { return start_configuration(p.data); },
      "The start posture at the stated base pose and the earliest contact time.");
  problem.def(
      "impact_at",
      [](const Problem& p, const Configuration& configuration) {
        check_fits(p.data.robot.n(), configuration);
        if (!p.data.variables.features.empty() && configuration.feature.empty()) {
          throw std::invalid_argument(
              "configuration: has no feature, and the problem leaves it open");
        }
        return Impact{impact_at(p.data, configuration), p.robot};
      },
      py::arg("configuration"),
      "The nominal impact at a configuration, by the problem's contact law. Where the problem\n"
      "leaves the contact feature open the configuration has to name one. Raises ValueError,\n"
      "InputError.");
  problem.def("with_term", &with_term, py::arg("name"), py::arg("value"), py::kw_only(),
              py::arg("unit") = "1", py::arg("size") = 1.0, py::arg("gradient") = py::none(),
              "The problem with one more term in its objective: |value| is made small, `size`\n"
              "(> 0, in `unit`) counting as one.\n"
              "\n"
              "value(configuration, impact) -> float must be twice differentiable;\n"
              "gradient(configuration, impact) -> (N,) is its total derivative over the variables\n"
              "of NonlinearProgram. Without a gradient central differences give it, with a\n"
              "RuntimeWarning. Exceptions of both end the search.");
  problem.def("with_constraint", &with_constraint, py::arg("name"), py::arg("value"), py::kw_only(),
              py::arg("lower") = -kInfinity, py::arg("upper") = kInfinity, py::arg("unit") = "1",
              py::arg("gradient") = py::none(),
              "The problem with one more constraint lower <= value <= upper, of order one; value\n"
              "and gradient as for with_term().");
  problem.def(py::pickle(&state_of, &from_state));
  problem.def("__deepcopy__",
              [](const Problem& p, const py::dict&) { return std::make_shared<Problem>(p); });
  problem.def("__repr__", [](const Problem& p) {
    return fmt::format("<stillbase.Problem '{}', robot '{}', {} joints>", p.data.name,
                       p.data.robot.name, p.data.robot.n());
  });
}

}  // namespace stillbase::python
