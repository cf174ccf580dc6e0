// Numbers that tune the approach. Angles are joint angles in rad; a prismatic joint's metre counts
// as one.
#pragma once

#include <array>
#include <limits>

#include <stillbase/core/phase_clock.hpp>

namespace stillbase {

/// Geometric path by OMPL.
struct PathPlannerOptions {
  /// Edge length of the trees: small beside a joint's range, large beside the resolution.
  double tree_range = 0.5;
  /// Iterations of planners that improve a path, after their first solution, within those they
  /// have. Simplification and polish do the remainder.
  int improvement_iterations = 500;
  /// To the best of several goals by itself, before all are gone for: of these a planner reaches
  /// the one that is easiest to reach.
  int iterations_to_best = 500;
  int most_iterations = std::numeric_limits<int>::max();  ///< whatever the problem asks for
  /// Alternations of OMPL's simplification steps, ended when one leaves more than this part of the
  /// path's length.
  int simplification_rounds = 6;
  double worthwhile = 0.99;
};

/// From waypoints to a motion.
struct TimeLawOptions {
  double largest_cut = 0.5;    ///< rad of a straight line given up to round a corner
  double smallest_cut = 1e-3;  ///< rad; below this the robot stops at the corner
  double cut_share = 0.45;  ///< of a line, at most: two corners share it, some of it stays straight
  /// |d1 + d2| of the unit directions before and after a corner. Below this the path turns back,
  /// and a parabola would stand still at its tip.
  double sharpest_corner = 0.05;
  int corner_checks = 8;  ///< chords of a rounded corner that are checked for collisions
  /// On a curve this part of the acceleration limit is for the change of speed, as much as the
  /// direction may use.
  double curve_share = 0.5;
  double grid_per_section = 400;  ///< intervals of the speed profile, by length
  int grid_per_piece = 16;        ///< at least, in a section of fewer than 32 pieces
  int grid_per_short_piece = 4;   ///< at least, in a section of more: a curve with many samples
  /// Parts of the duration over which the speed is averaged: a wide window is smooth, a narrow one
  /// keeps the slow speed of a tight corner to the corner. The fastest result is taken.
  std::array<double, 3> windows{0.15, 0.06, 0.025};
  double samples_per_window = 4;
  double sample_travel = 0.04;  ///< between stored samples
  int min_samples = 48;
  int max_samples = 600;
};

/// Joint torques along a motion.
struct EffortOptions {
  int checks_per_segment = 8;
  /// A path whose torques at the ends and middles of its segments stay below this part of what is
  /// usable is not looked at more closely before it is followed. On segments as short as
  /// TimeLawOptions makes them torques hardly change in between; those of a path that is found are
  /// looked at in any case.
  double surely_usable = 0.5;
  double usable = 0.99;  ///< part of the limits: the torque may be higher between two checks
};

/// Closing the path of a floating base with a stated start, see closure.hpp.
struct ClosureOptions {
  double closed = 1e-10;    ///< m, rad: what is left is rounding
  double converged = 1e-7;  ///< m, rad: the best posture hardly changes any more
  double far = 3;           ///< rad; a larger shift of the final posture needs another path
  double stride = 0.15;  ///< m, rad: largest change of the base pose from one solution to the next
  double difference = 1e-4;  ///< m, rad: step of the difference quotients
  int follow_rounds = 60;    ///< of following the best posture
  int newton_rounds = 12;
};

/// Paths within the angular reaction null space, see reaction_null.hpp.
struct NullSpaceOptions {
  int knots = 8;              ///< of the reference curve, beside the start
  int coarse_steps = 3;       ///< Runge-Kutta steps between two knots, on the way to the goal
  int fine_steps = 40;        ///< of the curve that is kept
  double pull = 4;            ///< kappa, towards the reference
  double limit_margin = 0.1;  ///< rad, distance of the knots from the joint limits
  /// Squares of singular values of the coupling matrix below this part of the largest count as
  /// zero.
  double rank_squared = 1e-12;
  /// Least over largest of these squares from which on their rank is not asked for.
  double well_conditioned = 1e-8;
  double difference = 1e-6;          ///< rad, step of a knot in difference quotients
  double goal_difference = 1e-5;     ///< rad, of the end: goals are exact to about 1e-9
  double measure_difference = 1e-4;  ///< rad, of the end: the objective at a goal is less exact
  int newton_steps = 60;
  double reached = 1e-9;         ///< rad between the end of the curve and the goal
  double nearly_reached = 1e-6;  ///< rad; from here on with fine steps
  double first_damping = 1e-2;   ///< of Newton's steps, beside squares of sensitivities of about 1
  int dampings = 10;             ///< tried in one step
  int dampings_of_update = 2;    ///< the same where Newton's matrix is updated, not computed
  double good_step = 0.3;        ///< of the distance that a step leaves: the matrix is kept
  double largest_shift = 0.7;    ///< rad, of a knot in one step

