#include <stillbase/plan/turns.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/scenario.hpp>

namespace stillbase {

namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kSlack = 1e-9;  ///< rad: an angle at its limit is within it

/// Whether other bodies' joints follow this one, or its body moves otherwise than by its angle.
bool takes_part_in_coupling(const RobotModel& robot, int joint) {
  int bodies = 0;
  for (const Coupling& coupling : robot.couplings) {
    if (coupling.joint != joint) continue;
    if (++bodies > 1 || coupling.ratio != 1) return true;
  }
  return false;
}

/// Turns from an angle to the last one within limits in the sense of `sign`.
int turns_until(double room) { return static_cast<int>(std::floor((room + kSlack) / kTurn)); }

}  // namespace

bool has_whole_turns(const CaptureProblem& problem, int joint) {
  const auto index = static_cast<std::size_t>(joint);
  const Joint& at = problem.robot.joints[index];
  if (at.type != JointType::Revolute || !problem.variables.joints[index]) return false;
  if (!problem.user.empty() || simulates_turn(problem)) return false;
  if (takes_part_in_coupling(problem.robot, joint)) return false;
  const double range = at.upper - at.lower - 2 * problem.constraints.joint_limit_margin;
  return std::isfinite(range) && range >= kTurn;
}

double central_angle(const Joint& joint, double angle) {
  const double middle = (joint.lower + joint.upper) / 2;
  return angle - kTurn * std::round((angle - middle) / kTurn);
}

std::vector<JointTurns> whole_turns(const CaptureProblem& problem,
                                    const Configuration& configuration, std::optional<int> rolled) {
  std::vector<JointTurns> out;
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (k == rolled || !has_whole_turns(problem, k)) continue;
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    const double angle = configuration.phi[k];
    const int down = turns_until(angle - joint.lower - margin);
    const int up = turns_until(joint.upper - margin - angle);
    if (down > 0 || up > 0) out.push_back({joint.name, -std::max(down, 0), std::max(up, 0)});
  }
  return out;
}

std::vector<Configuration> other_turns(const CaptureProblem& problem,
                                       const Configuration& configuration,
                                       std::optional<int> rolled, std::size_t most) {
  constexpr std::size_t kMany = 4096;  // of a long arm all of whose joints have copies
  std::vector<Configuration> out{configuration};
  for (const JointTurns& turns : whole_turns(problem, configuration, rolled)) {
    const auto& joints = problem.robot.joints;
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const auto& j) { return j.name == turns.joint; });
    const std::size_t count = out.size();
    for (int turn = turns.least; turn <= turns.most && out.size() < kMany; ++turn) {
      for (std::size_t i = 0; i < count && turn != 0; ++i) {
        out.push_back(out[i]);
        out.back().phi[joint - joints.begin()] += turn * kTurn;
      }
    }
  }
  out.erase(out.begin());
  const auto way = [&](const Configuration& at) { return (at.phi - problem.start).lpNorm<1>(); };
  std::stable_sort(out.begin(), out.end(),
                   [&](const Configuration& a, const Configuration& b) { return way(a) < way(b); });
  if (out.size() > most) out.resize(most);
  return out;
}

}  // namespace stillbase
