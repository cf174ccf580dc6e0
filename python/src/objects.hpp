// What the classes of the module hold, and the functions that register them.
#pragma once

#include <memory>
#include <string>

#include <pybind11/pybind11.h>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase::python {

namespace py = pybind11;

/// A robot and the text of its file.
struct Robot {
  RobotModel model;
  std::string urdf;
  ImpactResistance free;  ///< of joints that do not resist, prepared once
};
using SharedRobot = std::shared_ptr<Robot>;

SharedRobot make_robot(RobotModel model, std::string urdf);

/// The impact of one impulse, and the robot for the names of its joints.
struct Impact {
  ImpactSummary summary;
  SharedRobot robot;
};

/// A capture problem and the functions of Python that belong to it.
struct Problem {
  CaptureProblem data;
  SharedRobot robot;
  py::tuple terms, constraints;  ///< (name, unit, ..., value, gradient) of each user function
};

std::shared_ptr<Problem> make_problem(CaptureProblem data);
/// @throws std::invalid_argument unless the configuration has this many joint positions
void check_fits(Eigen::Index num_joints, const Configuration& configuration);

void register_robot(py::module_& m);
void register_impact(py::module_& m);
void register_problem(py::module_& m);
void register_formulation(py::module_& m);
void register_plan(py::module_& m);
void register_replanner(py::module_& m);
void register_simulation(py::module_& m);
void register_results(py::module_& m);

}  // namespace stillbase::python
