// Robot, postures, velocity jumps, and many postures at once.
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/batch.hpp>
#include <stillbase/impact/indices.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "convert.hpp"
#include "interpreter.hpp"
#include "io/fields/results.hpp"
#include "objects.hpp"

namespace stillbase::python {

namespace {

/// The matrices of one posture.
struct Posture {
  SharedRobot robot;
  JointVectord phi;
  PostureImpact<double> impact;
  HatInertia<double> hat;
};

struct Response {
  ImpactResponse<double> response;
  Vector3d coupling;
};

/// Many responses: the arrays of the module are views of these matrices.
struct Responses {
  ImpactBatchValues values;
};
struct ObjectiveValues {
  BatchObjectiveValues values;
};

/// Added inertia (n) and locked joints (n) as keywords of a call.
ImpactResistance resistance_of(const Robot& robot, const std::optional<Numbers>& added_inertia,
                               const std::vector<bool>& locked) {
  const int n = robot.model.n();
  ImpactResistance out = robot.free;
  if (added_inertia) {
    out.added_inertia = vector_of(*added_inertia, n, "added_inertia");
    if (out.added_inertia.minCoeff() < 0) {
      throw std::invalid_argument("added_inertia: must not be negative");
    }
  }
  if (!locked.empty() && static_cast<int>(locked.size()) != n) {
    throw std::invalid_argument(
        fmt::format("locked: has {} flags, must have {}", locked.size(), n));
  }
  out.locked = locked;
  return out;
}

SharedRobot robot_from_text(const std::string& text, const std::string& hand,
                            const std::string& source) {
  return make_robot(read_urdf(text, source, hand), text);
}

SharedRobot robot_from_section(const py::object& section, const std::filesystem::path& folder,
                               const std::string& source) {
  CaptureProblem problem;
  read_object(section, source,
              [&](io::Table& t) { io::robot_fields(t, problem, {.folder = folder.string()}); });
  return make_robot(std::move(problem.robot), std::move(problem.urdf));
}

ImpactJump<double> jump(const Robot& robot, const Numbers& phi, const Numbers& impulse,
                        const std::optional<Numbers>& added_inertia,
                        const std::vector<bool>& locked) {
  const JointVectord at = vector_of(phi, robot.model.n(), "phi");
  const Vector6d Fbar = vector_of(impulse, 6, "impulse");
  const auto under = [&](const ImpactResistance& resistance) {
    auto out =
        compute_jump<double>(robot.model, at, resistance.added_inertia, resistance.locked, Fbar);
    check_range(out.Delta_Omega);
    check_range(out.Delta_phidot);
    return out;
  };
  if (!added_inertia && locked.empty()) return under(robot.free);
  return under(resistance_of(robot, added_inertia, locked));
}

Posture evaluate(SharedRobot robot, const Numbers& phi, const std::optional<Numbers>& added_inertia,
                 const std::vector<bool>& locked) {
  const JointVectord at = vector_of(phi, robot->model.n(), "phi");
  auto impact =
      evaluate_posture<double>(robot->model, resistance_of(*robot, added_inertia, locked), at);
  const auto hat = compute_hat_inertia<double>(impact.inertia, impact.jacobian);
  return {std::move(robot), at, impact, hat};
}

ImpactBatch batch_of(const Robot& robot, const Numbers& phi, const Numbers& impulse,
                     const std::optional<Numbers>& approach,
                     const std::optional<Numbers>& target_inverse_mass) {
  ImpactBatch batch;
  batch.phi = rows_of(phi, -1, robot.model.n(), "phi");
  const Eigen::Index count = batch.phi.rows();
  batch.F = rows_of(impulse, count, 6, "impulse");
  if (approach.has_value() != target_inverse_mass.has_value()) {
    throw std::invalid_argument("approach and target_inverse_mass: state both of them, or none");
  }
  if (approach) {
    batch.approach = vector_of(*approach, count, "approach");
    batch.target_inverse_mass = vector_of(*target_inverse_mass, count, "target_inverse_mass");
    if ((batch.target_inverse_mass.array() < 0).any()) {
      throw std::invalid_argument("target_inverse_mass: must be at least 0 1/kg");
    }
  }
  return batch;
}

Responses evaluate_batch(const Robot& robot, const Numbers& phi, const Numbers& impulse,
                         const std::optional<Numbers>& approach,
                         const std::optional<Numbers>& target_inverse_mass,
                         const std::optional<Numbers>& added_inertia,
                         const std::vector<bool>& locked) {
  const ImpactBatch batch = batch_of(robot, phi, impulse, approach, target_inverse_mass);
  const ImpactResistance resistance = resistance_of(robot, added_inertia, locked);
  Responses out;
  const Unlocked unlocked;
  evaluate_postures(robot.model, resistance, batch, out.values);
  check_range(out.values.hand_inverse_mass);  // of the second power: it leaves the range first
  check_range(out.values.p);
  return out;
}

ResponsePart part_of(const std::string& name) {
  static constexpr std::pair<const char*, ResponsePart> kParts[] = {
      {"base_velocity", ResponsePart::BaseVelocity},
      {"base_rate", ResponsePart::BaseRate},
      {"base_angular_momentum", ResponsePart::BaseAngularMomentum},
      {"total_angular_momentum", ResponsePart::TotalAngularMomentum},
      {"received_linear_momentum", ResponsePart::ReceivedLinearMomentum},
      {"received_angular_momentum", ResponsePart::ReceivedAngularMomentum},
      {"joint_rates", ResponsePart::JointRates},
      {"impulse", ResponsePart::Impulse}};
  std::string known;
  for (const auto& [word, part] : kParts) {
    if (name == word) return part;
    known += known.empty() ? word : std::string(", ") + word;
  }
  throw std::invalid_argument(fmt::format("weights: '{}' is not known; there are {}", name, known));
}

ObjectiveValues evaluate_batch_objective(const Robot& robot, const Numbers& phi,
                                         const Numbers& impulse,
                                         const std::map<std::string, double>& weights,
                                         bool derivatives, const std::optional<Numbers>& approach,
                                         const std::optional<Numbers>& target_inverse_mass,
                                         const std::optional<Numbers>& added_inertia,
                                         const std::vector<bool>& locked) {
  BatchObjective objective;
  for (const auto& [name, weight] : weights) {
    if (!std::isfinite(weight)) throw std::invalid_argument("weights: must be finite");
    objective.add(part_of(name), weight);
  }
  const ImpactBatch batch = batch_of(robot, phi, impulse, approach, target_inverse_mass);
  const ImpactResistance resistance = resistance_of(robot, added_inertia, locked);
  ObjectiveValues out;
  const Unlocked unlocked;
  evaluate_objective(robot.model, resistance, batch, objective, derivatives, out.values);
  check_range(out.values.psi);
  if (derivatives) {
    check_range(out.values.gradient);
    check_range(out.values.gradient_F);
  }
  return out;
}

ReactionNullSpace null_space_of(const Posture& posture, const std::string& kind) {
  if (kind == "angular") return angular_reaction_null_space(posture.impact.tilde);
  if (kind == "full") return full_reaction_null_space(posture.impact.inertia);
  if (kind == "translational") return translational_reaction_null_space(posture.impact.inertia);
  throw std::invalid_argument(
      fmt::format("kind: '{}' is not known; there are angular, full, translational", kind));
}

py::tuple gradient_of(const Posture& posture, const Numbers& impulse,
                      const std::map<std::string, Numbers>& weights) {
  const auto response = respond<double>(posture.impact, vector_of(impulse, 6, "impulse"));
  ResponseWeights<double> u;
  for (const auto& [name, value] : weights) {
    const char* key = name.c_str();
    if (name == "velocity") {
      u.velocity = vector_of(value, 3, key);
    } else if (name == "omega") {
      u.omega = vector_of(value, 3, key);
    } else if (name == "base") {
      u.base = vector_of(value, 3, key);
    } else if (name == "total") {
      u.total = vector_of(value, 3, key);
    } else if (name == "hand_inverse_mass") {
      u.hand_inverse_mass = vector_of(Numbers(value.attr("reshape")(1)), 1, key)[0];
    } else if (name == "momentum") {
      u.momentum = vector_of(value, 6, key);
    } else if (name == "phidot") {
      u.phidot = vector_of(value, posture.robot->model.n(), key);
    } else {
      throw std::invalid_argument(
          fmt::format("weights: '{}' is not known; there are velocity, omega, base, total, "
                      "hand_inverse_mass, momentum, phidot",
                      name));
    }
  }
  const auto gradient =
      response_gradient<double>(posture.robot->model, posture.impact, response, u);
  check_range(gradient.phi);
  check_range(gradient.F);
  return py::make_tuple(array_of(gradient.phi), array_of(gradient.F));
}

/// A property that shows a matrix within the object, not copied.
template <class Class, class Get>
void add_view(Class& type, const char* name, Get get, const char* doc) {
  using Object = typename Class::type;
  type.def_property_readonly(
      name, [get](py::handle self) { return view_of(get(self.cast<const Object&>()), self); }, doc);
}

void register_posture(py::module_& m) {
  py::class_<ReactionNullSpace> space(
      m, "NullSpace",
      "Reaction null space of a coupling matrix A (m x n), equations (7) and (9). The rank is a\n"
      "result: it depends on `rank_tolerance`, relative to the largest singular value.");
  space.def_readonly("rank", &ReactionNullSpace::rank, "Rank of A.");
  space.def_readonly("rank_tolerance", &ReactionNullSpace::rank_tolerance,
                     "Singular values at or below this part of the largest one count as zero.");
  add_view(
      space, "singular_values", [](const auto& s) -> auto& { return s.singular_values; },
      "(min(m, n),), descending.");
  space.def_property_readonly(
      "projector", [](const ReactionNullSpace& s) { return array_of(s.P_RNS); },
      "P_RNS = E - A^+ A, (n, n): joint rates projected by it leave the base still.");
  add_view(
      space, "pseudoinverse", [](const auto& s) -> auto& { return s.A_pinv; }, "A^+, (n, m).");
  add_view(
      space, "range", [](const auto& s) -> auto& { return s.range; },
      "Orthonormal basis of the range of A, (m, rank).");
  space.def(
      "split",
      [](const ReactionNullSpace& s, const Numbers& phidot) {
        const auto parts = decompose_joint_velocity(s, vector_of(phidot, s.P_RNS.rows(), "phidot"));
        return py::make_tuple(array_of(parts.rns), array_of(parts.orthogonal));
      },
      py::arg("phidot"),
      "Joint rates (n,), rad/s (m/s), as (part in the null space, part orthogonal to it), each "
      "(n,).");

  py::class_<Response> response(
      m, "Response", "Response of a posture to one impulse at the hand. Vectors are in B.");
  response.def_property_readonly(
      "Delta_Omega",
      [](py::handle self) {
        return view_of(self.cast<const Response&>().response.d.Delta_Omega, self);
      },
      "Velocity jump of the base [v; omega], (6,), m/s, rad/s.");
  add_view(
      response, "Delta_phidot",
      [](const Response& r) -> auto& { return r.response.d.Delta_phidot; },
      "Jump of the joint rates, (n,), rad/s (m/s).");
  add_view(
      response, "total", [](const Response& r) -> auto& { return r.response.total; },
      "Change of the angular momentum about the system centroid (16), (3,), N m s.");
  add_view(
      response, "base", [](const Response& r) -> auto& { return r.response.base; },
      "Its base part Htilde_omega Delta omega, (3,), N m s.");
  add_view(
      response, "coupling", [](const Response& r) -> auto& { return r.coupling; },
      "Its coupling part Htilde_omegaphi Delta phidot, (3,), N m s.");
  response.def_property_readonly(
      "hand_inverse_mass", [](const Response& r) { return r.response.hand_inverse_mass; },
      "F' W_h F: of a unit force the inverse effective mass of the hand, 1/kg.");

  py::class_<Posture> posture(
      m, "Posture",
      "Kinematics and dynamics of a robot at one posture, evaluated once. Everything is in the\n"
      "base frame B (origin at the centroid of the base body, base velocity [v; omega]). Arrays\n"
      "are views of the object and cannot be written.");
  const auto add = [&posture](const char* name, auto get, const char* doc) {
    add_view(posture, name, get, doc);
  };
  add(
      "joint_positions", [](const Posture& p) -> auto& { return p.phi; },
      "phi, (n,), rad (m for prismatic joints).");
  add(
      "centroid", [](const Posture& p) -> auto& { return p.impact.inertia.r_bg; },
      "System centroid from the base centroid, (3,), m.");
  add(
      "hand_position", [](const Posture& p) -> auto& { return p.impact.kinematics.r_bh; },
      "Origin of the hand frame, (3,), m.");
  add(
      "hand_axes", [](const Posture& p) -> auto& { return p.impact.kinematics.R_hand; },
      "Axes of the hand frame, (3, 3), one per column.");
  add(
      "H_b", [](const Posture& p) -> auto& { return p.impact.inertia.H_b; },
      "Base inertia (1), (6, 6).");
  add(
      "H_bphi", [](const Posture& p) -> auto& { return p.impact.inertia.H_bphi; },
      "Inertia coupling matrix (1), (6, n).");
  add(
      "J_phi", [](const Posture& p) -> auto& { return p.impact.jacobian.J_phi; },
      "Hand Jacobian on a fixed base (3), (6, n).");
  add(
      "R_bh", [](const Posture& p) -> auto& { return p.impact.jacobian.R_bh; },
      "Shift of a velocity from base to hand (3), (6, 6).");
  add(
      "Htilde_omega", [](const Posture& p) -> auto& { return p.impact.tilde.Htilde_omega; },
      "Central inertia of the locked robot (2), (3, 3), kg m^2.");
  add(
      "Htilde_omegaphi", [](const Posture& p) -> auto& { return p.impact.tilde.Htilde_omegaphi; },
      "Angular coupling matrix (2), (3, n).");
  add(
      "Jhat_phi", [](const Posture& p) -> auto& { return p.hat.Jhat_phi; },
      "Generalized Jacobian (4), (6, n).");
  posture.def_property_readonly(
      "H_phi", [](const Posture& p) { return array_of(p.impact.inertia.H_phi); },
      "Inertia of the arm on a fixed base (3), (n, n).");
  posture.def_property_readonly(
      "Htilde_phi", [](const Posture& p) { return array_of(p.impact.tilde.Htilde_phi); },
      "Arm inertia, base translation eliminated (8), (n, n).");
  posture.def_property_readonly(
      "Hhat_phi", [](const Posture& p) { return array_of(p.hat.Hhat_phi); },
      "Generalized inertia matrix (4), (n, n).");
  posture.def_property_readonly(
      "B",
      [](const Posture& p) {
        return array_of(base_reaction_matrix(p.impact.factor, p.impact.jacobian));
      },
      "Base reaction matrix (14), (15): Delta omega = B [f; t], (3, 6).");
  posture.def_property_readonly(
      "hand_inverse_inertia",
      [](const Posture& p) {
        return array_of(extended_inverse_inertia(p.impact.factor, p.impact.jacobian));
      },
      "Extended-inverse inertia tensor: hand velocity change per impulse, (6, 6).");
  posture.def(
      "respond",
      [](const Posture& p, const Numbers& impulse) {
        const auto answer = respond<double>(p.impact, vector_of(impulse, 6, "impulse"));
        check_range(Eigen::Matrix<double, 1, 1>(answer.hand_inverse_mass));  // as of many postures
        return Response{answer, answer.coupling()};
      },
      py::arg("impulse"), "Response to an impulse [f; t] at the hand in B, (6,), N s, N m s.");
  posture.def(
      "gradient",
      [](const Posture& p, const Numbers& impulse, const py::kwargs& weights) {
        return gradient_of(p, impulse, weights.cast<std::map<std::string, Numbers>>());
      },
      py::arg("impulse"),
      "Exact gradient of psi = velocity . Delta v + omega . Delta omega + base . base part\n"
      "+ total . total + hand_inverse_mass F' W_h F + momentum . H_b Delta Omega\n"
      "+ phidot . Delta phidot, the weights being keywords: (d psi / d phi (n,) with the impulse\n"
      "fixed in B, d psi / d impulse (6,)).");
  posture.def("null_space", &null_space_of, py::arg("kind") = "angular",
              "Reaction null space: 'angular' of Htilde_omegaphi (9), 'full' of H_bphi (7), or\n"
              "'translational', base rotation eliminated.");
  posture.def(
      "to_dict",
      [](const Posture& p) {
        RobotState state = zero_state(p.robot->model);
        state.phi = p.phi;
        return python_of([&](io::Table& t) { io::inspection_fields(t, p.robot->model, state); });
      },
      "What `stillbase inspect --json` prints at this posture, the robot at rest with free "
      "joints.");
}

void register_batches(py::module_& m) {
  py::class_<Responses> responses(
      m, "Responses",
      "Responses of k postures, each to its own impulse, per unit of `p`. Row i of an array is\n"
      "posture i. Arrays are views of the object and cannot be written.");
  const auto add = [&responses](const char* name, auto member, const char* doc) {
    add_view(
        responses, name, [member](const Responses& r) -> auto& { return r.values.*member; }, doc);
  };
  add("Delta_Omega", &ImpactBatchValues::Delta_Omega,
      "Velocity jumps of the base [v; omega] in B, (k, 6), m/s, rad/s.");
  add("base", &ImpactBatchValues::base, "Htilde_omega Delta omega, (k, 3), N m s.");
  add("total", &ImpactBatchValues::total, "Change of the angular momentum (16), (k, 3), N m s.");
  add("hand_inverse_mass", &ImpactBatchValues::hand_inverse_mass, "F' W_h F, (k,).");
  add("p", &ImpactBatchValues::p, "Impulse of the contact law, (k,), N s; 1 without a law.");

  py::class_<ObjectiveValues> objective(
      m, "ObjectiveValues",
      "An objective at k postures. Arrays are views of the object and cannot be written.");
  const auto add_value = [&objective](const char* name, auto member, const char* doc) {
    add_view(
        objective, name, [member](const ObjectiveValues& o) -> auto& { return o.values.*member; },
        doc);
  };
  add_value("value", &BatchObjectiveValues::psi, "psi, (k,).");
  add_value("gradient", &BatchObjectiveValues::gradient,
            "d psi / d phi with the impulse's direction fixed in B, (k, n); empty without "
            "derivatives.");
  add_value("gradient_impulse", &BatchObjectiveValues::gradient_F,
            "d psi / d F, (k, 6); empty without derivatives.");
}

}  // namespace

SharedRobot make_robot(RobotModel model, std::string urdf) {
  const int n = model.n();
  return std::make_shared<Robot>(
      Robot{std::move(model), std::move(urdf), {JointVectord::Zero(n), {}}});
}

void register_robot(py::module_& m) {
  register_posture(m);
  register_batches(m);

  py::class_<ImpactJump<double>> jump_type(
      m, "Jump", "Velocity jump of base and joints at an impact, equation (6).");
  add_view(
      jump_type, "Delta_Omega", [](const auto& j) -> auto& { return j.Delta_Omega; },
      "Of the base [v; omega] in B, (6,), m/s, rad/s.");
  add_view(
      jump_type, "Delta_phidot", [](const auto& j) -> auto& { return j.Delta_phidot; },
      "Of the joint rates, (n,), rad/s (m/s).");

  py::class_<Robot, std::shared_ptr<Robot>> robot(
      m, "Robot",
      "A tree of rigid bodies on a free-floating base, with one hand frame. It does not change:\n"
      "any number of threads may use it at once.");
  robot.def_static(
      "from_file",
      [](const std::filesystem::path& path, const std::string& hand) {
        return robot_from_text(read_text_file(path.string(), kMaxUrdfBytes), hand, path.string());
      },
      py::arg("path"), py::arg("hand") = "",
      "Reads a URDF file. `hand` names the hand link; without it the only link without children.\n"
      "Raises InputError with file, line and rule of everything wrong, FileError.");
  robot.def_static("from_urdf", &robot_from_text, py::arg("text"), py::arg("hand") = "",
                   py::arg("source") = "urdf",
                   "Reads URDF text; `source` names it in messages. Raises InputError.");
  robot.def_static(
      "from_dict", &robot_from_section, py::arg("section"), py::arg("folder") = ".",
      py::arg("source") = "robot",
      "Reads what the section `robot` of a problem file states, from a dict, dataclass or\n"
      "SimpleNamespace; files are named relative to `folder`. Raises InputError, FileError.");
  robot.def_property_readonly(
      "name", [](const Robot& r) { return r.model.name; }, "Name in the robot file.");
  robot.def_property_readonly(
      "hand", [](const Robot& r) { return r.model.hand; }, "Name of the hand link.");
  robot.def_readonly("urdf", &Robot::urdf, "Text of the robot file.");
  robot.def_property_readonly(
      "n", [](const Robot& r) { return r.model.n(); }, "Number of joints that move.");
  robot.def_property_readonly(
      "total_mass", [](const Robot& r) { return r.model.total_mass(); }, "kg.");
  robot.def_property_readonly(
      "joint_names", [](const Robot& r) { return io::joint_names(r.model); },
      "Names of the joints in the order of all joint vectors.");
  const auto limit = [&robot](const char* name, double Joint::*member, const char* doc) {
    robot.def_property_readonly(
        name,
        [member](const Robot& r) {
          Eigen::VectorXd out(r.model.n());
          for (int k = 0; k < r.model.n(); ++k) {
            out[k] = r.model.joints[static_cast<std::size_t>(k)].*member;
          }
          return array_of(out);
        },
        doc);
  };
  limit("lower", &Joint::lower, "Lower joint limits, (n,), rad (m); -inf: none.");
  limit("upper", &Joint::upper, "Upper joint limits, (n,), rad (m); inf: none.");
  limit("max_velocity", &Joint::max_velocity, "Rate limits, (n,), rad/s (m/s); inf: none.");
  limit("max_effort", &Joint::max_effort, "Torque limits, (n,), N m (N); inf: none.");
  limit(
      "rotor_inertia", &Joint::rotor_inertia,
      "Inertias of the rotors about their axes, (n,), kg m^2; H_phi has gear_ratio^2 times them.");
  limit("gear_ratio", &Joint::gear_ratio,
        "Rates of the rotors per rate of the joints, (n,), 1 (rad/m).");
  robot.def("evaluate", &evaluate, py::arg("phi"), py::kw_only(),
            py::arg("added_inertia") = py::none(), py::arg("locked") = std::vector<bool>{},
            "Kinematics and dynamics at joint positions phi (n,), rad (m).\n"
            "\n"
            "added_inertia: inertia added to the joints' during an impact, (n,), kg m^2 (kg);\n"
            "locked: n flags, joints that do not move during an impact. Raises ValueError.");
  robot.def("jump", &jump, py::arg("phi"), py::arg("impulse"), py::kw_only(),
            py::arg("added_inertia") = py::none(), py::arg("locked") = std::vector<bool>{},
            "Velocity jump (6) at joint positions phi (n,), rad (m), for an impulse [f; t] at the\n"
            "hand in B, (6,), N s, N m s. Keywords as for evaluate(). Raises ValueError.");
  robot.def("respond", &evaluate_batch, py::arg("phi"), py::arg("impulse"), py::kw_only(),
            py::arg("approach") = py::none(), py::arg("target_inverse_mass") = py::none(),
            py::arg("added_inertia") = py::none(), py::arg("locked") = std::vector<bool>{},
            "Responses of k postures phi (k, n), rad (m), several at a time in the lanes of wide\n"
            "registers; other Python threads run meanwhile.\n"
            "\n"
            "impulse: [f; t] at the hand in B, (k, 6) or (6,) for all, N s, N m s. With approach\n"
            "(1 + e) v_n, (k,), m/s, and target_inverse_mass n' W_t n, (k,), 1/kg, the impulse is\n"
            "a unit force and its size p follows from the contact law\n"
            "p = approach / (F' W_h F + target_inverse_mass). Raises ValueError.");
  robot.def("objective", &evaluate_batch_objective, py::arg("phi"), py::arg("impulse"),
            py::arg("weights"), py::kw_only(), py::arg("derivatives") = true,
            py::arg("approach") = py::none(), py::arg("target_inverse_mass") = py::none(),
            py::arg("added_inertia") = py::none(), py::arg("locked") = std::vector<bool>{},
            "psi = 1/2 p^2 sum of weight |part|^2 at k postures, with exact gradients, several\n"
            "postures at a time; other arguments as for respond().\n"
            "\n"
            "weights: of base_velocity, base_rate, base_angular_momentum, total_angular_momentum,\n"
            "received_linear_momentum, received_angular_momentum, joint_rates, impulse.");
  robot.def("__repr__", [](const Robot& r) {
    return fmt::format("<stillbase.Robot '{}', {} joints, hand '{}'>", r.model.name, r.model.n(),
                       r.model.hand);
  });
}

}  // namespace stillbase::python
