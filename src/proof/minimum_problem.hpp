// What a lower bound is about: the measure of one problem over its configurations.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/proof/minimum.hpp>

#include "proof/bound.hpp"
#include "proof/zero_problem.hpp"

namespace stillbase::proof {

/// An impulse on the hand. Everything is stated in the frame E in which the direction is constant
/// (stillbase/encounter/encounter.hpp).
struct ImpulseCase {
  Vector6d F = Vector6d::Zero();  ///< wrench on the hand per unit of impulse, in E
  double weight = 1;              ///< in a mean
  /// p = numerator / (F' W_h F + target_inverse_mass), the numerator (1+e) v_n; of a given impulse
  /// p itself.
  double numerator = 1;
  std::optional<double> target_inverse_mass;  ///< n' W_t n, 1/kg; empty: the impulse is given
  /// With the time free: v_n = max(F . velocity of `point` + offset, 0), the numerator 1 + e.
  struct Closing {
    Vector3d point = Vector3d::Zero();  ///< of the target, in T, m
    double offset = 0;                  ///< m/s
  };
  std::optional<Closing> closing;
};

/// How exactly the planner's configurations and values are known, and what an impulse costs.
struct MinimumTolerances : EquationTolerances {
  double best_value = 1e-6;    ///< relative error of the best known value
  double unit_vector = 1e-12;  ///< of the lengths of directions, and of the sum of weights
  /// Divisors that change by less than this part over a box are expanded to second order.
  double nearly_constant = 0.5;
  double above_level = 1e-5;  ///< of the level, by which squares of impulses are tried above it
  double impulses_per_posture = 128;  ///< impulses of a mean that cost as much as a box itself
};

struct MinimumProblem {
  /// Variables, the hand's point and the inequalities; other equations are left out.
  ZeroProblem where;
  std::vector<ObjectiveTerm> objective;
  std::vector<ImpulseCase> impulses;
  /// Nominal value and worst case alike: the largest |y| over the impulses.
  RiskMeasure measure = RiskMeasure::Nominal;
  double cvar_level = 0;
  /// Boxes that hold every configuration of interest; empty: all within the limits.
  std::vector<JointBox> places;
  MinimumTolerances tolerances;
};

/// Variables that nothing depends on take their stated values. Of a free attitude of which only the
/// impulse's direction in B counts, rotations across it remain: two variables in place of three.
/// @pre no joint offsets; no time offsets while the time is free
MinimumProblem minimum_problem(const CaptureProblem& problem,
                               const std::vector<Scenario>& scenarios);

/// An impulse and its |y|.
struct WorstImpulse {
  ImpulseCase impulse;
  double value = 0;
};

/// What is asked about values x of the encounter's variables; each may be empty.
struct MinimumCallbacks {
  std::function<double(const Eigen::VectorXd& x)> value = {};  ///< the measure
  /// The impulses of a worst case that are local maxima of |y| at x, the largest first.
  std::function<std::vector<WorstImpulse>(const Eigen::VectorXd& x)> worst_impulses = {};
};

/// Of the measure; suspects are values of the encounter's variables.
/// @param best value of the best configuration known, > 0: nothing above it is examined
/// @pre at most max_minimum_joints() joints, one to three variables, an enclosure of the target's
/// motion that is valid
Bound bound_minimum(const MinimumProblem& problem, double best, const MinimumOptions& options = {},
                    const MinimumCallbacks& at = {});
int max_minimum_joints();

}  // namespace stillbase::proof
