#include "target/contact_predictor.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "target/unscented.hpp"

namespace stillbase {

namespace {

/// Rotation between nodes of the transform's points, rad: their differences need half the digits.
constexpr double kCoarse = 0.4;

}  // namespace

ContactPredictor::ContactPredictor(const TargetBody& body, const ContactFeature& feature,
                                   double most_rotation, const EstimateDeviations& body_errors)
    : feature_(feature), most_rotation_(most_rotation) {
  motion_.body = point_.body = body;
  motion_.angle_per_node = point_.angle_per_node = kCoarse;
  motion_.reserve(most_rotation);
  point_.reserve(most_rotation);
  EstimateDeviations errors;
  errors.mass = body_errors.mass;
  errors.moments = body_errors.moments;
  const EstimateCovariance covariance = covariance_of(errors);
  for (int k = kMassError; k < kNumEstimateErrors; ++k) {
    if (!(covariance(k, k) > 0)) continue;
    for (const double sign : {1.0, -1.0}) {
      const EstimateVector error =
          sign * std::sqrt(kSpread * covariance(k, k)) * EstimateVector::Unit(k);
      const TargetBody other = with_error(TargetEstimate{body, {}}, error).body;
      others_.push_back({other.mass, other.inertia});
    }
  }
}

bool ContactPredictor::fits(const MotionTable& table, const TargetState& estimate,
                            double horizon) const {
  return table.largest_rate(estimate) * horizon <= most_rotation_;
}

bool ContactPredictor::predict(const TargetState& estimate, const StateCovariance& covariance,
                               std::vector<ContactPrediction>& out) {
  if (!covariance.allFinite() || !covariance.isApprox(covariance.transpose(), 1e-9)) return false;
  StateCovariance root = covariance;
  if (covariance.isDiagonal(0)) {
    if (!(covariance.diagonal().minCoeff() >= 0)) return false;
    root = covariance.cwiseSqrt();
  } else {
    const Eigen::SelfAdjointEigenSolver<StateCovariance> eigen(covariance);
    const auto& values = eigen.eigenvalues();
    if (values.minCoeff() < -1e-9 * values.maxCoeff()) return false;
    root = eigen.eigenvectors() * values.cwiseMax(0).cwiseSqrt().asDiagonal();
  }
  root *= std::sqrt(kSpread);

  double horizon = 1;
  for (const ContactPrediction& p : out) {
    horizon = std::max(horizon, std::abs(p.time - estimate.time));
  }
  if (!fits(motion_, estimate, horizon)) return false;
  motion_.restart(estimate, horizon);
  const TargetBody& body = motion_.body;
  const double effective_mass =
      1 / target_inverse_mass(body.mass, body.inverse_inertia(), feature_.point, feature_.normal);
  for (ContactPrediction& p : out) {
    p.estimated = motion_.contact(feature_, p.time);
    p.effective_mass = effective_mass;
    p.value = contact_vector(body, feature_, p.estimated, p.estimated, effective_mass);
    p.mean = p.value;
    p.spread.setZero();
  }
  for (int k = 0; k < root.cols(); ++k) {
    if (root.col(k).isZero(0)) continue;
    for (const double sign : {1.0, -1.0}) {
      EstimateVector error = EstimateVector::Zero();
      error.head<12>() = sign * root.col(k);
      if (!add_point(with_error(estimate, error), horizon, out)) return false;
    }
  }
  bool is_possible = true;
  for (const OtherBody& other : others_) {
    point_.body.mass = other.mass;
    point_.body.inertia = other.inertia;
    is_possible = is_possible && add_point(estimate, horizon, out);
  }
  point_.body.mass = body.mass;
  point_.body.inertia = body.inertia;
  return is_possible;
}

/// Adds a weighted point of the transform: the motion of point_'s body from a state.
bool ContactPredictor::add_point(const TargetState& state, double horizon,
                                 std::vector<ContactPrediction>& out) {
  if (!fits(point_, state, horizon)) return false;
  point_.restart(state, horizon);
  for (ContactPrediction& p : out) {
    const ContactVector difference =
        contact_vector(point_.body, feature_, point_.contact(feature_, p.time), p.estimated,
                       p.effective_mass) -
        p.value;
    p.mean += difference / (2 * kSpread);
    p.spread += difference * difference.transpose() / (2 * kSpread);
  }
  return true;
}

}  // namespace stillbase
