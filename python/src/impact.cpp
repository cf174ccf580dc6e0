// The impact of one impulse at one configuration.
#include <cmath>

#include <fmt/format.h>

#include <pybind11/stl.h>

#include "convert.hpp"
#include "io/fields/plan.hpp"
#include "objects.hpp"

namespace stillbase::python {

namespace {

JointResistance read_resistance(const Robot& robot, const py::object& object) {
  JointResistance resistance;
  io::ReadContext context{"joint_resistance", {}, {}};
  const io::Node node = node_of(object, context);
  io::resistance_of(resistance, robot.model).read(context, node, "joint_resistance");
  context.throw_if_any();
  return resistance;
}

Impact impact_of(SharedRobot robot, const Numbers& phi, const Numbers& impulse,
                 const py::object& joint_resistance, double closing_speed) {
  if (!std::isfinite(closing_speed)) throw std::invalid_argument("closing_speed: must be finite");
  auto summary = summarize_impact(robot->model, vector_of(phi, robot->model.n(), "phi"),
                                  read_resistance(*robot, joint_resistance),
                                  vector_of(impulse, 6, "impulse"), closing_speed);
  check_range(summary.Delta_Omega);
  check_range(summary.Delta_phidot);
  check_range(summary.total);
  check_range(summary.base);
  return {std::move(summary), std::move(robot)};
}

Configuration make_configuration(const Numbers& joint_positions, const Numbers& base_position,
                                 const Numbers& base_orientation, double contact_time,
                                 const std::string& feature) {
  Configuration out;
  if (joint_positions.size() > kMaxJoints) {
    throw std::invalid_argument(fmt::format("joint_positions: more than {} numbers", kMaxJoints));
  }
  out.phi = vector_of(joint_positions, joint_positions.size(), "joint_positions");
  out.base.position = vector_of(base_position, 3, "base_position");
  const Eigen::VectorXd q = vector_of(base_orientation, 4, "base_orientation");
  if (std::abs(q.norm() - 1) > 1e-6) {
    throw std::invalid_argument(fmt::format(
        "base_orientation: has the norm {}, must be a unit quaternion [w, x, y, z]", q.norm()));
  }
  out.base.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  if (!std::isfinite(contact_time)) throw std::invalid_argument("contact_time: must be finite");
  out.contact_time = contact_time;
  out.feature = feature;
  return out;
}

void register_configuration(py::module_& m) {
  py::class_<Configuration> configuration(
      m, "Configuration", "Where the robot is at the contact: posture, base pose, time.");
  configuration.def(py::init(&make_configuration), py::arg("joint_positions"), py::kw_only(),
                    py::arg("base_position") = std::vector<double>{0, 0, 0},
                    py::arg("base_orientation") = std::vector<double>{1, 0, 0, 0},
                    py::arg("contact_time") = 0.0, py::arg("feature") = "",
                    "joint_positions (n,), rad (m); base_position of B in N, (3,), m;\n"
                    "base_orientation R_NB as [w, x, y, z]; contact_time, s; feature: name of the\n"
                    "contact feature, '' for the problem's own. Raises ValueError.");
  configuration.def_property_readonly(
      "joint_positions", [](const Configuration& c) { return array_of(c.phi); },
      "phi, (n,), rad (m).");
  configuration.def_property_readonly(
      "base_position", [](const Configuration& c) { return array_of(c.base.position); },
      "Origin of B in N, (3,), m.");
  configuration.def_property_readonly(
      "base_orientation",
      [](const Configuration& c) {
        const Eigen::Quaterniond& q = c.base.orientation;
        return array_of(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
      },
      "R_NB as [w, x, y, z], (4,).");
  configuration.def_readonly("contact_time", &Configuration::contact_time, "s.");
  configuration.def_readonly("feature", &Configuration::feature,
                             "Name of the contact feature; '': the problem's own.");
  configuration.def("__repr__", [](const Configuration& c) {
    return fmt::format("<stillbase.Configuration, {} joints, contact at {:.6g} s>", c.phi.size(),
                       c.contact_time);
  });
}

}  // namespace

void register_impact(py::module_& m) {
  register_configuration(m);
  py::class_<Impact> impact(m, "Impact",
                            "Everything about one impulse at one posture. Vectors are in B; arrays "
                            "are views that\ncannot be written.");
  const auto add = [&impact](const char* name, auto member, const char* doc) {
    impact.def_property_readonly(
        name,
        [member](py::handle self) {
          return view_of(self.cast<const Impact&>().summary.*member, self);
        },
        doc);
  };
  add("impulse", &ImpactSummary::Fbar, "[f; t] on the hand, (6,), N s, N m s.");
  add("Delta_Omega", &ImpactSummary::Delta_Omega,
      "Velocity jump of the base [v; omega], (6,), m/s, rad/s.");
  add("Delta_phidot", &ImpactSummary::Delta_phidot, "Jump of the joint rates, (n,), rad/s (m/s).");
  add("Delta_phidot_rns", &ImpactSummary::Delta_phidot_rns,
      "Its part in the angular reaction null space, (n,).");
  add("Delta_phidot_orthogonal", &ImpactSummary::Delta_phidot_orthogonal,
      "Its part orthogonal to that, (n,).");
  add("total", &ImpactSummary::total,
      "Change of the angular momentum about the system centroid (16), (3,), N m s.");
  add("base", &ImpactSummary::base, "Its base part Htilde_omega Delta omega, (3,), N m s.");
  add("coupling", &ImpactSummary::coupling,
      "Its coupling part Htilde_omegaphi Delta phidot, (3,), N m s.");
  impact.def_property_readonly(
      "case", [](const Impact& i) { return to_string(i.summary.judgement.impact_case); },
      "Case of the paper: 'G1', 'G2', 'G3', 'C1' or 'C2'.");
  impact.def_property_readonly(
      "rank", [](const Impact& i) { return i.summary.rank; },
      "Rank of the angular coupling matrix.");
  impact.def_property_readonly(
      "closing_speed", [](const Impact& i) { return i.summary.closing_speed; },
      "Of hand and target along the impulse, m/s.");
  impact.def(
      "to_dict",
      [](const Impact& i) {
        ImpactSummary copy = i.summary;  // tables name fields of data that may change
        return python_of([&](io::Table& t) { io::impact_object_fields(t, copy, i.robot->model); });
      },
      "The object `impact` of plan files.");
  impact.def("__repr__", [](const Impact& i) {
    return fmt::format("<stillbase.Impact, case {}, {:.4g} N s>",
                       to_string(i.summary.judgement.impact_case), i.summary.Fbar.head<3>().norm());
  });

  m.def(
      "impact", &impact_of, py::arg("robot"), py::arg("phi"), py::arg("impulse"), py::kw_only(),
      py::arg("joint_resistance") = "free", py::arg("closing_speed") = 0.0,
      "Everything about an impulse [f; t] at the hand in B, (6,), N s, N m s, at joint positions\n"
      "phi (n,), rad (m). joint_resistance: as in `impact.joint_resistance` of a problem file.\n"
      "Raises ValueError, InputError.");
}

}  // namespace stillbase::python