  int references = 8;          ///< to one goal: the straight line, then ever wider detours
  int references_of_set = 32;  ///< to several goals together
  double detour_width = 0.15;  ///< rad, standard deviation that each detour adds to the last one's
  int detour_waves = 3;        ///< half waves of a detour, the shorter ones smaller
  int clearance_stride = 8;    ///< samples of the curve between two that are checked for collisions
  int enough = 2;              ///< curves clear of bodies, of which the best end is taken
  int improvements = 12;       ///< strides of the end towards a better contact
  double first_stride = 0.2;   ///< rad, of the end in one improvement
  double last_stride = 0.01;   ///< rad
  double same_measure = 1e-9;  ///< in the unit of the objective: less is rounding

  int guides = 2;              ///< paths around obstacles by OMPL, when no such curve is clear
  int guide_effort = 10;       ///< each takes the planner's iterations divided by this
  double guide_spacing = 0.4;  ///< rad between the knots along a guide
  double guide_ends = 0.6;     ///< rad from the goal: the last part is left to Newton's method
  double guide_step = 0.05;    ///< rad of wanted motion per step of the propagator
  int guide_edge_steps = 12;   ///< of one edge of the tree, at most
  double guide_goal_bias = 0.15;
};

/// Polish by Ipopt, see polish.hpp. v is the planned duration over the new one.
struct PolishOptions {
  int intervals = 16;           ///< of the spline, between knots
  int places_per_interval = 2;  ///< where rates and clearances are constrained
  int stored = 4;               ///< samples per interval of the result
  int evaluations = 120;        ///< of Ipopt
  /// Of Ipopt's answer, parts of limits: the motion that comes out is judged by the exact check.
  double feasibility_tolerance = 1e-4;
  /// Steps from the planned motion to Ipopt's answer that are judged: a part of the gain is kept
  /// where the check refuses the whole.
  std::array<double, 5> parts{1, 0.8, 0.6, 0.4, 0.2};
  double worthwhile = 1e-6;      ///< least relative gain
  double slowest = 1 / 1.5;      ///< v of the attitude polish: 1.5 times the planned duration
  double first_speed = 0.6;      ///< v to begin with: well inside all limits, else Ipopt fails
  double fastest = 4;            ///< v
  double room = 1.5;             ///< rad beyond start, end and planned path for control points
  double usable = 0.995;         ///< part of the limits: there may be more between the places
  double extra_clearance = 1.1;  ///< factor: the clearance may be less between the places
  double far_away = 0.2;         ///< m: greater distances are not constrained
  double small_torque = 0.05;    ///< part of a limit; a quarter of the time makes 16 times that
  double difference = 1e-6;      ///< rad, step of joints in difference quotients of the dynamics
  double distance_difference = 1e-5;  ///< rad: distances are less exact than dynamics
};

/// Collisions along the motion as stored.
struct MotionCheckOptions {
  /// Largest motion within an interval that is not split any further, over the resolution (rad, or
  /// m per metre): the clearance is checked eight times as finely as the path was planned.
  double finest = 1.0 / 8;
  /// Resolution (rad, or m per metre) above which `approach.resolution` no longer counts here: the
  /// smallest bodies do not grow with the steps that a path is planned in.
  double coarsest = 0.02;
  /// Factor on the largest of three base velocities of an interval: there may be more in between.
  double velocity_margin = 1.5;
};

/// The run to a contact with a hand that moves, and the stop after it, see arrival.hpp.
struct ArrivalOptions {
  /// Tries in order, parts of the least time that the acceleration limits allow. A longer run
  /// begins further away.
  std::array<double, 5> run_factors{1.02, 1.5, 2.2, 3.3, 5};
  std::array<double, 8> retreats{0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6};  ///< m
  std::array<double, 3> abort_factors{1.02, 1.6, 2.5};                        ///< as run_factors
  double shortest = 0.5;       ///< s: slow hands need no longer
  int samples = 16;            ///< intervals of either
  double rate_slack = 1e-7;    ///< relative: the search leaves rates as far beyond their limits
  double gap_rounding = 1e-7;  ///< m that the hand may be within the target's surface
  double no_closing = 1e-7;    ///< m/s: velocities that match have a rounding
};

struct ApproachOptions {
  int attempts = 8;          ///< at one goal
  int attempts_of_set = 2;   ///< at one of several goals, before it is left out
  int base_hits = 2;         ///< attempts at a goal in which the target touches the base, and would
                             ///< touch the robot if it waited from then on, before it is left out
  int base_hits_of_set = 1;  ///< the same of one of several goals
  double limit_slack = 1e-6;  ///< what optimizers leave outside a joint limit
  int swept_poses = 8;        ///< target poses during a motion with a collision, then avoided
  int swept_effort = 5;       ///< the planner's iterations are divided by this around them
  int longer_wait_every =
      3;                 ///< collisions with the target: then the wait grows by half the motion
  int length_parts = 8;  ///< chords of a segment that measure its length
  int limit_checks = 4;  ///< postures of a segment whose joint limits are checked
  PathPlannerOptions path;
  MotionCheckOptions motion_check;
  TimeLawOptions time_law;
  EffortOptions effort;
  ClosureOptions closure;
  NullSpaceOptions null_space;
  PolishOptions polish;
  ArrivalOptions arrival;
  int jobs = 1;  ///< threads of curves in the reaction null space; the path does not depend on it
  PhaseClock* clock = nullptr;  ///< takes the seconds of each phase; may be null
};

}  // namespace stillbase
