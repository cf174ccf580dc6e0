// |y|^2 of many impulse directions at one posture, several side by side in wide registers.
#pragma once

#include <cstddef>

namespace stillbase {

/// y = p Y [d; 1], where p is a number, or goes with the closing speed or against the inverse mass
/// along d. Plain numbers, matrices by columns: kernels for wide registers share no inline
/// functions on doubles with the other files.
struct DirectionSquares {
  static constexpr std::ptrdiff_t kMostLanes = 8;

  std::ptrdiff_t count;      ///< of directions, a multiple of kMostLanes
  const double* d[3];        ///< their coordinates in any frame, `count` each
  std::ptrdiff_t rows;       ///< of Y
  const double* Y;           ///< rows x 4, for directions in that frame
  double p;                  ///< p, or what it is times the following two
  const double* speed_of_d;  ///< 3: times max(speed_of_d' d, 0); null: not
  const double* W;           ///< 3 x 3: over d' W d; null: not
  double* squares;           ///< result, `count`
};

/// On the widest registers of this processor.
void find_direction_squares(const DirectionSquares& directions);

}  // namespace stillbase
