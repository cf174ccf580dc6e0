#include <stillbase/encounter/direction_cone.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/plan/feature.hpp>

namespace stillbase {

double rotation_bound(const TargetEstimate& estimate, const EstimateDeviations& deviations,
                      double duration) {
  const TargetBody& body = estimate.body;
  if (body.is_point_mass) return 0;
  const Vector3d moments = principal_moments(body.inertia);
  // The energy keeps |omega|^2 <= I_max / I_min |omega_0|^2; the unscented points are sqrt(3) off.
  const double moment_ratio = moments[2] / moments[0] * std::exp(4 * deviations.moments.maxCoeff());
  return duration * std::sqrt(moment_ratio) *
         (estimate.state.angular_velocity.norm() + 2 * deviations.angular_velocity.maxCoeff());
}

namespace {

/// The contact feature of a problem at instants spread evenly over the window of contact times,
/// ends included (one when the time is fixed), with the uncertainty of the estimate carried there.
std::vector<ContactPrediction> predict_contacts(const CaptureProblem& problem) {
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  std::vector<double> times{lower};
  for (int i = 1; i <= kConeIntervals && upper > lower; ++i) {
    times.push_back(i == kConeIntervals ? upper : lower + (upper - lower) * i / kConeIntervals);
  }
  const double start = problem.target_state.time;
  const double duration = std::max(std::abs(lower - start), std::abs(upper - start));
  const TargetEstimate estimate{*problem.target, problem.target_state};
  if (!(rotation_bound(estimate, *problem.target_deviations, duration) <= kMaxPredictedRotation)) {
    throw std::invalid_argument(
        "the target may rotate by more than 300 rad from its estimate to the contact; its "
        "direction "
        "cannot be predicted");
  }
  return predict_contact(estimate, covariance_of(*problem.target_deviations),
                         chosen_feature(problem), times);
}

/// Part of a three-dimensional Gaussian of mean zero within a radius.
///
/// x = s(u) chi_3 along a direction u spread evenly over the sphere, s(u)^2 = sum_i variance_i
/// u_i^2: the mean over u of P(chi_3 <= radius / s(u)), by midpoints over an octant. With one
/// variance alone, the worst case, 0.95 is right to 1e-4.
double part_within(double radius, const Vector3d& variances) {
  constexpr int kHeights = 64, kAzimuths = 16;
  double sum = 0;
  for (int i = 0; i < kHeights; ++i) {
    const double z = (i + 0.5) / kHeights;
    for (int k = 0; k < kAzimuths; ++k) {
      const double cosine = std::cos((k + 0.5) / kAzimuths * kPi / 2);
      const double c2 = cosine * cosine, across = 1 - z * z;
      const double s2 = variances.dot(Vector3d(across * c2, across * (1 - c2), z * z));
      const double a = s2 > 0 ? radius / std::sqrt(s2) : kInfinity;
      sum +=
          a < 40 ? std::erf(a / std::sqrt(2.0)) - std::sqrt(2 / kPi) * a * std::exp(-a * a / 2) : 1;
    }
  }
  return sum / (kHeights * kAzimuths);
}

double radius_of(const ContactPrediction& contact, double probability) {
  const SymmetricEigen3 eigen =
      symmetric_eigen3(contact.spread.block<3, 3>(kContactPoint, kContactPoint));
  const Vector3d variances = eigen.values.cwiseMax(0);
  if (!(variances.maxCoeff() > 0)) return 0;
  double low = 0, high = std::sqrt(variances.maxCoeff());
  while (part_within(high, variances) < probability && high < kInfinity) high *= 2;
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    (part_within(middle, variances) < probability ? low : high) = middle;
  }
  return high;
}

}  // namespace

double contact_radius(const CaptureProblem& problem, double probability) {
  double largest = 0;
  for (const ContactPrediction& contact : predict_contacts(problem)) {
    largest = std::max(largest, radius_of(contact, probability));
  }
  return largest;
}

DirectionCone direction_cone(const CaptureProblem& problem, double probability) {
  const auto& plane = problem.uncertainty.cone_plane_normal;
  DirectionCone cone;
  bool is_first = true;
  for (const ContactPrediction& prediction : predict_contacts(problem)) {
    const double half_angle =
        plane ? wedge_half_angle(prediction, problem.base.orientation * *plane, probability)
              : cone_half_angle(prediction, probability);
    if (!is_first && half_angle <= cone.half_angle) continue;
    cone = {half_angle, prediction};
    is_first = false;
  }
  return cone;
}

std::string to_string(const NarrowCone& cone) {
  const double degrees = 180 / kPi;
  const std::string stated =
      cone.stated > 0 ? fmt::format(
                            "the {} of {:.4g} deg is narrower than what the covariance of the "
                            "target's estimate gives",
                            cone.is_wedge ? "wedge" : "cone", cone.stated * degrees)
                      : "none is stated, and the direction counts as exactly known";
  const char* const advice =
      cone.implied <= kPi / 2
          ? "state 'from_covariance', a half-angle of that size, or residual_velocity"
          : "no cone holds it; a later or better estimate is needed";
  return fmt::format(
      "{}: by target.state.covariance the normal is known within {:.4g} deg with probability {:g}; "
      "{}",
      stated, cone.implied * degrees, cone.probability, advice);
}

std::optional<NarrowCone> narrow_cone(const CaptureProblem& problem) {
  constexpr double kEqual = 1e-6;
  const UncertaintySpec& uncertainty = problem.uncertainty;
  if (!problem.target || !problem.target_deviations || problem.impulse.direction ||
      problem.variables.feature.empty() || problem.impulse.source == ImpulseSource::Given ||
      problem.impulse.contact != ContactLaw::Frictionless || uncertainty.residual_velocity ||
      uncertainty.cone_confidence) {
    return std::nullopt;
  }
  NarrowCone out{uncertainty.cone_half_angle, kPi, kDefaultConeConfidence,
                 uncertainty.cone_plane_normal.has_value()};
  try {
    out.implied = std::min(direction_cone(problem, kDefaultConeConfidence).half_angle, kPi);
  } catch (const std::invalid_argument&) {  // it cannot be predicted
  }
  if (out.stated >= out.implied * (1 - kEqual)) return std::nullopt;
  return out;
}

}  // namespace stillbase
