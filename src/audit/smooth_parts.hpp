// The measure of a problem near one configuration as the largest of smooth functions.
#pragma once

#include <string>
#include <vector>

#include "audit/checks.hpp"

namespace stillbase::audit {

/// A direction of the cone, by its angle from the axis and its azimuth, rad.
struct ConePlace {
  double angle = 0, azimuth = 0, value = 0;
};

/// |y|^2 of the measure over a constant size: the largest of one function (nominal value,
/// expectation), of one for each worst direction of the cone or worst residual velocity, or of one
/// for each sample at the quantile of a tail.
class SmoothParts {
 public:
  explicit SmoothParts(const verification::Situation& situation);

  /// Why the measure has no such parts there; empty: it has.
  const std::string& objection() const { return objection_; }
  /// The largest ones at the configuration of the constructor, at another configuration.
  Eigen::VectorXd values(const verification::Situation& at) const;
  /// The worst directions of the cone in B, at the configuration of the constructor; none of other
  /// measures.
  std::vector<Vector3d> worst_directions(const verification::Situation& situation) const;

 private:
  Vector3d direction(const verification::Situation& at, const ConePlace& place) const;
  void find_maxima(const verification::Situation& situation);
  void find_velocities(const verification::Situation& situation);
  void find_tail(const verification::Situation& situation);
  Eigen::VectorXd over_velocity(const verification::Situation& at) const;
  Eigen::VectorXd sampled(const verification::Situation& at) const;

  const CaptureProblem& problem_;
  Vector3d n_;
  double size_ = 1;
  std::vector<ConePlace> maxima_;
  std::vector<Vector6d> velocities_;  ///< as local_maxima() has them, in N
  std::string objection_;
  Eigen::VectorXd weights_;  ///< of the samples above the quantile
  std::vector<Eigen::Index> at_quantile_;
  double remaining_ = 0;  ///< weight of those
};

}  // namespace stillbase::audit
