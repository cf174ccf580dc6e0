// The parts of a robot's response to an impulse of which objectives are made.
#pragma once

#include <array>
#include <cstddef>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// A part of the response to a unit impulse. Vectors are in B.
enum class ResponsePart {
  BaseVelocity,             ///< Delta v of the base centroid, m/s (3)
  BaseRate,                 ///< Delta omega, rad/s (3)
  BaseAngularMomentum,      ///< Htilde_omega Delta omega, N m s (3)
  TotalAngularMomentum,     ///< Delta L_g of (16), N m s (3)
  ReceivedLinearMomentum,   ///< P of [P; L] = H_b Delta Omega (1), N s (3)
  ReceivedAngularMomentum,  ///< L of the same, N m s (3)
  JointRates,               ///< Delta phidot, rad/s (n)
  Impulse                   ///< force of the impulse, of a unit impulse along n: n (3)
};
inline constexpr std::size_t kResponseParts = 8;

/// A symmetric matrix G for each part: 1/2 sum over the parts of part' G part. Of JointRates
/// only G(0, 0) counts, for all components.
struct PartMetrics {
  std::array<Matrix3d, kResponseParts> metrics;

  PartMetrics() { metrics.fill(Matrix3d::Zero()); }
  Matrix3d& operator[](ResponsePart part) { return metrics[static_cast<std::size_t>(part)]; }
  /// Adds 1/2 weight |part|^2.
  void add(ResponsePart part, double weight) { (*this)[part].diagonal().array() += weight; }
};

}  // namespace stillbase
