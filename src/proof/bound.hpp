// A lower bound of a global minimum, by branch and bound with Taylor models.
//
//   min over x of max_k f_k(x), subject to g_j(x) = 0 and x in a box
//
// Over a box every f_k and g_j is linear but for a remainder of second order. Multiples of the g_j
// take the slopes out of f_k that the equations forbid to follow. Of several f_k convex
// combinations are taken, at most as large as their maximum. Near a constrained minimum, or a
// minimum of a maximum, the remaining change is of second order too, so that the boxes about it
// need not be small. Any multiples and any combination give a bound; good ones give a good bound.
//
// Horst and Tuy, Global Optimization, 1990; Neumaier, Complete search in continuous global
// optimization, Acta Numerica 13 (2004).
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include <stillbase/core/interrupt.hpp>

#include "proof/enclose.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {

/// f = numerator / denominator, which is positive. Nothing is divided: where f exceeds a value t,
/// numerator - t denominator is positive, and of that a wide box says more.
template <int N>
struct Fraction {
  Form<N> numerator;
  Form<N> denominator = 1.0;
  double least_denominator = 1;  ///< known otherwise, > 0
  bool is_rough = false;         ///< below an f_k, and by much even at the middle of the box
};

template <int N>
class Program {
 public:
  virtual ~Program() = default;
  /// The forms of all g_j and f_k where the variables have the forms x. Both lists come empty.
  virtual void evaluate(const std::array<Form<N>, N>& x, std::vector<Form<N>>& equations,
                        std::vector<Fraction<N>>& values) const = 0;
};

struct BoundOptions {
  /// Points above this do not count: the bound is never larger. Finite.
  double cut = 0;
  /// A bound that is good enough.
  double goal = std::numeric_limits<double>::infinity();
  /// Boxes examined. A count, not a time: the same request gives the same answer anywhere.
  long max_boxes = 20000;
  double min_width = 1e-9;  ///< boxes below it are not divided any more
  StopCondition stop = {};  ///< counts as the limit
  std::function<void(long boxes)> on_progress = {};
  /// Of a problem without equations max_k f_k at a point, or more, in the default rounding mode:
  /// the search ends at the first point that is below the goal.
  std::function<double(const Eigen::VectorXd& x)> value_at = {};
  /// Where the f_k stand for a function F that is larger: adds those that are F at a point and
  /// above `least`. Asked about the middles of the boxes of which least is known, where all f_k are
  /// below the goal there: no box can be divided so often that f_k which are missing do not matter.
  /// @return F at x
  std::function<double(const Eigen::VectorXd& x, double least)> add_values = {};

  // Effort. Every choice is right; these need the fewest boxes on the shipped problems.
  /// A box that has lost this part of its volume is examined once more before it is divided.
  double worthwhile = 0.5;
  int max_rounds = 6;             ///< examinations of one box
  std::size_t max_mixed = 5;      ///< of several f_k, the largest ones that are combined
  int max_mixtures = 4;           ///< rounds of combining
  double dependent_rows = 1e-13;  ///< of the trace, added to the normal matrix of the equations
  double wide_side = 0.25;        ///< sides below this part of the widest one are not divided
  double worth_a_proof = 1e-3;  ///< of the goal: where a point's value is below it, none is sought
  /// Boxes that are divided before the list is sorted. Not the number of threads: the answer
  /// does not depend on them.
  std::size_t at_a_time = 64;
  std::size_t boxes_per_thread = 8;  ///< fewer are not worth a thread
  std::size_t max_suspects = 8;      ///< where the limit was reached
  std::size_t asked_at_a_time = 8;   ///< boxes of `at_a_time` whose middles add_values() sees
  /// Of the distance from goal to cut: an f_k that is less above the others is not worth its work.
  double worth_adding = 0.05;
  int jobs = 0;  ///< threads at most; 0: one per processor
};

struct Bound {
  /// No point of the domain that solves the equations has max_k f_k below this.
  double lower = -std::numeric_limits<double>::infinity();
  bool nothing_below_cut = false;  ///< `lower` is the cut: no point reaches it
  bool limit_reached = false;      ///< before the goal
  long boxes = 0;                  ///< examined
  /// Where a search should start: a point below the goal, or, where the limit was reached,
  /// middles of the boxes of which least is known.
  std::vector<Eigen::VectorXd> suspects;
};

/// In several threads; the answer does not depend on their number. Two or three variables; of
/// a single one the other has an interval without width.
/// @param domain boxes that cover it
/// @pre a RoundUpward stands on the stack
template <int N>
Bound bound_below(const Program<N>& program, const std::vector<Box<N>>& domain,
                  const BoundOptions& options);

}  // namespace stillbase::proof
