#include <stillbase/target/prediction.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

#include "target/motion_table.hpp"
#include "target/unscented.hpp"

namespace stillbase {

namespace {

/// n' W_t n at a contact feature, 1/kg: the same at all times, for both are fixed in T.
double inverse_effective_mass(const TargetBody& body, const ContactFeature& feature) {
  return target_inverse_mass(body.mass, body.inverse_inertia(), feature.point, feature.normal);
}

/// Shortest rotation vector that maps the unit vector a to b.
Vector3d shortest_rotation(const Vector3d& a, const Vector3d& b) {
  const Vector3d axis = a.cross(b);
  const double sine = axis.norm(), cosine = a.dot(b);
  if (sine > 1e-300) return std::atan2(sine, cosine) / sine * axis;
  return cosine > 0 ? Vector3d(Vector3d::Zero()) : Vector3d(kPi * a.unitOrthogonal());
}

/// L with L L' = covariance.
/// @throws std::invalid_argument when it is not finite or not positive semidefinite
EstimateCovariance square_root(const EstimateCovariance& covariance) {
  // Diagonal covariances, the common case, keep their axes.
  if (covariance.isDiagonal(0)) {
    if (!(covariance.diagonal().minCoeff() >= 0) || !covariance.allFinite()) {
      throw std::invalid_argument("predict_contact: variances must be finite and not negative");
    }
    return covariance.cwiseSqrt();
  }
  if (!covariance.allFinite() || !covariance.isApprox(covariance.transpose(), 1e-9)) {
    throw std::invalid_argument("predict_contact: the covariance must be finite and symmetric");
  }
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  if (eigen.values.minCoeff() < -1e-9 * eigen.values.maxCoeff()) {
    throw std::invalid_argument("predict_contact: the covariance is not positive semidefinite");
  }
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

constexpr int kQuarterSamples = 720;  ///< of a quarter circle

/// cos^2 in the middles of equal parts of a quarter circle.
const std::array<double, kQuarterSamples>& quarter_cosine_squares() {
  static const auto squares = [] {
    std::array<double, kQuarterSamples> out;
    for (int i = 0; i < kQuarterSamples; ++i) {
      const double c = std::cos(kPi / 2 * (i + 0.5) / kQuarterSamples);
      out[static_cast<std::size_t>(i)] = c * c;
    }
    return out;
  }();
  return squares;
}

/// Probability that a Gaussian of two independent variances has a norm of at most a.
double probability_within(double a, double l1, double l2) {
  double sum = 0;  // the integrand has four equal quarters
  for (const double c2 : quarter_cosine_squares()) {
    sum += -std::expm1(-a * a / (2 * (l1 * c2 + l2 * (1 - c2))));
  }
  return sum / kQuarterSamples;
}

/// Argument in (0, upper] at which an increasing function, zero at zero, takes a value: false
/// position, the weight of an end that stays halved (the Illinois method).
template <class F>
double solve_increasing(F f, double value, double upper) {
  double low = 0, high = upper, at_low = -value, at_high = f(upper) - value;
  int kept = 0;  // the end that stayed: -1 low, 1 high
  for (int i = 0; i < 100 && high - low > 1e-15 * high; ++i) {
    double middle = (low * at_high - high * at_low) / (at_high - at_low);
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const double here = f(middle) - value;
    if (here < 0) {
      low = middle;
      at_low = here;
      if (kept == 1) at_high /= 2;
      kept = 1;
    } else {
      high = middle;
      at_high = here;
      if (kept == -1) at_low /= 2;
      kept = -1;
    }
  }
  return high;
}

/// Half-width that holds a Gaussian of mean zero with a probability.
double two_sided_quantile(double variance, double probability) {
  if (!(variance > 0)) return 0;
  const auto within = [](double x) { return std::erf(x / std::sqrt(2.0)); };
  return std::sqrt(variance) * solve_increasing(within, probability, 40);
}

}  // namespace

EstimateCovariance covariance_of(const EstimateDeviations& deviations) {
  EstimateVector sigma;
  sigma << deviations.position, deviations.orientation, deviations.linear_velocity,
      deviations.angular_velocity, deviations.mass, deviations.moments;
  return sigma.cwiseAbs2().asDiagonal();
}

TargetState with_error(const TargetState& estimate, const EstimateVector& error) {
  TargetState state = estimate;
  state.pose.position += error.segment<3>(kPositionError);
  state.pose.orientation =
      (state.pose.orientation * rotation_exp(error.segment<3>(kOrientationError))).normalized();
  state.linear_velocity += error.segment<3>(kLinearVelocityError);
  state.angular_velocity += error.segment<3>(kAngularVelocityError);
  return state;
}

TargetEstimate with_error(const TargetEstimate& estimate, const EstimateVector& error) {
  TargetEstimate changed = estimate;
  changed.state = with_error(estimate.state, error);
  changed.body.mass *= std::exp(error[kMassError]);
  const Vector3d moments = error.segment<3>(kMomentsError);
  if (!changed.body.is_point_mass && !moments.isZero(0)) {
    const SymmetricEigen3 principal = symmetric_eigen3(estimate.body.inertia);
    const Vector3d scaled = principal.values.cwiseProduct(moments.array().exp().matrix());
    changed.body.inertia = principal.vectors * scaled.asDiagonal() * principal.vectors.transpose();
  }
  return changed;
}

ContactCovariance ContactPrediction::covariance() const {
  const ContactVector bias = mean - value;
  return spread - bias * bias.transpose();
}

Vector3d ContactPrediction::point_deviation() const {
  return spread.diagonal().segment<3>(kContactPoint).cwiseSqrt();
}

double ContactPrediction::closing_speed_deviation() const {
  return std::sqrt(spread(kClosingSpeed, kClosingSpeed));
}

ContactVector contact_vector(const TargetBody& body, const ContactFeature& feature,
                             const ContactState& contact, const ContactState& reference,
                             double reference_effective_mass) {
  ContactVector y;
  y.segment<3>(kContactPoint) = contact.point;
  y.segment<3>(kContactNormal) = shortest_rotation(reference.normal, contact.normal);
  y.segment<3>(kContactVelocity) = contact.velocity;
  y[kClosingSpeed] = contact.normal.dot(contact.velocity);
  y[kEffectiveMass] = -std::log(inverse_effective_mass(body, feature) * reference_effective_mass);
  return y;
}

namespace {

/// How far from the estimate its motion is asked for, s.
double horizon_of(const TargetEstimate& estimate, const std::vector<double>& times) {
  double horizon = 1;
  for (const double time : times) {
    horizon = std::max(horizon, std::abs(time - estimate.state.time));
  }
  return horizon;
}

/// Calls visit(body, motion) for each weighted point of the transform but the central one; the
/// weights are equal, 1 / (2 kSpread).
template <class F>
void for_each_point(const TargetEstimate& estimate, const EstimateCovariance& covariance,
                    double horizon, F visit) {
  const EstimateCovariance root = std::sqrt(kSpread) * square_root(covariance);
  for (int k = 0; k < kNumEstimateErrors; ++k) {
    if (root.col(k).isZero(0)) continue;
    for (const double sign : {1.0, -1.0}) {
      const TargetEstimate point = with_error(estimate, sign * root.col(k));
      visit(point.body, TargetMotion(point.body, point.state, horizon));
    }
  }
}

}  // namespace

std::vector<ContactPrediction> predict_contact(const TargetEstimate& estimate,
                                               const EstimateCovariance& covariance,
                                               const ContactFeature& feature,
                                               const std::vector<double>& times) {
  const double horizon = horizon_of(estimate, times);
  const TargetMotion motion(estimate.body, estimate.state, horizon);
  std::vector<ContactPrediction> predictions(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    ContactPrediction& p = predictions[i];
    p.time = times[i];
    p.estimated = motion.contact(feature, times[i]);
    p.effective_mass = 1 / inverse_effective_mass(estimate.body, feature);
    p.value = contact_vector(estimate.body, feature, p.estimated, p.estimated, p.effective_mass);
    p.mean = p.value;
    p.spread.setZero();
  }
  // Differences from the central point: its own weight, negative here, drops out of them.
  for_each_point(estimate, covariance, horizon,
                 [&](const TargetBody& body, const TargetMotion& other) {
                   for (ContactPrediction& p : predictions) {
                     const ContactVector difference =
                         contact_vector(body, feature, other.contact(feature, p.time), p.estimated,
                                        p.effective_mass) -
                         p.value;
                     p.mean += difference / (2 * kSpread);
                     p.spread += difference * difference.transpose() / (2 * kSpread);
                   }
                 });
  return predictions;
}

std::vector<Matrix6d> predict_velocity(const TargetEstimate& estimate,
                                       const EstimateCovariance& covariance,
                                       const ContactFeature& feature,
                                       const std::vector<double>& times) {
  const double horizon = horizon_of(estimate, times);
  const auto velocity = [&feature](const TargetMotion& motion, double time) {
    Vector6d out;
    out << motion.contact(feature, time).velocity, motion.state(time).angular_velocity;
    return out;
  };
  const TargetMotion motion(estimate.body, estimate.state, horizon);
  std::vector<Matrix6d> spreads(times.size(), Matrix6d::Zero());
  for_each_point(estimate, covariance, horizon, [&](const TargetBody&, const TargetMotion& other) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      const Vector6d difference = velocity(other, times[i]) - velocity(motion, times[i]);
      spreads[i] += difference * difference.transpose() / (2 * kSpread);
    }
  });
  return spreads;
}

double cone_half_angle(const ContactPrediction& prediction, double probability) {
  const Vector3d& normal = prediction.estimated.normal;
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  const Eigen::Matrix2d spread = tangents.transpose() *
                                 prediction.spread.block<3, 3>(kContactNormal, kContactNormal) *
                                 tangents;
  const double middle = 0.5 * spread.trace();
  const double half = std::hypot(0.5 * (spread(0, 0) - spread(1, 1)), spread(0, 1));
  const double l1 = middle + half, l2 = std::max(0.0, middle - half);
  if (!(l1 > 0)) return 0;
  // The isotropic Gaussian of the larger variance bounds the angle from above.
  const double upper = std::sqrt(-2 * l1 * std::log1p(-probability));
  const auto within = [&](double a) { return probability_within(a, l1, l2); };
  return solve_increasing(within, probability, upper * (1 + 1e-9));
}

double wedge_half_angle(const ContactPrediction& prediction, const Vector3d& plane_normal,
                        double probability) {
  const double variance = plane_normal.dot(
      prediction.spread.block<3, 3>(kContactNormal, kContactNormal) * plane_normal);
  return two_sided_quantile(variance, probability);
}

}  // namespace stillbase
