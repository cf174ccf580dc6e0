// The maxima of |y| over the cone of directions: a scan, then a climb from the best places.
#pragma once

#include <vector>

#include "formulation/measures/direction_model.hpp"

namespace stillbase {

/// A place in the cone and its |y|.
struct ConePlace {
  Eigen::Vector2d c;
  double value;
};

/// Keeps what a search needs: later ones do not allocate.
class ConeSearch {
 public:
  /// The maxima over the cone, largest first, until the next call.
  const std::vector<ConePlace>& maxima(const DirectionModel& model);

 private:
  /// Rings about the nominal direction, or a row in the wedge.
  void scan(const DirectionModel& model);

  std::vector<Eigen::Vector2d> polar_;  ///< cosine and sine of each ring's angle
  std::vector<Eigen::Vector2d> grid_;
  std::vector<Vector3d> directions_;
  std::vector<double> values_;
  std::vector<ConePlace> seeds_, found_;
};

}  // namespace stillbase
