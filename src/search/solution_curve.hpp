// Curves of solutions: where the equations and the zeros of the objective leave one direction open.
//
// Followed by predictor and corrector: a step along the tangent and the bend of the step before,
// then Newton's method within the plane normal to the tangent (Keller's pseudo-arclength
// continuation; Allgower and Georg, Introduction to Numerical Continuation Methods, SIAM 2003).
//
// Assumptions: the curve is smooth and keeps away from points where a second direction opens; a
// trace ends there and is marked as not complete, as where a free base is rotated by pi from its
// stated attitude: beyond it other variables describe the same rotation. Lengths mix rad, m and
// s as the variables do.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/search/search.hpp>

namespace stillbase {

struct CurvePoint {
  Eigen::VectorXd x;        ///< continuous angles are not wrapped
  Eigen::VectorXd tangent;  ///< unit, all in the sense of the points' order
  double arc = 0;           ///< sum of the steps before it
  /// Change of the tangent per arc over the step that led here, normal to it, for the step that
  /// follows; empty at the first, and at all points of an open curve.
  Eigen::VectorXd bend = {};
};

struct SolutionCurve {
  std::vector<CurvePoint> points;  ///< at most CurveOptions::longest_step apart
  bool is_closed = false;          ///< the first point follows the last one
  bool is_complete = false;        ///< closed, or followed to limits at both ends
  double length = 0;               ///< in `arc`, with the step back to the first point when closed
  /// The same of the curve itself; steps along tangents are shorter where it bends.
  double arc_length = 0;
};

/// The curve through x, in both directions, until it closes or reaches a bound or an inequality.
/// @param x solution of the equations with vanishing objective, by in_shortest_turns()
/// @return empty unless exactly one direction is open at x
std::optional<SolutionCurve> trace_curve(const Formulation& formulation, const Eigen::VectorXd& x,
                                         const StopCondition& stop,
                                         const CurveOptions& options = {});

/// Where a solution is on a curve, as a value of `arc`; empty: it is not on it.
std::optional<double> place_on(const Formulation& formulation, const SolutionCurve& curve,
                               const Eigen::VectorXd& x, const CurveOptions& options = {});

/// The solution at a value of `arc` in [0, length].
Eigen::VectorXd point_at(const Formulation& formulation, const SolutionCurve& curve, double arc,
                         const CurveOptions& options = {});

}  // namespace stillbase
