#include <stillbase/benchmark/suite.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "formulation/projection.hpp"

namespace stillbase {

namespace {

/// FNV-1a: names key random streams.
std::uint64_t hash(const std::string& text) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return h;
}

InputError nothing_to_vary(const FamilySpec& family, const std::string& what) {
  return InputError(
      {{family.problem.source, 0, "nothing-to-vary", "family " + family.name + ": " + what}});
}

bool is_planar(const CaptureProblem& problem) {
  return problem.uncertainty.cone_plane_normal.has_value();
}

/// Any direction; in a plane of B any direction in it.
Vector3d random_direction(const CaptureProblem& problem, Random& random) {
  if (!is_planar(problem)) return random.unit_vector();
  const Vector3d axis = *problem.uncertainty.cone_plane_normal;
  return Eigen::AngleAxisd(random.uniform(0, 2 * kPi), axis) * axis.unitOrthogonal();
}

Eigen::Quaterniond random_rotation(const CaptureProblem& problem, Random& random) {
  if (is_planar(problem)) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(random.uniform(0, 2 * kPi), *problem.uncertainty.cone_plane_normal));
  }
  const Vector3d axis = random.unit_vector();
  // Uniform over rotations: the angle's density is (1 - cos) / pi on [0, pi].
  double angle = 0;
  do {
    angle = random.uniform(0, kPi);
  } while (random.uniform(0, 2) > 1 - std::cos(angle));
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

void apply(Variation variation, const FamilySpec& family, Random& random, CaptureProblem& problem) {
  switch (variation) {
    case Variation::ImpulseDirection:
      if (!problem.impulse.direction) {
        throw nothing_to_vary(family, "the problem states no direction of the impulse");
      }
      problem.impulse.direction = random_direction(problem, random);
      return;
    case Variation::HandPosition: {
      if (problem.hand.constraint == HandConstraint::None || !problem.hand.position) {
        throw nothing_to_vary(family, "the problem states no position of the hand");
      }
      const auto kinematics =
          compute_kinematics<double>(problem.robot, random_posture(problem.robot, random));
      problem.hand.frame = Frame::Base;
      problem.hand.position = kinematics.r_bh;
      if (problem.hand.orientation) {
        problem.hand.orientation = Eigen::Quaterniond(kinematics.R_hand).normalized();
      }
      return;
    }
    case Variation::TargetAttitude: {
      if (!problem.target) throw nothing_to_vary(family, "the problem has no target");
      Eigen::Quaterniond& attitude = problem.target_state.pose.orientation;
      attitude = (random_rotation(problem, random) * attitude).normalized();
      return;
    }
    case Variation::TargetSpin: {
      Vector3d& omega = problem.target_state.angular_velocity;
      if (!problem.target || omega.isZero(0)) {
        throw nothing_to_vary(family, "the problem has no rotating target");
      }
      if (is_planar(problem)) {
        omega *= random.uniform() < 0.5 ? -1 : 1;
      } else {
        omega = omega.norm() * random.unit_vector();
      }
      return;
    }
  }
}

void free_variables(const FamilySpec& family, CaptureProblem& problem) {
  VariableSpec& variables = problem.variables;
  if (family.free_attitude > 0) {
    variables.base_attitude = is_planar(problem) ? AttitudeFreedom::Axis : AttitudeFreedom::Free;
    if (is_planar(problem)) variables.base_attitude_axis = *problem.uncertainty.cone_plane_normal;
    variables.base_attitude_max = family.free_attitude;
  }
  if (family.free_contact_time > 0) {
    const double middle = (variables.contact_time_lower + variables.contact_time_upper) / 2;
    variables.contact_time_lower = middle - family.free_contact_time;
    variables.contact_time_upper = middle + family.free_contact_time;
  }
}

/// Whether one of some starts satisfies the constraints.
bool is_satisfiable(const CaptureProblem& problem, const InstanceOptions& options) {
  const Formulation formulation(problem);
  for (int start = 0; start < options.starts; ++start) {
    const Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(start, formulation.num_variables(), 0));
    const ProjectionResult there = project_onto_constraints(formulation, x, false, options.steps);
    // report() also knows a closing speed that is the same for every posture, which is no row.
    const std::vector<ConstraintValue> values = formulation.report(there.x);
    if (there.violation < options.violation &&
        std::all_of(values.begin(), values.end(),
                    [&](const auto& value) { return value.violation < options.violation; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

JointVectord random_posture(const RobotModel& robot, Random& random) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const bool bounded = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    phi[k] = bounded ? random.uniform(joint.lower, joint.upper) : random.uniform(-kPi, kPi);
  }
  return phi;
}

std::string to_string(BenchmarkGoal goal) {
  static constexpr const char* kNames[] = {"nominal", "worst_case", "case"};
  return kNames[static_cast<std::size_t>(goal)];
}

BenchmarkInstance make_instance(const FamilySpec& family, BenchmarkGoal goal, int number,
                                const InstanceOptions& options) {
  for (int encounter = 0; encounter < options.encounters; ++encounter) {
    Random random(hash(family.name),
                  static_cast<std::uint64_t>(number * options.encounters + encounter));
    BenchmarkInstance out;
    out.family = family.name;
    out.goal = goal;
    out.name = family.name + "/" + to_string(goal) + "/" + std::to_string(number);
    out.problem = family.problem;
    // What is asked is the goal; nothing of the base problem's own question is left.
    out.problem.constraints.impact_case = CaseConstraint::None;
    out.problem.uncertainty.cone_half_angle = family.cone_half_angle;
    free_variables(family, out.problem);
    for (const Variation variation : family.vary) {
      apply(variation, family, random, out.problem);
    }
    if (!is_satisfiable(out.problem, options)) continue;
    if (goal == BenchmarkGoal::Case) out.problem.constraints.impact_case = family.impact_case;
    return out;
  }
  throw InputError({{family.problem.source, 0, "not-satisfiable",
                     "family " + family.name + ": none of " + std::to_string(options.encounters) +
                         " encounters is within reach of the robot"}});
}

}  // namespace stillbase
