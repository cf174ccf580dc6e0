#include "search/roll.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include <stillbase/core/parallel.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/turns.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

namespace {

/// The joint that turns the hand's body alone; -1: none does.
int roll_joint(const RobotModel& robot) {
  if (robot.hand_body < 0) return -1;
  const int joint = robot.coordinate(robot.hand_body);
  const bool is_prismatic =
      robot.joints[static_cast<std::size_t>(joint)].type == JointType::Prismatic;
  return is_prismatic || takes_part_in_coupling(robot, joint) ? -1 : joint;
}

/// The variable that is its angle; -1: none is.
Eigen::Index roll_variable(const CaptureProblem& problem, const Formulation& formulation) {
  const std::vector<int>& joints = formulation.parts().model.layout.joints;
  const auto at = std::find(joints.begin(), joints.end(), roll_joint(problem.robot));
  return at == joints.end() ? -1 : at - joints.begin();
}

/// Angles of a roll, those nearest to `start` first: `start` itself, or the end of the range
/// towards it, and `count` parts of the range.
std::vector<double> angles_from(double start, const SolutionFamily& roll, int joint, int count) {
  const double lower = roll.points.front().phi[joint], upper = lower + roll.length;
  const double nearest = std::clamp(roll.is_closed ? wrap_angle(start) : start, lower, upper);
  std::vector<double> angles{nearest};
  for (int i = 0; i <= count; ++i) angles.push_back(lower + roll.length * i / count);
  const auto distance = [&](double angle) {
    return std::abs(roll.is_closed ? wrap_angle(angle - nearest) : angle - nearest);
  };
  std::stable_sort(angles.begin(), angles.end(),
                   [&](double a, double b) { return distance(a) < distance(b); });
  return angles;
}

double size_of(double half_square) { return std::sqrt(2 * half_square); }

/// Whether a condition holds for all of the indices 0 .. count - 1, on several threads. Where one
/// fails the others need not be looked at.
bool hold_for_all(int jobs, int count, const std::function<bool(int)>& holds) {
  std::atomic<bool> has_failed{false};
  for_each_index(jobs, count, {}, [&](int i) {
    if (!has_failed && !holds(i)) has_failed = true;
  });
  return !has_failed;
}

}  // namespace

std::optional<SolutionFamily> roll_through(
    const CaptureProblem& problem, const Formulation& formulation, const Eigen::VectorXd& x,
    const std::function<double(const Eigen::VectorXd&)>& value, int jobs,
    const RollOptions& options) {
  const Eigen::Index k = roll_variable(problem, formulation);
  if (k < 0) return std::nullopt;
  const int joint = roll_joint(problem.robot);
  const bool is_closed = is_endless(problem.robot, joint);
  const VariableLayout& layout = formulation.parts().model.layout;
  const double lower = is_closed ? -kPi : layout.lower_limit[k];
  const double upper = is_closed ? kPi : layout.upper_limit[k];
  if (!(upper > lower)) return std::nullopt;
  const auto at = [&](int i, int count) {
    Eigen::VectorXd there = x;
    there[k] = i == count ? upper : lower + (upper - lower) * i / count;
    return there;
  };
  const auto is_same = [&](double a, double b) {
    return std::abs(size_of(a) - size_of(b)) <= options.same;
  };
  std::vector<Eigen::VectorXd> turned{x};
  for (int i = 0; i <= options.angles; ++i) turned.push_back(at(i, options.angles));
  const Eigen::VectorXd nominal =
      formulation.evaluate_points(turned, {formulation.nominal_scenario()});
  for (const double there : nominal) {
    if (!is_same(there, nominal[0])) return std::nullopt;
  }
  if (!hold_for_all(jobs, options.angles + 1, [&](int i) {
        return largest_violation(problem, formulation, at(i, options.angles)) <=
               kFeasibilityTolerance;
      })) {
    return std::nullopt;
  }
  const double measured = value ? value(x) : 0;
  if (value && !hold_for_all(jobs, options.measured + 1, [&](int i) {
        return is_same(value(at(i, options.measured)), measured);
      })) {
    return std::nullopt;
  }
  SolutionFamily out;
  out.length = upper - lower;
  out.is_closed = is_closed;
  out.is_complete = true;
  const int parts = is_closed ? 2 : 1;
  // The base stands where it stands: its position must not differ by rounding.
  const Configuration middle = formulation.configuration(x);
  for (int i = 0; i <= parts; ++i) {
    out.points.push_back(middle);
    out.points.back().phi[joint] = at(i, parts)[k];
  }
  return out;
}

