// Numbers that tune the approach. Angles are joint angles in rad; a prismatic joint's metre counts
// as one.
#pragma once

#include <array>

namespace stillbase {

/// Geometric path by OMPL.
struct PathPlannerOptions {
  /// Edge length of the trees: small beside a joint's range, large beside the resolution.
  double tree_range = 0.5;
  /// Iterations of planners that improve a path, after their first solution. Simplification and
  /// polish do the remainder.
  int improvement_iterations = 500;
  /// Alternations of OMPL's simplification steps, ended when a path gets no shorter.
  int simplification_rounds = 6;
};

/// From way points to a motion.
struct TimeLawOptions {
  double largest_cut = 0.5;    ///< length of a straight line given up to round a corner
  double smallest_cut = 1e-3;  ///< below this the robot stops at the corner
  int corner_checks = 8;       ///< chords of a rounded corner that are checked for collisions
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
  double usable = 0.99;  ///< part of the limits: the torque may rise a little between two checks
};

/// Closing the path of a floating base with a stated start, see closure.hpp.
struct ClosureOptions {
  double closed = 1e-10;    ///< m, rad: what is left is rounding
  double converged = 1e-7;  ///< m, rad: the best posture hardly changes any more
  double far = 3;           ///< a posture this far off needs another path
  double stride = 0.15;  ///< m, rad: largest change of the base pose from one solution to the next
  double difference = 1e-4;  ///< m, rad: step of the difference quotients
  int follow_rounds = 60;    ///< of following the best posture
  int newton_rounds = 12;
};

/// Paths within the angular reaction null space.
struct NullSpaceOptions {
  int knots = 8;              ///< of the reference curve, beside the start
  int coarse_steps = 6;       ///< Runge-Kutta steps between two knots, for Newton's matrix
  int fine_steps = 40;        ///< of the curve that is kept
  double pull = 4;            ///< kappa, towards the reference
  double limit_margin = 0.1;  ///< distance of the knots from the joint limits
  int newton_steps = 60;
  double first_damping = 1e-2;  ///< of Newton's steps, beside squares of sensitivities of about 1
  int dampings = 10;            ///< tried in one step
  double largest_shift = 0.7;   ///< of a knot in one step

  int references = 8;          ///< to one goal: the straight line, then ever wider detours
  int references_of_set = 32;  ///< to several goals together
  int enough = 2;         ///< curves clear of bodies, of which the one with the best end is taken
  int improvements = 12;  ///< strides of the end towards a better contact
  double first_stride = 0.2;  ///< of the end in one improvement
  double last_stride = 0.01;

  int guides = 2;              ///< paths around obstacles by OMPL, when no such curve is clear
  int guide_effort = 10;       ///< each takes the planner's iterations divided by this
  double guide_spacing = 0.4;  ///< between the knots along a guide
  double guide_ends = 0.6;     ///< from the goal: the last part is left to Newton's method
  double guide_step = 0.05;    ///< of wanted motion per step of the propagator
  int guide_edge_steps = 12;   ///< of one edge of the tree, at most
  double guide_goal_bias = 0.15;
};

/// Polish by Ipopt, see polish_problem.hpp. v is the planned duration over the new one.
struct PolishOptions {
  int intervals = 16;            ///< of the spline, between knots
  int places_per_interval = 2;   ///< where rates and clearances are constrained
  int evaluations = 120;         ///< of Ipopt
  double worthwhile = 1e-6;      ///< least relative gain
  double slowest = 1 / 1.5;      ///< v of the attitude polish: half as long again
  double first_speed = 0.6;      ///< v to begin with: well inside all limits, else Ipopt fails
  double fastest = 4;            ///< v
  double room = 1.5;             ///< beyond start, end and planned path for control points
  double usable = 0.995;         ///< part of the limits: there may be more between the places
  double extra_clearance = 1.1;  ///< factor: the clearance may be less between the places
  double far_away = 0.2;         ///< m: greater distances are not constrained
  double small_torque = 0.05;    ///< part of a limit; a quarter of the time makes 16 times that
};

struct ApproachOptions {
  int attempts = 8;           ///< at one goal
  int attempts_of_set = 2;    ///< at one of several goals, before it is left out
  double limit_slack = 1e-6;  ///< what optimizers leave outside a joint limit
  int swept_poses = 8;        ///< target poses during a motion with a collision, then avoided
  int swept_effort = 5;       ///< the planner's iterations are divided by this around them
  PathPlannerOptions path;
  TimeLawOptions time_law;
  EffortOptions effort;
  ClosureOptions closure;
  NullSpaceOptions null_space;
  PolishOptions polish;
};

}  // namespace stillbase
