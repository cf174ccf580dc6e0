#include <stillbase/plan/turns.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/scenario.hpp>

namespace stillbase {

namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kSlack = 1e-9;  ///< rad: an angle at its limit is within it

/// How far the joints are from the start posture, rad, then the sum of their angles: what is less
/// goes first. Ways that differ by rounding are equal.
std::pair<double, double> rank_by_way(const CaptureProblem& problem, const Configuration& at) {
  constexpr double kSameWay = 1e-9;  // rad
  const double way = (at.phi - problem.start).norm();
  return {std::round(way / kSameWay), at.phi.lpNorm<1>()};
}

/// Turns from an angle to the last one within limits in the sense of `sign`.
int turns_until(double room) { return static_cast<int>(std::floor((room + kSlack) / kTurn)); }

}  // namespace

bool takes_part_in_coupling(const RobotModel& robot, int joint) {
  int bodies = 0;
  for (const Coupling& coupling : robot.couplings) {
    if (coupling.joint != joint) continue;
    if (++bodies > 1 || coupling.ratio != 1) return true;
  }
  return false;
}

bool is_endless(const RobotModel& robot, int joint) {
  return robot.joints[static_cast<std::size_t>(joint)].type == JointType::Continuous &&
         !takes_part_in_coupling(robot, joint);
}

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

bool is_nearer_to_start(const CaptureProblem& problem, const Configuration& a,
                        const Configuration& b) {
  return rank_by_way(problem, a) < rank_by_way(problem, b);
}

JointVectord way_from_start(const CaptureProblem& problem, const Configuration& configuration) {
  JointVectord way = configuration.phi - problem.start;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (is_endless(problem.robot, k)) way[k] = wrap_angle(way[k]);
  }
  for (const JointTurns& turns : whole_turns(problem, configuration, std::nullopt)) {
    double& of_joint = way[find_joint(problem.robot, turns.joint)];
    of_joint += kTurn * std::clamp<double>(std::round(-of_joint / kTurn), turns.least, turns.most);
  }
  return way;
}

double least_way_from_start(const CaptureProblem& problem, const Configuration& configuration) {
  return way_from_start(problem, configuration).norm();
}

std::vector<Configuration> other_turns(const CaptureProblem& problem,
                                       const Configuration& configuration,
                                       std::optional<int> rolled, std::size_t most) {
  // The squares of the joints' ways add up: of the nearest, each part is among the nearest of its
  // kind.
  const std::size_t kept = most + 1;
  const auto width = static_cast<int>(kept);
  std::vector<Configuration> out{configuration};
  for (const JointTurns& turns : whole_turns(problem, configuration, rolled)) {
    const int k = find_joint(problem.robot, turns.joint);
    const double wanted = std::round((problem.start[k] - configuration.phi[k]) / kTurn);
    const int nearest = static_cast<int>(std::clamp<double>(wanted, turns.least, turns.most));
    const int first = std::max(turns.least, nearest - width);
    const int last = std::min(turns.most, nearest + width);
    std::vector<Configuration> grown;
    for (const Configuration& at : out) {
      for (int turn = first; turn <= last; ++turn) {
        grown.push_back(at);
        grown.back().phi[k] += turn * kTurn;
      }
    }
    std::stable_sort(grown.begin(), grown.end(), [&](const auto& a, const auto& b) {
      return is_nearer_to_start(problem, a, b);
    });
    if (grown.size() > kept) grown.resize(kept);
    out = std::move(grown);
  }
  const auto is_same = [&](const Configuration& at) { return at.phi == configuration.phi; };
  out.erase(std::remove_if(out.begin(), out.end(), is_same), out.end());
  if (out.size() > most) out.resize(most);
  return out;
}

}  // namespace stillbase
