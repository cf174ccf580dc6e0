// stillbase inspect: every matrix of a robot at one state, in the base frame.
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/io/state_file.hpp>

#include "app/command_line.hpp"
#include "app/words.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct InspectRequest {
  std::string robot, hand, state;
  OutputFile output;
  bool json = false;
};

io::Inspection inspect(const RobotModel& robot, const RobotState& state) {
  const auto kinematics = compute_kinematics<double>(robot, state.phi);
  const auto inertia = compute_inertia<double>(robot, kinematics);
  const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
  const auto tilde = compute_tilde_inertia<double>(inertia);
  const auto hat = compute_hat_inertia<double>(inertia, jacobian);
  const auto bias = compute_bias<double>(robot, kinematics, inertia, state.Omega, state.phidot);
  const auto momentum = compute_momentum<double>(inertia, tilde, state.Omega, state.phidot);
  const ReactionNullSpace space = angular_reaction_null_space(tilde);
  const auto factor = factorize_inertia<double>(inertia, JointVectord::Zero(robot.n()), {});
  io::Inspection out{.robot = robot,
                     .total_mass = robot.total_mass(),
                     .centroid = inertia.r_bg,
                     .hand_position = kinematics.r_bh,
                     .H_b = inertia.H_b,
                     .H_bphi = inertia.H_bphi,
                     .H_phi = inertia.H_phi,
                     .J_phi = jacobian.J_phi,
                     .R_bh = jacobian.R_bh,
                     .c_b = bias.c_b,
                     .c_phi = bias.c_phi,
                     .P = momentum.P,
                     .L_g = momentum.L_g,
                     .Htilde_omega = tilde.Htilde_omega,
                     .Htilde_omegaphi = tilde.Htilde_omegaphi,
                     .Htilde_phi = tilde.Htilde_phi,
                     .Hhat_phi = hat.Hhat_phi,
                     .Jhat_phi = hat.Jhat_phi,
                     .rns_rank = space.rank,
                     .singular_values = space.singular_values,
                     .hand_inverse_inertia = extended_inverse_inertia(factor, jacobian),
                     .impact = {}};
  // The state names no target, so nothing closes in.
  if (state.Fbar) out.impact = summarize_impact(robot, state.phi, {}, *state.Fbar, 0);
  return out;
}

std::string table(const Json& matrix) {
  std::string text;
  for (const Json& row : matrix) {
    text += "   ";
    if (row.is_array()) {
      for (const Json& x : row) text += fmt::format(" {:>11.5g}", x.get<double>());
    } else {
      text += fmt::format(" {:>11.5g}", row.get<double>());
    }
    text += '\n';
  }
  return text;
}

std::string row(const Json& vector) { return table(Json::array({vector})); }

std::string inspection_words(const RobotModel& robot, const RobotState& state, const Json& json) {
  struct Entry {
    const char *key, *meaning;
  };
  constexpr Entry kVectors[] = {{"centroid", "system centroid, m"},
                                {"hand_position", "hand, m"},
                                {"P", "linear momentum, N s"},
                                {"L_g", "angular momentum about the system centroid, N m s"},
                                {"c_b", "velocity-dependent force and moment at the base, N, N m"},
                                {"c_phi", "velocity-dependent joint torques, N m"},
                                {"singular_values", "of Htilde_omegaphi"}};
  constexpr Entry kMatrices[] = {{"H_b", "base inertia"},
                                 {"H_bphi", "inertia coupling"},
                                 {"H_phi", "arm inertia on a fixed base"},
                                 {"J_phi", "hand Jacobian on a fixed base"},
                                 {"R_bh", "shift of velocity from base to hand"},
                                 {"Htilde_omega", "central inertia of the locked robot"},
                                 {"Htilde_omegaphi", "angular coupling"},
                                 {"Htilde_phi", "arm inertia, base free to translate"},
                                 {"Hhat_phi", "generalized inertia, base free"},
                                 {"Jhat_phi", "generalized Jacobian, base free"},
                                 {"hand_inverse_inertia", "hand velocity change per impulse"}};
  std::string text = fmt::format(
      "robot {}, hand {}, {:.6g} kg; everything in the base frame (origin at the base "
      "body's centroid), SI units\nposture: {}\n",
      robot.name, robot.hand, robot.total_mass(), posture_words(robot, state.phi));
  for (const Entry& entry : kVectors) {
    text += fmt::format("{} ({})\n{}", entry.key, entry.meaning, row(json.at(entry.key)));
  }
  for (const Entry& entry : kMatrices) {
    text += fmt::format("{} ({})\n{}", entry.key, entry.meaning, table(json.at(entry.key)));
  }
  text += fmt::format("rank of the angular coupling: {}\n", json.at("rns_rank").get<int>());
  if (json.contains("impact")) text += "impact\n" + io::pretty(json.at("impact"));
  return text;
}

int inspect_robot(const InspectRequest& request) {
  request.output.check();
  const RobotModel robot = load_robot(request.robot, request.hand);
  const RobotState state = request.state.empty()
                               ? zero_state(robot)
                               : read_state(read_text_file(request.state), request.state, robot);
  Json json;
  try {
    io::Inspection inspection = inspect(robot, state);
    json = io::written([&](io::Table& t) { io::inspection_fields(t, inspection); });
  } catch (const io::NotFiniteError&) {
    // Numbers of a file that are finite alone but not in products with each other.
    throw InputError({{request.state.empty() ? request.robot : request.state, 0, "not-finite",
                       "the matrices at this state do not fit a double"}});
  }
  const bool as_json = request.json || extension_of(request.output.path) == ".json";
  request.output.write(as_json ? io::pretty(json) : inspection_words(robot, state, json));
  return kDone;
}

}  // namespace

Command inspect_command() {
  auto request = std::make_shared<InspectRequest>();
  return {
      "inspect", "print the dynamics and impact matrices of a robot",
      std::vector<Option>{
          {"robot", "ROBOT.urdf", "robot file (URDF)", &request->robot, true},
          {"--hand", "LINK", "hand link; needed when there are several ends", &request->hand},
          {"--state", "STATE.json", "joint positions, velocities, impulse (JSON)", &request->state},
          {"--json", "", "print one JSON object", &request->json}} +
          output_options(request->output, "-o,--output",
                         "JSON with .json, else text; without it stdout"),
      [request] { return inspect_robot(*request); }};
}

}  // namespace stillbase::app
