// All zeros of a small system in a box, by branch and bound with intervals.
//
// Moore, Interval Analysis, 1966; Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for
// Systems of Equations, 1990, chapter 5.
#pragma once

#include <array>
#include <vector>

#include <stillbase/core/interrupt.hpp>

#include "proof/dual.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {

/// f: R^N -> R^N as an enclosure of its values and derivatives over boxes.
template <int N>
class System {
 public:
  virtual ~System() = default;
  /// Values and derivatives over a box; values alone of variables without derivatives.
  virtual void evaluate(const std::array<Dual, N>& x, std::array<Dual, N>& f) const = 0;
  /// Quadratic forms of the values over the box of the variables x; no: there are none.
  virtual bool evaluate(const std::array<Quadratic<N>, N>&, std::array<Quadratic<N>, N>&) const {
    return false;
  }
  /// By how much each f_i may miss zero at a point that counts as a solution, >= 0: what a solver
  /// leaves of its equations.
  virtual std::array<double, N> tolerance() const { return {}; }
  /// Whether no point of a box is of interest, zero or not.
  virtual bool excludes(const Box<N>&) const { return false; }
};

struct EncloseOptions {
  /// Boxes examined before the remaining ones are called undecided. A count, not a time: the same
  /// request gives the same answer anywhere.
  long max_boxes = 100000;
  /// Boxes below this width are not divided any more. Zeros closer to each other than about ten
  /// times this are not told apart, and neither is a double zero.
  double min_width = 1e-8;
  /// Boxes below this width in whose middle f is within its tolerance are not divided any more:
  /// the tolerance leaves a double zero an extent of about 1e-4.
  double tangent_width = 1e-5;
  StopCondition stop = {};  ///< counts as the limit

  // Effort. Every choice is right; these need the fewest boxes on the shipped problems.
  /// A box is cut further while a round leaves at most this part of its widest side.
  double worthwhile = 0.7;
  int max_rounds = 8;
  int sweeps = 3;  ///< cuts of one box by the second-order forms, at most
  /// Rows whose slopes change by more than this part of themselves are not tested by Krawczyk's
  /// operator, which takes slopes that change by less than themselves.
  double nearly_linear = 0.5;
  double inflated_width = 0.5;    ///< boxes wider than this are not tried enlarged
  double inflated_by = 0.25;      ///< of the widest side, on either side
  double inflated_least = 1e-14;  ///< the same of a box without width
  int inflations = 4;             ///< of a box about a point within the tolerance
  int tightening_rounds = 60;     ///< of Krawczyk's operator on the box of one zero
  /// The rounds end where one leaves more than the first part of the width of a box below
  /// `tight_width`, or of any box more than the second part.
  double tightening_slow = 0.5, tightening_stalled = 0.99, tight_width = 1e-9;
  double steepest = 1e200;  ///< unbounded slopes count as this
  double split = 0.4857;    ///< where sides are divided: off the middle, zeros sit at round numbers
  /// Zeros this far outside of the domain are undecided: a solver solves its equations to a
  /// tolerance, and just inside a limit takes a zero just outside for one inside.
  double edge = 1e-7;
  /// More undecided boxes than this are not joined to clusters: they say nothing anyway.
  std::size_t max_joined = 2000;
};

template <int N>
struct Zero {
  Box<N> unique;  ///< contains exactly one zero
  Box<N> tight;   ///< contains that zero
  Box<N> reach;   ///< contains every point of `unique` at which f is within its tolerance
};

template <int N>
struct Enclosure {
  std::vector<Zero<N>> zeros;
  /// Boxes that may contain zeros, or none; neighbours joined.
  std::vector<Box<N>> undecided;
  long boxes = 0;
  bool limit_reached = false;
  /// Every zero in the domain is in exactly one of `zeros`.
  bool complete() const { return undecided.empty(); }
};

/// Every point of the domain at which f is within its tolerance, and that the system does not
/// exclude, lies in one of the zeros' boxes `reach` or in an undecided box. (Excluded ones may be
/// among them.) A zero is told apart from others when f + e has exactly one in its box for every e
/// within the tolerance; nearly double zeros are undecided.
///
/// Where there are second-order forms of f a box is first cut to where they, and their combinations
/// that are about c_i + eps_i, may be zero; the remainder is then of third order in its width.
/// A box without a zero of some f_i (natural or mean-value extension) is dropped; others are cut by
/// the componentwise Newton operator and by Krawczyk's
///   K(X) = c - Y f(c) + (E - Y J(X)) (X - c),  Y near J(c)^-1,
/// dropped when K and X are disjoint, proven to hold exactly one zero when K lies inside X, and
/// divided otherwise. So that zeros on an edge are found as well, X is tried enlarged by a quarter.
/// @param periodic variables that are angles within one turn: points 2 pi apart are one
/// @pre a RoundUpward stands on the stack
template <int N>
Enclosure<N> enclose_zeros(const System<N>& system, const Box<N>& domain,
                           const std::array<bool, N>& periodic, const EncloseOptions& options = {});

}  // namespace stillbase::proof
