// Covariance of a contact: the covariance of the target's estimate propagated to the contact time.
//
// Assumptions. The errors of the estimate are Gaussian. Attitude errors are rotation vectors in T
// (true attitude = estimated attitude * exp(error)), errors of mass and principal moments are
// logarithms of factors (true moment = estimated moment * exp(error)), so both stay possible for
// errors of any size; a small one is the relative error. The directions of the principal axes, the
// contact feature and the torque-free motion are exact. Everything is compared at one instant: the
// true contact may be earlier or later than that.
#pragma once

#include <vector>

#include <stillbase/target/target.hpp>

namespace stillbase {

/// Order of the errors of an estimate.
enum EstimateError : int {
  kPositionError = 0,         ///< 3, of the centroid in N, m
  kOrientationError = 3,      ///< 3, rotation vector in T, rad
  kLinearVelocityError = 6,   ///< 3, in N, m/s
  kAngularVelocityError = 9,  ///< 3, in N, rad/s
  kMassError = 12,            ///< 1, logarithm of a factor
  kMomentsError = 13,         ///< 3, logarithms of factors, principal moments in rising order
  kNumEstimateErrors = 16
};
using EstimateVector = Eigen::Matrix<double, kNumEstimateErrors, 1>;
using EstimateCovariance = Eigen::Matrix<double, kNumEstimateErrors, kNumEstimateErrors>;

/// Standard deviations of an estimate whose errors are independent of each other.
struct EstimateDeviations {
  Vector3d position = Vector3d::Zero();          ///< in N, m
  Vector3d orientation = Vector3d::Zero();       ///< about the axes of T, rad
  Vector3d linear_velocity = Vector3d::Zero();   ///< in N, m/s
  Vector3d angular_velocity = Vector3d::Zero();  ///< in N, rad/s
  double mass = 0;                               ///< relative
  Vector3d moments = Vector3d::Zero();  ///< relative, of the principal moments in rising order
};

/// The diagonal covariance with these standard deviations.
EstimateCovariance covariance_of(const EstimateDeviations& deviations);

/// A body and its motion.
struct TargetEstimate {
  TargetBody body;
  TargetState state;
};

/// The estimate with an error put on it. A point mass has no moments to change.
TargetEstimate with_error(const TargetEstimate& estimate, const EstimateVector& error);

/// Order of what is predicted of a contact.
enum ContactQuantity : int {
  kContactPoint = 0,     ///< 3, in N, m
  kContactNormal = 3,    ///< 3, rotation vector from the estimate's normal, perpendicular to it, in
                         ///< N, rad
  kContactVelocity = 6,  ///< 3, of the material point in N, m/s: relative to a hand at rest
  kClosingSpeed = 9,     ///< 1, normal . velocity, m/s
  kEffectiveMass = 10,   ///< 1, logarithm of 1 / (n' W_t n) over the estimate's
  kNumContactQuantities = 11
};
using ContactVector = Eigen::Matrix<double, kNumContactQuantities, 1>;
using ContactCovariance = Eigen::Matrix<double, kNumContactQuantities, kNumContactQuantities>;

/// A contact feature at one instant, as far as it is known.
struct ContactPrediction {
  double time = 0;                       ///< s
  ContactState estimated;                ///< of the estimate itself
  double effective_mass = 0;             ///< 1 / (n' W_t n) of the estimate, kg
  ContactVector value;                   ///< of the estimate (rotation vector and logarithm zero)
  ContactVector mean;                    ///< expectation
  ContactCovariance spread;              ///< second moments about `value`: covariance + bias bias'
  ContactCovariance covariance() const;  ///< about the mean
  /// Standard deviations about the estimate's value.
  Vector3d point_deviation() const;
  double closing_speed_deviation() const;
};

/// What a contact of this body is, relative to a reference: the map that prediction and sampling
/// share.
/// @param reference of the estimate without error, at the same time
ContactVector contact_vector(const TargetBody& body, const ContactFeature& feature,
                             const ContactState& contact, const ContactState& reference,
                             double reference_effective_mass);

/// Carries the covariance of an estimate to a contact feature at several instants by the unscented
/// transform.
///
/// With L L' = covariance of n errors, the 2 n + 1 points 0, +-sqrt(n + kappa) L_i are propagated
/// and weighted by kappa / (n + kappa) and 1 / (2 (n + kappa)); kappa = 3 - n, which matches the
/// fourth moments of a Gaussian along each point's direction. Source: Julier and Uhlmann, "A new
/// extension of the Kalman filter to nonlinear systems", 1997; second moments are taken about the
/// central point, their form for negative kappa, which is positive semidefinite whatever the map.
/// In the scaled form of Wan and van der Merwe, "The unscented Kalman filter for nonlinear
/// estimation", 2000, this is alpha = 1, kappa = 3 - n, beta = 1. Attitude errors are applied by
/// the exponential of SO(3).
/// @param covariance positive semidefinite
/// @throws std::invalid_argument when a target rotates too often to be predicted, or the covariance
///   is not finite or not positive semidefinite
std::vector<ContactPrediction> predict_contact(const TargetEstimate& estimate,
                                               const EstimateCovariance& covariance,
                                               const ContactFeature& feature,
                                               const std::vector<double>& times);

/// Second moments about the estimate's value of the velocity [v; omega] of a contact feature's
/// material point, in N, at several instants: by the same transform.
/// @throws std::invalid_argument as predict_contact()
std::vector<Matrix6d> predict_velocity(const TargetEstimate& estimate,
                                       const EstimateCovariance& covariance,
                                       const ContactFeature& feature,
                                       const std::vector<double>& times);

/// Half-angle about the estimate's normal within which the true normal lies with a probability.
///
/// The normal's rotation vector is taken as a Gaussian of mean zero in the plane perpendicular to
/// the normal, with the principal variances l1 >= l2 of `prediction.spread`:
/// P(angle <= a) = 1/(2 pi) integral over phi of 1 - exp(-a^2 / (2 (l1 cos^2 phi + l2 sin^2 phi))),
/// Rayleigh's distribution for l1 = l2 and a normal one for l2 = 0 (Craig's formula).
/// @param probability in (0, 1)
/// @return rad; may exceed pi, when nothing is known of the direction
double cone_half_angle(const ContactPrediction& prediction, double probability);

/// The same for directions in a plane: half-angle of the wedge that holds the rotation about the
/// plane's normal, a Gaussian of mean zero. @param plane_normal unit, in N
double wedge_half_angle(const ContactPrediction& prediction, const Vector3d& plane_normal,
                        double probability);

}  // namespace stillbase
