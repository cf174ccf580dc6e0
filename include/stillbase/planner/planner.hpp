// From a capture problem to a plan: search, collision judgement, approach.
#pragma once

#include <functional>
#include <string>

#include <stillbase/approach/options.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/phase_clock.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/plan/prover.hpp>

namespace stillbase {

/// Walks along the self-motion at the contact.
struct SelfMotionOptions {
  double stride = 0.4;        ///< rad of one step
  int max_steps = 6;          ///< of a walk; each walk draws its number
  int halvings = 2;           ///< of a step that leaves the constraints or exceeds the factor
  int projection_steps = 20;  ///< of Newton's method onto the constraints
  double separation = 0.2;    ///< rad: samples nearer to each other are one
};

/// Contacts solved for the end of a path.
struct ContactRefinementOptions {
  int projection_steps = 40;  ///< of Newton's method onto the constraints
  int evaluations = 400;      ///< of the optimizer: its start is close
};

/// Which candidate lies in which enclosed solution, and whether a solution keeps the limits.
struct EnclosureOptions {
  double near = 1e-6;       ///< rad, m: a candidate is solved to 1e-9 of its constraints
  double near_time = 1e-5;  ///< s: targets are slow
  double margin = 1e-7;     ///< of a limit, in its unit: nearer values are undecided
};

/// Directions of the cone over which a worst case is bounded from below: fewer make the bound less
/// sharp, never wrong.
struct BoundOptions {
  int wedge_directions = 6;  ///< on each side of a wedge's middle
  int spokes = 12;           ///< on the rim of a cone; every other one has a direction half-way
  /// Directions at which the cone's maxima of the best candidates are: there the bound has to be
  /// sharp.
  int candidates = 6;
  double nearly_best = 1.02;     ///< of the least measure: their candidates count
  double nearly_active = 0.95;   ///< of a candidate's worst case: its maxima count
  double inside = 1e-10;         ///< rad towards the axis: rounding leaves no direction outside
  double same_direction = 1e-6;  ///< rad
  double parallel = 1e-12;       ///< sine of the angle of two axes that are one
};

struct PlannerOptions {
  StopCondition stop;
  /// Threads of the search, the judgements and the bound; 0: one per processor. The plan does not
  /// depend on it. With functions of the user one: they need not stand several calls at once.
  int jobs = 0;
  /// Takes the seconds of each phase; null: a clock of the plan's own. Plan::timing has them too.
  PhaseClock* clock = nullptr;
  /// Called as work goes on with (what is being done, done, total), one call at a time, on any
  /// thread that works; may be empty.
  std::function<void(const std::string&, int, int)> on_progress;
  /// Proves what the search found; null: plans say that nothing was proven.
  const Prover* prover = default_prover();
  double neighbour_distance = 0.3;  ///< rad: candidates nearer than that mostly fail together
  double improvement = 1e-6;        ///< relative: smaller differences of the measure do not count
  /// Searches beside the first one, while no candidate keeps the limits after the impact.
  int further_searches = 4;
  int further_candidates = 4;   ///< of such a search: the list of each is that much longer
  double further_margin = 0.1;  ///< rad or m from the joints' stops: what a joint that is slowed
                                ///< down moves on
  /// Of the rate limits, in the second search that has them as constraints: right after the impact
  /// every candidate of the first one may be at a limit, which rates then exceed as the arm moves.
  double further_rate_reserve = 0.05;
  int bound_rounds = 8;  ///< of bound and repeated search, at most
  /// Of one candidate, where the first way to hold it fails: whole turns away, by the shortest way
  /// from the start posture, and rolls of a free last joint, evenly over its range.
  std::size_t other_turns = 4, other_rolls = 6;
  ApproachOptions approach;
  SelfMotionOptions self_motion;
  ContactRefinementOptions contact_refinement;
  EnclosureOptions enclosure;
  BoundOptions bound;
};

/// Plans a capture.
///
/// Candidates are ordered by the problem's measure; nominal values that are equal to 1e-8 of the
/// objective's typical size by their worst case over the direction cone. A candidate is free of
/// collision when nothing touches but the hand and the contact feature, at the contact and while
/// the target comes in during the wait. Goals of the approach, in this order:
/// 1. all good candidates (`approach.goal_factor`) that are free of collision and keep the
///    problem's post-impact limits under its first controller, at once, but the best of them by
///    itself as long as that takes little;
/// 2. those together with samples of their self-motion at the contact (`approach.goal_samples`).
///    A sample that is reached is certified and becomes the last candidate, reached by no start;
/// 3. the good candidates one by one;
/// 4. whole turns of their joints away and other rolls of a free last joint, at once (one by one
///    for a floating base with a stated start), but for those of a candidate on whose paths the
///    target touched a floating base;
/// 5. the other candidates one by one: those that keep the limits, then those that do not (`verify`
///    says which limit fails);
/// 6. the turns and rolls that 4 has left out;
/// 7. none: the best candidate stands with the reason of its failure.
/// Of postures that are whole turns apart each candidate is the one nearest to the start, without
/// an approach the one in the middle of the joints' limits. Of a candidate that touches something
/// or breaks a limit after the impact the other rolls and turns are judged as well, and the first
/// one that does not takes its place. A floating base with a stated start has its candidates tried
/// one by one. Without an approach asked for, its status is GoalInvalid when no candidate is free
/// of collision.
/// @return a plan in every case: `status` and `approach.status` say what holds. Status Limit:
///   `options.stop` came before the search had ended, a path was found and the time after the
///   impact was judged. What no configuration keeps then is for post_impact_failure().
/// @throws InputError for a problem whose parts do not fit together
Plan make_plan(const CaptureProblem& problem, const PlannerOptions& options = {});

}  // namespace stillbase
