// The search over configurations: many starts, local solves, distinct solutions, ranking.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/phase_clock.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/formulation/measures/robust.hpp>

namespace stillbase {

/// How curves of solutions are followed. Lengths mix rad, m and s as the variables do.
struct CurveOptions {
  double longest_step = 0.05;   ///< a chord of it misses an arc of radius 1 by 3e-4
  double shortest_step = 1e-6;  ///< where shorter ones were needed the curve is not smooth
  int most_points = 4000;       ///< of one direction: 200 rad
  double exact = 1e-12;         ///< largest residual of a point, typical sizes
  int newton_steps = 8;         ///< from the tangent to the curve; they converge quadratically
  double dependent = 1e-9;      ///< pivot of a row that is no more than those before it, relative
  double off_tangent = 0.2;     ///< of a step, what Newton's method may move it sideways
  double turn_cosine = 0.97;    ///< least cosine between neighbouring tangents: 14 deg
  double same_point = 1e-6;     ///< two points of a curve; far more than `exact` leaves open
  double inside = 1e-12;        ///< violation of an inequality that holds with equality
  int halvings = 40;            ///< of the step in which the curve leaves its bounds
  double other_turn = 1;  ///< rad: far more than rounding, less than between two rotation vectors
                          ///< of one rotation
};

/// Which points of curves of solutions are listed.
struct ContinuumOptions {
  double zero = kZeroObjective;  ///< an objective that vanishes, over its typical size
  double flat = 1e-9;     ///< worst cases that are the same, over the objective's typical size
  double arc = 1e-8;      ///< to which a minimum is placed: the value is flat there
  double spacing = 0.09;  ///< of the stated points, at most 0.1 apart; chords exceed the arc a bit
  CurveOptions curve;
};

/// A first judgement of many postures by the measure over a few scenarios.
struct ScreeningOptions {
  int drawn = 256;           ///< postures beside the starts: they count where few are asked for
  double distance = 0.1;     ///< rad between two of them
  int rim_directions = 8;    ///< on the rim of the cone, beside the nominal direction
  std::size_t samples = 32;  ///< of a measure over samples: the first ones
};

/// The local minima of the measure.
struct MeasureSearchOptions {
  /// Rough points that are carried to the end: the best ones, and the best of those that touch
  /// nothing. Where the best ones touch something, those that can be chosen are among the latter.
  int finished = 12, finished_free = 24;
  double worth_finishing = 4;  ///< of the best |y|^2 that touches nothing: none worse is
  double apart = 0.3;  ///< rad, between two of them: nearer ones mostly end at the same minimum
  int flips = 48;      ///< solves in other branches of the best minima, which often differ by a
                       ///< percent only
  double same_basin = 0.02;    ///< rad: places this near lead to the same minimum
  double same_minimum = 1e-3;  ///< rad: finished ones
  double promising = 1.05;     ///< of the best |y|^2: minima whose other branches are tried
  double worth_a_solve = 1.5;  ///< of the best |y|^2: branches that are solved

  int first = 24;  ///< postures that are started from, and solutions where rounds follow: 64 and
                   ///< more postures take twice the time and find no more

  // Rounds of further starts.
  int least_rounds = 8;  ///< what the first starts end at may be a wide valley: with half of these
                         ///< rounds five seeds of twenty miss the deeper one of iiwa_cone, with all
                         ///< of them one
  int most_rounds = 20;  ///< of 40 random problems, with all these numbers, a search takes five
                         ///< times the time of one without rounds on average, and up to 15 times
  double zero = kZeroObjective;  ///< |y|, in typical sizes: nothing is better than that
  int enough = 8;                ///< starts that end at the best minimum end the rounds: five are
                                 ///< sometimes those of a wide valley beside a deeper one
  int fresh = 6;              ///< starts of a round on the constraints, and as many among the zeros
  int self_motion_steps = 4;  ///< random ones of a zero, before it is a start
  int hops = 18;              ///< starts of a round about the best minimum that had none: from
                              ///< there one of ten ends at a better one, of the fresh ones one of
                              ///< fifty; with twelve of them in four rounds one hard problem of
                              ///< forty was missed by seven seeds of twenty
  int rough_evaluations = 120;  ///< of a rough solve: with half of it two hard problems of forty
                                ///< are missed more often, at the same time of the whole search
  double same_value = 1.02;     ///< of |y|^2: ends that are one value; rough solves leave a percent
  double shortest_hop = 0.3, longest_hop = 4;  ///< rad: to the next valley, to anywhere
  int draws_per_hop = 3;                       ///< until one can be projected onto the constraints
  double on_constraints = 1e-3;                ///< violation from which a local solver can go on
};

struct SearchOptions {
  std::string optimizer = "sqp";
  int starts = 64;  ///< of the nominal problem, before any rounds
  /// Whether a worst case, or a mean over the residual velocity, has further rounds of starts,
  /// until its best minimum was reached often.
  bool is_adaptive = false;
  std::uint64_t seed = 1;
  int max_candidates = 32;
  std::vector<Eigen::VectorXd> more_starts;  ///< points to start from as well (N each)
  /// Whether a configuration touches nothing; may be empty. Minima of the measure that touch
  /// nothing are carried to the end beside better ones, and where solutions form a curve, the best
  /// of those that touch nothing are listed as well. Several threads may call it.
  std::function<bool(const Configuration&)> is_free;
  /// Called after every start with (done, total), one call at a time, on any thread that works; may
  /// be empty.
  std::function<void(int, int)> on_progress;
  StopCondition stop;
  int jobs = 1;  ///< threads; 0: one per processor. The result does not depend on it,
                 ///< but for the count of evaluations
  PhaseClock* clock = nullptr;  ///< takes the seconds of each phase; may be null

