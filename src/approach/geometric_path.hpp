// The shape of a path without its timing: cubic pieces.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/approach/options.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Whether the straight line between two postures is free.
using IsClear = std::function<bool(const JointVectord&, const JointVectord&)>;

/// gamma(sigma) = a + b sigma + c sigma^2 + d sigma^3 for sigma in [0, length]. A joint whose
/// coefficients b, c, d are zero keeps its value to the last bit.
struct Piece {
  JointVectord a, b, c, d;
  double length = 0;
  bool is_curved = false;

  JointVectord at(double sigma) const { return a + sigma * (b + sigma * (c + sigma * d)); }
  JointVectord slope(double sigma) const { return b + sigma * (2 * c + 3 * sigma * d); }
  JointVectord curvature(double sigma) const { return 2 * c + 6 * sigma * d; }
};

/// Pieces that are passed without stopping, and the postures at the ends.
struct Section {
  std::vector<Piece> pieces;
  JointVectord begin, end;
};

/// Straight lines between the waypoints, corners replaced by parabolas as large as `is_clear`
/// allows; a new section begins at a corner that cannot be rounded. |gamma'| is 1 on lines and at
/// the ends of parabolas.
std::vector<Section> round_corners(const std::vector<JointVectord>& points, const IsClear& is_clear,
                                   const TimeLawOptions& options = {});

/// A curve over its length (rad) instead of another parameter, slopes of norm 1; samples at which
/// it stands still are left out.
JointPath over_length(const JointPath& curve);

/// A smooth curve as one section: `times` are values of sigma, `phidot` the slopes there.
Section smooth_section(const JointPath& curve);

}  // namespace stillbase
