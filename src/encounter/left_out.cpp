#include <stillbase/encounter/left_out.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/residual_velocity.hpp>

namespace stillbase {

namespace {

/// Whether the contact follows from an estimate of the target that states its errors.
bool has_estimate(const CaptureProblem& problem) {
  return problem.target && problem.target_deviations && !problem.impulse.direction &&
         !problem.variables.feature.empty() && problem.impulse.source != ImpulseSource::Given;
}

void add_unused_covariance(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  if (!has_estimate(problem) || problem.impulse.contact == ContactLaw::Frictionless ||
      problem.uncertainty.residual_velocity) {
    return;
  }
  out.push_back(
      {kUnusedCovarianceRule, "target", "state.covariance",
       "the impulse of this contact follows from the whole relative velocity, which counts as "
       "exactly known; the covariance is drawn by trials alone; state "
       "uncertainty.residual_velocity: from_covariance"});
}

/// The least ratio of standard deviations over all directions of a velocity; infinite where the
/// second covariance is zero. Directions that neither of them knows are left out.
double least_ratio(const Matrix6d& stated, const Matrix6d& implied) {
  constexpr double kNoVariance = 1e-12;  // of the sum, in units in which its diagonal is one
  const Matrix6d sum = stated + implied;
  Vector6d unit = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) unit[i] = sum(i, i) > 0 ? 1 / std::sqrt(sum(i, i)) : 0;
  const SymmetricEigen eigen = symmetric_eigen(unit.asDiagonal() * sum * unit.asDiagonal());
  Eigen::MatrixXd directions(6, 0);  // in which the sum is one
  for (int i = 0; i < 6; ++i) {
    if (!(eigen.values[i] > kNoVariance)) continue;
    directions.conservativeResize(6, directions.cols() + 1);
    directions.rightCols<1>() =
        unit.cwiseProduct(Vector6d(eigen.vectors.col(i))) / std::sqrt(eigen.values[i]);
  }
  if (directions.cols() == 0) return kInfinity;
  const Eigen::MatrixXd parts = directions.transpose() * stated * directions;
  const double part = std::clamp(symmetric_eigenvalues(parts).minCoeff(), 0.0, 1.0);
  return part < 1 ? std::sqrt(part / (1 - part)) : kInfinity;
}

void add_narrow_residual(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  constexpr double kEqual = 1e-6;
  constexpr int kIntervals = 8;
  const auto& residual = problem.uncertainty.residual_velocity;
  const bool is_known = problem.target && problem.target_deviations &&
                        !problem.variables.feature.empty() &&
                        problem.impulse.source != ImpulseSource::Given;
  if (!residual || !residual->covariance || !is_known) return;
  double least = kInfinity, when = 0;
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  for (int i = 0; i <= (upper > lower ? kIntervals : 0); ++i) {
    CaptureProblem at = problem;
    const double time = lower + (upper - lower) * i / kIntervals;
    at.variables.contact_time_lower = at.variables.contact_time_upper = time;
    const Matrix6d stated = ResidualRoot(at).covariance(time);
    at.uncertainty.residual_velocity = ResidualVelocity{};
    double ratio = 0;
    try {
      ratio = least_ratio(stated, ResidualRoot(at).covariance(time));
    } catch (const std::invalid_argument&) {  // it cannot be predicted
    }
    if (ratio >= least) continue;
    least = ratio;
    when = time;
  }
  if (least >= 1 - kEqual) return;
  out.push_back(
      {kNarrowResidualRule, "uncertainty", "residual_velocity",
       fmt::format("in some direction its standard deviation is {:.3g} of what "
                   "target.state.covariance gives at {:.6g} s; state 'from_covariance', or a "
                   "matrix that is smaller in no direction",
                   least, when)});
}

/// Angle within which the normal is known; pi where it cannot be predicted.
double known_angle(const CaptureProblem& problem) {
  try {
    return std::min(direction_cone(problem, kDefaultConeConfidence).half_angle, kPi);
  } catch (const std::invalid_argument&) {
    return kPi;
  }
}

/// The same of the contact point, m.
double known_radius(const CaptureProblem& problem) {
  try {
    return contact_radius(problem, kDefaultConeConfidence);
  } catch (const std::invalid_argument&) {
    return kInfinity;
  }
}

/// The impulse of a contact along the normal has one direction in every measure over the velocity.
void add_fixed_normal(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  if (!has_estimate(problem) || problem.impulse.contact != ContactLaw::Frictionless ||
      !problem.uncertainty.residual_velocity) {
    return;
  }
  const double angle = known_angle(problem);
  if (angle <= kKnownNormal) return;
  const char* const advice = angle <= kPi / 2
                                 ? "state uncertainty.cone_half_angle: from_covariance, and leave "
                                   "residual_velocity out, for measures over the direction"
                                 : "no cone holds it; a later or better estimate is needed";
  out.push_back(
      {kFixedNormalRule, "uncertainty", "residual_velocity",
       fmt::format("the impulse counts as exactly along the nominal normal, but by "
                   "target.state.covariance the normal is known within {:.4g} deg with probability "
                   "{:g}; this error is in no measure; {}",
                   angle * 180 / kPi, kDefaultConeConfidence, advice)});
}

/// A hand that takes hold of the target may miss what it is to take hold of.
void add_wide_estimate(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  const bool takes_hold =
      problem.hand_motion.moves() || problem.impulse.contact == ContactLaw::Latch;
  if (!has_estimate(problem) || !takes_hold) return;
  const double angle = known_angle(problem), radius = known_radius(problem);
  if (angle <= kMostTilt && radius <= kMostRadius) return;
  const std::string known =
      radius < kInfinity
          ? fmt::format(
                "the contact point is known within {:.3g} m and the normal within {:.4g} "
                "deg, each with probability {:g}",
                radius, angle * 180 / kPi, kDefaultConeConfidence)
          : "the contact cannot be predicted";
  out.push_back(
      {kWideEstimateRule, "target", "state.covariance",
       known + fmt::format(": beyond {:g} m or {:g} deg a hand may miss, which trials do not "
                           "count: each has its contact wherever the feature is; a later or "
                           "better estimate is needed",
                           kMostRadius, kMostTilt * 180 / kPi)});
}

/// The mean over the residual velocity is a closed form.
void add_not_in_measure(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  const UncertaintySpec& spread = problem.uncertainty;
  if (!spread.residual_velocity || problem.measure.kind != RiskMeasure::Expectation) return;
  const JointVectord& joints = spread.joint_position;
  const std::pair<const char*, bool> half_ranges[] = {
      {"restitution", spread.restitution > 0},
      {"target_mass", spread.target_mass > 0},
      {"target_inertia", spread.target_inertia > 0},
      {"contact_point", spread.contact_point > 0},
      {"joint_position", joints.size() > 0 && joints.maxCoeff() > 0},
      {"contact_time", spread.contact_time > 0}};
  for (const auto& [key, is_stated] : half_ranges) {
    if (!is_stated) continue;
    out.push_back({kNotInMeasureRule, "uncertainty", key,
                   "is drawn by trials alone: over residual_velocity 'expectation' is a closed "
                   "form of the velocity's error; leave residual_velocity out for a mean over "
                   "samples of it"});
  }
  const MeasureSpec unstated;
  const std::pair<const char*, bool> samples[] = {
      {"samples", problem.measure.samples != unstated.samples},
      {"sample_seed", problem.measure.seed != unstated.seed}};
  for (const auto& [key, is_stated] : samples) {
    if (!is_stated) continue;
    out.push_back({kNotInMeasureRule, "objective", key,
                   "is not used: over uncertainty.residual_velocity 'expectation' is a closed form "
                   "without samples"});
  }
}

}  // namespace

std::vector<LeftOut> left_out(const CaptureProblem& problem) {
  std::vector<LeftOut> out;
  if (const auto narrow = narrow_cone(problem)) {
    out.push_back({kNarrowConeRule, "uncertainty", "cone_half_angle", to_string(*narrow)});
  }
  add_narrow_residual(problem, out);
  add_unused_covariance(problem, out);
  add_fixed_normal(problem, out);
  add_wide_estimate(problem, out);
  add_not_in_measure(problem, out);
  return out;
}

}  // namespace stillbase