  std::string rescuer = "ipopt";  ///< goes on where the optimizer stopped short of a minimum:
                                  ///< equations whose gradients nearly depend on each other stop
                                  ///< sequential quadratic programming, an interior point seldom
  double far = 0.25;  ///< m, beyond the clearance: such distances are left out of local solves. A
                      ///< long step may end within such a body; the next one has its row
  int max_evaluations = 1000;  ///< of a local solve, which needs about 40: creeping is cut off,
                               ///< after 120 where worst directions are followed
  int max_simulated_evaluations = 200;  ///< the same of a simulated objective
  int max_rescue_evaluations = 100;     ///< it is close; one costs ten times one of sqp
  int rescued_minima = 2;               ///< the best, where the solver stopped short
  int more_draws = 8;            ///< of a start that the constraints refuse: far less than a solve
  double on_constraints = 1e-3;  ///< violation from which a local solver can go on
  int starts_per_isolated = 16;  ///< Newton steps for isolated points cost less than a solve
  double equal_nominal = 1e-8;   ///< of the objective's typical size: zeros differ by rounding
  int prediction_rounds = 3;     ///< nominal solves from minima of the measure that are better
  double better_prediction = 1e-7;  ///< of the objective's typical size
  int moved_zeros = 6;  ///< nearest to the start posture, that are moved nearer along the surface
                        ///< of zeros; one costs about as much as two local solves
  /// Nominal values, of the objective's typical size above the least, that may be the least once
  /// they are known to their last digits.
  double as_good_before_refinement = 1e-3;
  double same_configuration = 1e-5;  ///< distance of solutions that are one
  ScreeningOptions screening;
  MeasureSearchOptions minima;
  ContinuumOptions continua;
};

/// SearchOptions::starts of a problem.
inline int number_of_starts(const SearchSpec& search) {
  return search.starts == kAutomaticStarts ? SearchOptions{}.starts : search.starts;
}

struct SearchResult {
  PlanStatus status = PlanStatus::Infeasible;
  /// Distinct local minima of the problem's measure and of the nominal value that satisfy all
  /// constraints, ordered by the measure (nominal values that are equal to `equal_nominal`: by
  /// their worst case), equal ones by their distance from the start posture; when there is none,
  /// the single least violated point. Where the zeros of the nominal value form a curve: the local
  /// minima of the worst case along it.
  std::vector<Candidate> candidates;
  std::vector<Certificate> certificates;  ///< one per candidate
  std::vector<WorstCase> worst_cases;     ///< one per candidate
  std::vector<SolutionFamily> families;   ///< curves of zeros of the nominal value
  /// The best by the nominal value alone.
  std::optional<NominalOptimum> nominal_optimum;
  std::vector<Eigen::VectorXd> points;  ///< variables of each candidate
  int starts = 0;                       ///< done
  int distinct_solutions = 0;           ///< before the list was cut
  /// Estimated probability that one more start ends at a solution of the nominal problem that none
  /// has reached: the share of the starts whose solution, or curve of solutions, was reached once
  /// (Good and Turing). Near 1 where more than one direction is open at the solutions.
  ///
  /// Of a measure with rounds of starts: exp(-k), k starts having ended at the best minimum.
  /// With that probability as many starts would all have missed a better one that is as easy to
  /// reach. Zero where the worst case is: there is none.
  double unseen = 1;
  bool had_rounds = false;  ///< of starts, see SearchOptions::is_adaptive
  bool stopped = false;     ///< a limit or an interrupt came before the end
  std::map<std::string, long> solver_calls;
  long evaluations = 0;
};

/// Largest SearchResult::unseen of an optimal plan whose search had rounds: three starts, exp(-3),
/// ended at its minimum.
inline constexpr double kUnseenLevel = 0.05;

/// Optimal: violation at most 1e-9 and KKT residual at most 1e-6; feasible: the first only.
PlanStatus status_of(const Certificate& certificate);

/// Where the objective is simulated and the formulation gives simulations up at the same stop, what
/// is left to do after it takes a few of them: the best solution whose measure is known is
/// returned, or the best by the nominal value, with is_judged false and no certificate.
///
/// @throws std::invalid_argument for an optimizer that is not in the registry
SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options);

}  // namespace stillbase
