// Seeded numbers that are the same on every machine and for every order of work.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// A stream of random numbers keyed by (seed, stream): splitmix64 seeding of xoshiro256++, with our
/// own uniform and normal transforms (the standard library's distributions differ between
/// implementations).
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);
  std::uint64_t next();
  double uniform();  ///< [0, 1)
  double uniform(double lower, double upper);
  double normal();         ///< mean 0, standard deviation 1 (Box-Muller)
  Vector3d unit_vector();  ///< uniform on the sphere
  int index(int count);    ///< 0 .. count-1

 private:
  std::uint64_t state_[4];
};

/// Point number `index` (from 0) of the low-discrepancy R_d sequence (Roberts) in [0,1)^d, rotated
/// by an offset drawn from `seed`. Fills space evenly for any number of points.
Eigen::VectorXd low_discrepancy_point(int index, int dimension, std::uint64_t seed);

}  // namespace stillbase