void join_rolls(const CaptureProblem& problem, const Formulation& formulation,
                const std::function<double(const Eigen::VectorXd&)>& value,
                const std::function<bool(const Configuration&)>& is_free, const StopCondition& stop,
                int jobs, std::vector<Solution>& solutions, std::vector<SolutionFamily>& families,
                const RollOptions& options) {
  const Eigen::Index k = roll_variable(problem, formulation);
  if (k < 0) return;
  std::vector<Solution> joined;
  const auto first_roll = static_cast<int>(families.size());
  const auto touches_nothing = [&](const Eigen::VectorXd& x) {
    return !is_free || is_free(formulation.configuration(x));
  };
  std::sort(solutions.begin(), solutions.end(), better);
  // One that is known but for its roll.
  const auto find_known = [&](const Solution& solution) {
    return std::find_if(joined.begin(), joined.end(), [&](const Solution& other) {
      if (solution.family >= 0 || other.family < first_roll) return false;
      Eigen::VectorXd turned = solution.x;
      turned[k] = other.x[k];
      return formulation.are_within(turned, other.x, options.same_other);
    });
  };
  std::vector<std::optional<SolutionFamily>> rolls(solutions.size());
  std::mutex mutex;  // of what is joined
  const auto work = [&](int i) {
    const Solution& solution = solutions[static_cast<std::size_t>(i)];
    if (solution.family >= 0 || stop.reached()) return;
    {
      const std::lock_guard lock(mutex);
      if (find_known(solution) != joined.end()) return;
    }
    rolls[static_cast<std::size_t>(i)] =
        roll_through(problem, formulation, solution.x, value, 1, options);
  };
  const auto take = [&](int i) {
    const std::lock_guard lock(mutex);
    const Solution& solution = solutions[static_cast<std::size_t>(i)];
    std::optional<SolutionFamily>& roll = rolls[static_cast<std::size_t>(i)];
    const auto known = find_known(solution);
    if (known != joined.end()) {
      known->reached += solution.reached;
      families[static_cast<std::size_t>(known->family)].starts += solution.reached;
      if (touches_nothing(known->x)) return;
      Eigen::VectorXd turned = known->x;
      turned[k] = solution.x[k];
      if (touches_nothing(turned)) known->x = turned;
      return;
    }
    joined.push_back(solution);
    if (!roll) return;
    roll->starts = solution.reached;
    joined.back().family = static_cast<int>(families.size());
    families.push_back(std::move(*roll));
  };
  for_each_index(jobs, static_cast<int>(solutions.size()), {}, work, take);
  // Which of them the search met is rounding, so the joint stays where the arm starts.
  const int joint = roll_joint(problem.robot);
  for_each_index(jobs, static_cast<int>(joined.size()), stop, [&](int i) {
    Solution& solution = joined[static_cast<std::size_t>(i)];
    if (solution.family < first_roll) return;
    const SolutionFamily& roll = families[static_cast<std::size_t>(solution.family)];
    for (const double angle : angles_from(problem.start[joint], roll, joint, options.angles)) {
      Eigen::VectorXd turned = solution.x;
      turned[k] = angle;
      if (!touches_nothing(turned)) continue;
      solution.x = turned;
      return;
    }
  });
  solutions = std::move(joined);
}

}  // namespace stillbase
