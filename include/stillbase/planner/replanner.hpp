// A solved capture problem kept up to date while the estimate of its target moves.
//
// What is replanned: joints at the contact, base pose there, contact time, and with them the
// predicted impact. What is not: the approach path, which has to be planned again to the new
// contact, and everything that `make_plan` finds out beside the local minimum (other minima,
// collisions that `constraints.clearance` does not keep apart, limits after the impact, proofs).
//
// How: Newton steps of least norm from the old posture onto the constraints of the new encounter,
// then sequential quadratic programming with exact gradients, each of whose steps ends on the
// constraints again. The worst case over a cone is minimised over the directions of its maxima,
// which follow the posture. Every point on the way is feasible, so a deadline costs quality alone.
//
// Assumptions: the impulse follows from the target's motion. The robot waits as the plan says; its
// own navigation error belongs to the estimate, which is stated in N.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/target/estimate.hpp>

namespace stillbase {

struct ReplanOptions {
  int max_steps = 40;          ///< of an update; estimates that differ little take 2 to 10
  double longest_step = 0.3;   ///< rad, m, s: farther the linear model does not hold
  int restoration_steps = 12;  ///< of Newton's method onto the constraints, from the old posture
  int halvings = 10;           ///< of a step that does not lower the measure
  /// KKT residual after which nothing is left to gain: the measure's error is about its square.
  double optimality_tolerance = 1e-8;
  double least_lead = 0;  ///< s between an estimate and the contact, for the approach
  /// rad (m) that each joint may be from the plan's posture, unless only farther ones satisfy the
  /// constraints. What was judged of that one alone, collisions and the time after the impact,
  /// tends to hold near it; a lower measure farther away may be one that the planner had excluded.
  double stay_within = 0.1;
  /// rad by which a target may rotate between estimate and contact. Memory and, in part, the time
  /// of an update grow with it.
  double most_rotation = 60;
};

enum class ReplanStatus {
  Optimal,   ///< feasible, KKT residual of at most 1e-6 (ReplanOptions::stay_within is a bound)
  Feasible,  ///< feasible, not shown to be optimal
  /// No posture near the known ones satisfies the constraints under this estimate; that of the
  /// result violates them least.
  Infeasible,
  Refused  ///< the estimate cannot be used: `reason`; all else is that of the old posture
};
std::string to_string(ReplanStatus status);

/// A posture under an estimate.
struct ReplanJudgement {
  double value = 0;          ///< of the measure, in the objective's unit
  double max_violation = 0;  ///< of the constraints and bounds, in their units
  bool is_feasible() const { return max_violation <= kFeasibilityTolerance; }
};

/// Standard deviations of a predicted contact, about what the estimate says.
struct ContactDeviations {
  double point = 0;          ///< of the contact point, root of the sum over three axes, m
  double half_angle = 0;     ///< about the normal, with probability 0.95, rad
  double closing_speed = 0;  ///< m/s
};

struct ReplanResult {
  ReplanStatus status = ReplanStatus::Refused;
  const char* reason = "";  ///< of Refused
  bool was_cut = false;     ///< the deadline, or a signal, came before the steps had ended

  // The new posture.
  Configuration configuration;
  double value = 0;       ///< of the measure that is minimised, in the objective's unit
  double nominal = 0;     ///< at the nominal direction, in the same unit
  double worst_case = 0;  ///< over the cone; = nominal without a cone
  Vector3d worst_direction = Vector3d::Zero();  ///< unit, in B
  /// All rows of a plan's `constraints`, in its order.
  std::vector<ConstraintValue> constraints;
  double max_violation = kInfinity;
  /// As nlp::Certificate::kkt_residual, by the multipliers of the last quadratic program; infinite:
  /// not known, the posture was not looked at by one.
  double kkt_residual = kInfinity;

  /// The old posture under the new estimate: unless an equation of the hand happens to hold there,
  /// it is not feasible. The new one is never worse than a feasible old one.
  ReplanJudgement old;
  /// The old posture moved onto the constraints, where the descent began.
  ReplanJudgement corrected;

  double cone_half_angle = 0;                ///< that was minimised over, rad
  std::optional<ContactDeviations> contact;  ///< where a covariance is stated and time was left
  int steps = 0;                             ///< of sequential quadratic programming
  double seconds = 0;                        ///< by the wall clock
};

/// Distance from the nearer end of a constraint's range, in its unit; negative: violated.
double margin_of(const ConstraintValue& constraint);

/// Holds one posture and moves it along with the estimate. One thread at a time; no thread of its
/// own. Deadlines apart, equal calls in equal order give equal bytes.
class Replanner {
 public:
  /// Takes over the plan's configuration and refines it; other candidates of the plan are where it
  /// begins when the old posture leads to none.
  /// @throws InputError for problems that it does not cover: those whose impulse does not follow
  ///   from the target's motion, simulated or user-defined objectives and constraints, a residual
  ///   velocity, CVaR; and for a plan without a configuration
  explicit Replanner(const Plan& plan, const ReplanOptions& options = {});
  ~Replanner();
  Replanner(Replanner&&) noexcept;
  Replanner& operator=(Replanner&&) noexcept;

  /// The best posture that is found in time, which becomes the old one of the next call unless it
  /// is infeasible. Allocates nothing on robots of up to 20 joints.
  ///
  /// A covariance decides the cone's half-angle where the problem has it follow from one
  /// (`uncertainty.cone_confidence`; without a covariance it stays), and ReplanResult::contact.
  /// @param stop `deadline` is kept as long as it leaves time for a judgement and the first steps
  ///   onto the constraints (a few hundred microseconds)
  /// @return until the next call
  const ReplanResult& replan(const StateEstimate& estimate, const StopCondition& stop = {});

  /// Of the last call; of the plan before the first.
  const ReplanResult& last() const;
  /// The plan's problem with the last estimate in place of its own.
  const CaptureProblem& problem() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillbase
