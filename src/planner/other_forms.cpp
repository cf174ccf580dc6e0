#include "planner/other_forms.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/plan/turns.hpp>

namespace stillbase {

namespace {

constexpr double kSameRoll = 0.05;  ///< rad

std::optional<int> rolled_joint(const SearchResult& found, std::size_t candidate) {
  const int family = found.candidates[candidate].family;
  if (family < 0) return std::nullopt;
  return free_joint(found.families[static_cast<std::size_t>(family)]);
}

}  // namespace

void take_nearest_turns(const CaptureProblem& problem, SearchResult& found) {
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    Configuration& at = found.candidates[i].configuration;
    for (const Configuration& other : other_turns_of(problem, found, i, 1)) {
      if (!is_nearer_to_start(problem, other, at)) continue;
      found.points[i] = variables_of_form(problem, found, i, other);
      at = other;
    }
  }
}

std::vector<Configuration> other_turns_of(const CaptureProblem& problem, const SearchResult& found,
                                          std::size_t candidate, std::size_t most) {
  return other_turns(problem, found.candidates[candidate].configuration,
                     rolled_joint(found, candidate), most);
}

std::vector<Configuration> other_rolls_of(const CaptureProblem& problem, const SearchResult& found,
                                          std::size_t candidate, std::size_t most) {
  const std::optional<int> joint = rolled_joint(found, candidate);
  if (!joint) return {};
  const Candidate& known = found.candidates[candidate];
  const SolutionFamily& roll = found.families[static_cast<std::size_t>(known.family)];
  const auto apart = [&](double a, double b) {
    return std::abs(roll.is_closed ? wrap_angle(a - b) : a - b);
  };
  const double lower = roll.points.front().phi[*joint], upper = roll.points.back().phi[*joint];
  const double step = (upper - lower) / static_cast<double>(most);
  // Where the start posture has it, the joint need not move.
  std::vector<double> angles{std::clamp(problem.start[*joint], lower, upper)};
  for (std::size_t i = 0; i < most; ++i) {
    angles.push_back(lower + (static_cast<double>(i) + 0.5) * step);
  }
  std::vector<Configuration> out;
  for (const double angle : angles) {
    // Beside a roll that is known little is different.
    const bool is_near = std::any_of(out.begin(), out.end(), [&](const Configuration& other) {
      return apart(angle, other.phi[*joint]) < step / 4;
    });
    if (is_near || apart(angle, known.configuration.phi[*joint]) < kSameRoll) continue;
    out.push_back(known.configuration);
    out.back().phi[*joint] = angle;
  }
  std::stable_sort(out.begin(), out.end(), [&](const Configuration& a, const Configuration& b) {
    const double start = problem.start[*joint];
    return apart(a.phi[*joint], start) < apart(b.phi[*joint], start);
  });
  if (out.size() > most) out.resize(most);
  return out;
}

// The variables begin with the free joints, in their order.
Eigen::VectorXd variables_of_form(const CaptureProblem& problem, const SearchResult& found,
                                  std::size_t candidate, const Configuration& form) {
  Eigen::VectorXd x = found.points[candidate];
  Eigen::Index row = 0;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (problem.variables.joints[static_cast<std::size_t>(k)]) x[row++] = form.phi[k];
  }
  return x;
}

bool turns_like_a_top(const RobotModel& robot, int joint) {
  constexpr double kRounding = 1e-9;
  const auto k = static_cast<std::size_t>(joint);
  const bool is_last = std::none_of(robot.joints.begin(), robot.joints.end(),
                                    [joint](const Joint& one) { return one.parent == joint; });
  if (robot.is_coupled() || robot.joints[k].is_prismatic() || !is_last) return false;
  // The axis is z of the body.
  const Body& body = robot.bodies[k];
  const Matrix3d& I = body.inertia;
  const double uneven = std::max(
      {std::abs(I(0, 0) - I(1, 1)), std::abs(I(0, 1)), std::abs(I(0, 2)), std::abs(I(1, 2))});
  return body.centroid.head<2>().norm() <= kRounding && uneven <= kRounding * I.norm();
}

namespace {

/// Whether what a configuration exceeds after the impact it does at every angle of its free joint:
/// neither the impact nor the masses depend on that, but for the limits of this joint itself.
bool fails_at_every_roll(const CaptureProblem& problem, const SearchResult& found,
                         std::size_t candidate, const std::string& failure) {
  const std::optional<int> joint = rolled_joint(found, candidate);
  if (!joint || failure.empty() || !turns_like_a_top(problem.robot, *joint)) return false;
  return !failure.starts_with(problem.robot.joints[static_cast<std::size_t>(*joint)].name);
}

}  // namespace

void take_forms_that_hold(const CaptureProblem& problem, const CollisionJudge& collisions,
                          const PlannerOptions& options, AfterImpactJudge& after,
                          SearchResult& found) {
  if (base_follows_path(problem)) return;  // collisions at the stated pose say little
  int tried = 0;
  for (std::size_t i = 0; i < found.candidates.size() && !options.stop.reached(); ++i) {
    Candidate& candidate = found.candidates[i];
    after.judge_from(i, found.candidates);
    if (candidate.collision_free && after.keeps_limits(candidate.configuration)) return;
    // Whole turns away the same bodies touch.
    std::vector<Configuration> forms;
    if (candidate.collision_free) {
      forms = other_turns_of(problem, found, i, options.other_turns);
    }
    const bool may_roll =
        !candidate.collision_free ||
        !fails_at_every_roll(problem, found, i, after.failure(candidate.configuration));
    if (may_roll) {
      for (Configuration& roll : other_rolls_of(problem, found, i, options.other_rolls)) {
        forms.push_back(std::move(roll));
      }
    }
    std::vector<Candidate> trials;
    std::vector<Configuration> to_judge;
    for (const Configuration& form : forms) {
      Candidate& trial = trials.emplace_back(candidate);
      trial.configuration = form;
      collisions.judge(trial);
      if (trial.collision_free) to_judge.push_back(form);
    }
    if (to_judge.empty()) continue;
    if (tried++ == problem.approach.max_approaches) return;
    after.judge_all(to_judge);
    for (const Candidate& trial : trials) {
      if (!trial.collision_free || !after.keeps_limits(trial.configuration)) continue;
      found.points[i] = variables_of_form(problem, found, i, trial.configuration);
      candidate = trial;
      return;
    }
  }
}

}  // namespace stillbase
