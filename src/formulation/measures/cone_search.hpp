// The maxima of |y| over the cone of directions: a scan, then a climb from its peaks.
#pragma once

#include <vector>

#include "formulation/measures/direction_model.hpp"

namespace stillbase {

/// A place in the cone and its |y|.
struct ConePlace {
  Eigen::Vector2d c;
  double value;
};

/// Keeps what a search needs: later ones do not allocate, and find the places of a cone again.
class ConeSearch {
 public:
  /// The maxima over the cone, largest first, until the next call.
  const std::vector<ConePlace>& maxima(const DirectionModel& model);

 private:
  /// Rings about the nominal direction, or a row in the wedge.
  void scan(const DirectionModel& model);
  /// The middle, then spoke by spoke, or along the row.
  Eigen::Vector2d place(std::size_t i) const;
  /// Of the places of a new cone.
  void set_directions();
  /// The places without a neighbour that has a larger value.
  void find_peaks(std::vector<std::size_t>& peaks) const;

  double half_angle_ = 0;
  std::size_t count_ = 1;        ///< of places
  std::size_t rings_ = 0;        ///< places on a spoke; 0: a row
  Eigen::MatrixX3d directions_;  ///< of the places, see DirectionModel::squares()
  std::vector<double> squares_;  ///< |y|^2 of the places, then padding
  std::vector<std::size_t> peak_places_;
  std::vector<ConePlace> peaks_, seeds_, found_;
};

}  // namespace stillbase
