// Tolerances that several checks of the search record share.
#pragma once

namespace stillbase::audit {

struct RecordOptions {
  /// Objective of a zero, relative to the terms that it is a sum and difference of, or to its
  /// typical size: ten times the 1e-9 to which candidates keep their equations.
  double zero = 1e-8;
  /// Largest change of objective or measure over configurations that are one, by whole turns or by
  /// the angle of a free joint: relative to the terms that the objective is made of.
  double unchanged = 1e-7;
  /// KKT residual of a minimum with exact derivatives, as plans state it: an optimal plan has no
  /// larger one, and only with it limits that decide are stated.
  double stationary = 1e-6;
  /// Distance from a limit that counts as reached, in the limit's unit. What is further beyond it
  /// is no limit of the plan: shapes of neighbours overlap by construction.
  double reached = 1e-6;
  /// Singular values of the equations by differences, in 1 per rad (m): what is above `restricts`
  /// restricts variables, what is below `restricts_not` does not, and between them neither is
  /// certain.
  double restricts = 1e-4, restricts_not = 1e-7;
  double bound = 1e-9;    ///< relative, of a lower bound: rounding of the measure
  double gap = 1e-12;     ///< of a stated gap, relative to the values that it is a difference of
  int cone_samples = 60;  ///< at most, before the refinement, where many measures are compared
};
inline constexpr RecordOptions kRecord;

}  // namespace stillbase::audit
