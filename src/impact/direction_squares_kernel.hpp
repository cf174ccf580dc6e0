// The loop of direction_squares.hpp on number type S.
#pragma once

#include <algorithm>

#include "impact/direction_squares.hpp"

namespace stillbase {

template <class S>
void run_direction_squares(const DirectionSquares& in) {
  using std::max;
  constexpr std::ptrdiff_t kLanes = static_cast<std::ptrdiff_t>(sizeof(S) / sizeof(double));
  const auto times = [](const double* column, std::ptrdiff_t stride, const S(&d)[3]) {
    return S(column[0]) * d[0] + S(column[stride]) * d[1] + S(column[2 * stride]) * d[2];
  };
  for (std::ptrdiff_t i = 0; i < in.count; i += kLanes) {
    S d[3];
    for (int k = 0; k < 3; ++k) {
      if constexpr (kLanes == 1) {
        d[k] = in.d[k][i];
      } else {
        d[k] = S::load(in.d[k] + i);
      }
    }
    S p(in.p);
    if (in.speed_of_d != nullptr) p = p * max(times(in.speed_of_d, 1, d), S(0));
    if (in.W != nullptr) {
      S inverse_mass(0);
      for (int k = 0; k < 3; ++k) inverse_mass += d[k] * times(in.W + k, 3, d);
      p = p / inverse_mass;
    }
    S sum(0);
    for (std::ptrdiff_t k = 0; k < in.rows; ++k) {
      const S y = times(in.Y + k, in.rows, d) + S(in.Y[k + 3 * in.rows]);
      sum += y * y;
    }
    sum = sum * p * p;
    if constexpr (kLanes == 1) {
      in.squares[i] = sum;
    } else {
      sum.store(in.squares + i);
    }
  }
}

}  // namespace stillbase
