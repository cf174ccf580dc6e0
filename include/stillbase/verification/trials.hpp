// Trials of a plan: impact and motion after it, with random errors in direction, speed, masses,
// contact point, contact time, posture, estimate of the target and sensors.
//
// Assumptions. The robot waits in the plan's posture, and the contact takes place. Each trial draws
// direction (uniform in the cone), closing speed, restitution, mass and inertia of the target,
// contact point and time, posture, mass properties of the robot's bodies (each evenly within its
// half range) and sensor errors (normal). A contact at another time has the target's feature at
// that time. Where the problem states the covariance of a predicted target's estimate, the errors
// of the estimate are drawn as well, normal and not cut, and the target moves on from there; a cone
// that follows from this covariance is not drawn beside it. The feature then touches the hand off
// its origin, by the error of its place across the direction. A residual velocity is drawn once:
// a stated covariance is all that the relative velocity is off by, so that velocity is the nominal
// one plus its error, while the errors of the estimate decide place and attitude of the target
// alone; one that is carried from the estimate's covariance is the sum of the estimate's errors and
// the hand's tracking, and both are drawn. Normal as well, not cut. Contacts whose points separate,
// the hand as it moves, have no impulse and are a miss; a latch whose hand moves along holds
// whatever the sign. Towards a hand that waits, a contact that closes in more slowly than the
// problem's closing_speed_min is a miss, too. The impulse follows from the contact law with the
// drawn values, by `reference`. The plant after it is the robot as drawn, while the controller is
// made for the robot of the plan. All numbers are drawn from the stream (seed, trial), so that
// results depend on neither order nor workers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// Half ranges of what is drawn.
struct Perturbations {
  double cone_half_angle = 0;      ///< rad
  double closing_speed = 0;        ///< fraction of the nominal one
  double closing_speed_error = 0;  ///< m/s; where it is stated, in place of the fraction
  double restitution = 0.05;       ///< on e; cut at 0 and 1
  double target_mass = 0.05;       ///< fraction
  double target_inertia = 0.05;    ///< fraction
  double contact_point = 0.01;     ///< m: radius of a disc normal to the direction
  double contact_time = 0;         ///< s; of predicted targets
  double robot_mass = 0.02;        ///< fraction, mass and inertia of each body
  double base_rate_error = 1e-4;   ///< rad/s, standard deviation
  double joint_rate_error = 1e-4;  ///< rad/s (m/s), standard deviation
  JointVectord joint_position;     ///< rad (m), n or empty
  /// Standard deviations of a predicted target's estimate.
  std::optional<EstimateDeviations> estimate;
  /// Of the relative velocity at the contact: its covariance in place of what the errors of the
  /// estimate make of the velocity, or without one the hand's tracking beside them.
  std::optional<ResidualVelocity> residual_velocity;
};

/// Sizes for a problem: those that its `uncertainty` states; where it states none, 5 % of the
/// closing speed, 0.1 s for a predicted target, else the defaults.
Perturbations perturbations_for(const CaptureProblem& problem);

/// Deviations from nominal that one trial drew, and its result.
struct TrialOutcome {
  std::vector<double> inputs;  ///< in the order of trial_input_names()
  bool hit = false;            ///< the contact takes place
  bool finished = false;       ///< the simulation reached the horizon
  bool success = false;  ///< contact, the problem's limits hold after it, no joint stop reached
  double impulse = 0;    ///< N s
  double objective = 0;  ///< of the problem, with what was drawn
  double base_rate_jump = 0;      ///< |Delta omega|, rad/s
  double residual_base_rate = 0;  ///< at the horizon, first controller, rad/s
  double attitude_turned = 0;     ///< rad
  double peak_rate_part = 0;      ///< largest part of a joint's rate limit; 0 without limits
  double peak_torque_part = 0;    ///< the same of a torque limit, as the controller demands
  int stop_hits = 0;
  double peak_grip_part = 0;   ///< largest part of the grip's force or moment limit
  double peak_wheel_part = 0;  ///< largest part of a wheel's capacity
  bool rests = false;          ///< robot and target at the horizon, asked for under detumble
  /// [v; omega] of the target at the hand's origin right before the contact, in B; zero where no
  /// motion is predicted. In no text.
  Vector6d target_velocity = Vector6d::Zero();
};

/// What an outcome fails by: the contact, the simulation, or the first limit that it does not keep;
/// empty: nothing.
std::string trial_failure(const TrialOutcome& outcome, const PostImpactSpec& spec);

std::vector<std::string> trial_input_names();

/// Trials first .. first + count - 1 of the plan, in this order whatever the number of workers.
/// Fewer when stopped: those before the first one that was not done.
/// @param on_progress called after every few trials, which are simulated side by side, with
/// (done, count), by one worker at a time; may be empty
/// @throws InputError, std::invalid_argument for a plan that verify_plan() would not evaluate
std::vector<TrialOutcome> run_trials(const Plan& plan, const Perturbations& sizes,
                                     std::uint64_t seed, int first, int count, int workers,
                                     const StopCondition& stop = {},
                                     const std::function<void(int, int)>& on_progress = {});

/// Distribution of one number over the trials. Percentiles by linear interpolation between order
/// statistics.
struct Spread {
  std::string name, unit;
  double mean = 0;
  double mean_half_width = 0;  ///< of the 95 % confidence interval of the mean, 1.96 s / sqrt(N)
  double p5 = 0, p50 = 0, p95 = 0, p99 = 0;
  double worst = 0;     ///< largest
  int worst_trial = 0;  ///< where
};

/// Dependence of an output on an input: Spearman's rank correlation over the trials.
struct Sensitivity {
  std::string output, input;
  double rank_correlation = 0;
};

struct TrialReport {
  int trials = 0, hits = 0, finished = 0, successes = 0;
  double success_probability = 0;
  double success_lower = 0, success_upper = 1;  ///< Wilson's score interval, 95 %
  /// What trials fail by and how many, the most frequent first; see count_failures().
  std::vector<std::pair<std::string, int>> failures;
  std::vector<Spread> spreads;
  std::vector<Sensitivity> sensitivities;  ///< per output, the strongest first
};

/// @param first number of the first trial
/// @param objective_unit of the problem's objective (objective_unit_name())
TrialReport summarize_trials(const std::vector<TrialOutcome>& outcomes, int first = 0,
                             const std::string& objective_unit = "as the plan");

/// How many outcomes fail by what, the most frequent first.
std::vector<std::pair<std::string, int>> count_failures(const std::vector<TrialOutcome>& outcomes,
                                                        const PostImpactSpec& spec);

/// Wilson's score interval of a probability from `successes` out of `trials`, z standard deviations
/// (1.96: 95 %). [0, 1] without trials.
struct Interval {
  double lower = 0, upper = 1;
};
Interval wilson_interval(int successes, int trials, double z = 1.959963984540054);

}  // namespace stillbase
