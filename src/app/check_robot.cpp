// stillbase check on a robot: bodies, joints, coupling, and what is suspicious.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <stillbase/benchmark/suite.hpp>
#include <stillbase/collision/contact_survey.hpp>
#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/robot/suspicions.hpp>

#include "app/check_report.hpp"
#include "app/words.hpp"

namespace stillbase::app {

namespace {

/// The centroid is that of the merged links, in the frame of the link that names the body.
std::string body_line(const RobotModel& robot, const Body& body) {
  const Vector3d principal = principal_moments(body.inertia);
  const LinkFrame* const link = find_link(robot, body.name);
  const Vector3d centroid =
      link == nullptr ? body.centroid : Vector3d(link->pose.inverse() * body.centroid);
  std::string text =
      fmt::format("  {}: {:.6g} kg, centroid {} m in its frame, principal moments {} kg m^2",
                  body.name, body.mass, vector_words(centroid), vector_words(principal));
  std::vector<std::string> merged = body.merged_links;
  merged.erase(std::remove(merged.begin(), merged.end(), body.name), merged.end());
  if (!merged.empty()) text += fmt::format(", with {}", fmt::join(merged, ", "));
  return text + '\n';
}

std::string joint_line(const Joint& joint) {
  const char* const unit = joint.is_prismatic() ? "m" : "deg";
  const double scale = joint.is_prismatic() ? 1 : kDegrees;
  std::string text = fmt::format("  {}: ", joint.name);
  if (joint.type == JointType::Continuous) {
    text += "continuous";
  } else {
    text +=
        fmt::format("{} from {:.6g} to {:.6g} {}", joint.is_prismatic() ? "prismatic" : "revolute",
                    joint.lower * scale, joint.upper * scale, unit);
  }
  if (std::isfinite(joint.max_velocity)) {
    text += fmt::format(", at most {:.6g} {}/s", joint.max_velocity * scale, unit);
  }
  if (std::isfinite(joint.max_effort)) {
    text += fmt::format(", {:.6g} {}", joint.max_effort, joint.is_prismatic() ? "N" : "N m");
  }
  if (joint.rotor_inertia != 0) {
    text += fmt::format(", drive {:.4g} {} (rotor {:.4g} kg m^2, gear ratio {:.6g})",
                        joint.reflected_inertia(), joint.is_prismatic() ? "kg" : "kg m^2",
                        joint.rotor_inertia, joint.gear_ratio);
  }
  return text + '\n';
}

/// Bodies whose joints follow those of others.
std::string coupling_lines(const RobotModel& robot) {
  std::string text;
  for (std::size_t k = 0; k < robot.couplings.size(); ++k) {
    const Coupling& coupling = robot.couplings[k];
    const Joint& master = robot.joints[static_cast<std::size_t>(coupling.joint)];
    if (robot.tree()[k].name == master.name) continue;
    text += fmt::format("  {} moves {} and follows {}: position = {:.6g} {} + {:.6g}\n",
                        robot.tree()[k].name, robot.bodies[k].name, master.name, coupling.ratio,
                        master.name, coupling.offset);
  }
  return text;
}

/// Angular coupling of arm and base at random postures within the joint limits.
struct Coupling {
  std::string words;
  int best_rank = 0, worst_rank = 3;
};

Coupling sample_coupling(const RobotModel& robot) {
  constexpr int kPostures = 64;
  Random random(1);
  std::map<int, int> ranks;
  Coupling coupling;
  double best = kInfinity, worst = 1;         // ratio of largest to smallest singular value
  double lightest = kInfinity, heaviest = 0;  // principal moments of the locked robot
  for (int i = 0; i < kPostures; ++i) {
    const auto kinematics = compute_kinematics<double>(robot, random_posture(robot, random));
    const auto tilde = compute_tilde_inertia<double>(compute_inertia<double>(robot, kinematics));
    const ReactionNullSpace space = angular_reaction_null_space(tilde);
    ++ranks[space.rank];
    coupling.best_rank = std::max(coupling.best_rank, space.rank);
    coupling.worst_rank = std::min(coupling.worst_rank, space.rank);
    if (space.rank > 0) {
      const double ratio = space.singular_values[0] / space.singular_values[space.rank - 1];
      best = std::min(best, ratio);
      worst = std::max(worst, ratio);
    }
    const Vector3d moments = principal_moments(tilde.Htilde_omega);
    lightest = std::min(lightest, moments[0]);
    heaviest = std::max(heaviest, moments[2]);
  }
  std::string text;
  for (const auto& [rank, count] : ranks) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} in {}", rank, count);
  }
  coupling.words = fmt::format("angular coupling: rank {} of {} random postures", text, kPostures);
  if (coupling.best_rank > 0) {
    coupling.words +=
        fmt::format("; largest to smallest singular value {:.3g} to {:.3g}", best, worst);
  }
  if (std::abs(lightest) < 1e-12 * heaviest) lightest = 0;  // rounding
  coupling.words += fmt::format("\nmoments of the locked robot there: {:.4g} to {:.4g} kg m^2\n",
                                lightest, heaviest);
  return coupling;
}

}  // namespace

std::string contact_suggestions(const RobotModel& robot) {
  const ContactSurvey survey = survey_contacts(robot);
  const auto lines = [](const ContactSurvey::LinkPairs& pairs) {
    std::string text;
    for (const auto& [a, b] : pairs) text += fmt::format("    - [{}, {}]\n", a, b);
    return text;
  };
  std::string text =
      "# Links that touch in every posture that was tried; paste them into `robot`.\n";
  text += survey.always.empty() ? "  # allowed_contacts: none is needed\n"
                                : "  allowed_contacts:\n" + lines(survey.always);
  if (!survey.never.empty()) {
    text += "# Links that touched in none; what they may do costs time alone.\n";
    for (const auto& [a, b] : survey.never) text += fmt::format("    # [{}, {}]\n", a, b);
  }
  return text;
}

std::string remark_lines(const std::vector<std::string>& remarks) {
  if (remarks.empty()) return "";
  std::string text = "suspicious:\n";
  for (const std::string& remark : remarks) text += "  " + remark + '\n';
  return text;
}

std::string robot_report(const RobotModel& robot) {
  const JointVectord zero = JointVectord::Zero(robot.n());
  const auto inertia = compute_inertia<double>(robot, compute_kinematics<double>(robot, zero));
  std::string text =
      fmt::format("robot {}: {}, {}, {:.6g} kg\n", robot.name,
                  count_words(robot.num_bodies() + 1, "body", "bodies after merging fixed links"),
                  count_words(robot.n(), "joint", "joints"), robot.total_mass());
  if (robot.total_mass() > 0) {
    text += fmt::format("system centroid with all joints at zero: {} m from the base centroid\n",
                        vector_words(inertia.r_bg));
  }
  text += "bodies:\n" + body_line(robot, robot.base);
  for (const Body& body : robot.bodies) text += body_line(robot, body);
  text += "joints:\n";
  for (const Joint& joint : robot.joints) text += joint_line(joint);
  text += coupling_lines(robot);
  text += fmt::format("hand: {}; collision shapes: {}\n", robot.hand, robot.shapes.size());
  if (!robot.remarks.empty()) text += "remarks on the robot file:\n";
  for (const Finding& remark : robot.remarks) text += "  " + to_string(remark) + '\n';
  std::vector<std::string> remarks = robot_suspicions(robot);
  if (robot.n() > 0) {
    const Coupling coupling = sample_coupling(robot);
    text += coupling.words;
    if (coupling.best_rank < std::min(3, robot.n())) {
      remarks.push_back(
          fmt::format("the joints can take over angular momentum about {} of 3 directions only, "
                      "in every posture",
                      coupling.best_rank));
    } else if (coupling.worst_rank < coupling.best_rank) {
      remarks.push_back("the angular coupling loses rank at some postures");
    }
  }
  return text + remark_lines(remarks);
}

std::string lone_state_report(const RobotState& state) {
  return fmt::format(
      "state of a robot that was not named; joints and limits are judged after it: check "
      "ROBOT.urdf STATE.json\n{} joint positions, {} joint rates; base velocity {} m/s, {} rad/s\n",
      state.phi.size(), state.phidot.size(), vector_words(state.Omega.head<3>()),
      vector_words(state.Omega.tail<3>()));
}

std::string state_report(const RobotState& state, const RobotModel& robot) {
  std::string text =
      fmt::format("state of {}\nposture: {}\n", robot.name, posture_words(robot, state.phi));
  text += fmt::format("base velocity: {} m/s, {} rad/s; joint rates at most {:.6g}\n",
                      vector_words(state.Omega.head<3>()), vector_words(state.Omega.tail<3>()),
                      robot.n() > 0 ? state.phidot.cwiseAbs().maxCoeff() : 0.0);
  if (state.Fbar) {
    text += fmt::format("impulse on the hand: {} N s, {} N m s\n",
                        vector_words(state.Fbar->head<3>()), vector_words(state.Fbar->tail<3>()));
  }
  std::vector<std::string> remarks;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    if (state.phi[k] >= joint.lower && state.phi[k] <= joint.upper) continue;
    remarks.push_back(joint.name + ": outside its limits");
  }
  return text + remark_lines(remarks);
}

}  // namespace stillbase::app
