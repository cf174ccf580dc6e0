// The direction cone that follows from the covariance of the target's estimate: by samples, each
// integrated on its own, where the planner propagates a few weighted points.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include "verification/checks.hpp"
#include "verification/free_body.hpp"
#include "verification/residual_velocity.hpp"

namespace stillbase::verification {
namespace {

constexpr int kInstants = 7;
constexpr double kAnglePerStep = 0.02;  ///< rad; an error below 1e-6 rad after 1000 steps

/// Normals of the feature at the instants, for an estimate with the given errors.
class Normals {
 public:
  Normals(const CaptureProblem& problem, const ContactFeature& feature)
      : state_(problem.target_state), is_point_mass_(problem.target->is_point_mass) {
    Matrix3d axes = Matrix3d::Identity();
    if (!is_point_mass_) {
      const SymmetricEigen3 principal = symmetric_eigen3(problem.target->inertia);
      axes = principal.vectors;
      if (axes.determinant() < 0) axes.col(2) *= -1;
      moments_ = principal.values;
    }
    R_TP_ = Eigen::Quaterniond(axes);
    normal_P_ = R_TP_.conjugate() * feature.normal;
  }

  std::vector<Vector3d> at(const std::vector<double>& times, const Vector3d& orientation_error,
                           const Vector3d& rate_error, const Vector3d& moments_error) const {
    FreeBody body = erroneous(orientation_error, rate_error, moments_error);
    std::vector<Vector3d> normals;
    double now = state_.time;
    for (const double time : times) {
      body.advance(time - now, kAnglePerStep);
      now = time;
      normals.push_back(body.q * normal_P_);
    }
    return normals;
  }

  /// Integration steps of the estimate itself until the last instant.
  double steps(const std::vector<double>& times) const {
    const Vector3d none = Vector3d::Zero();
    return erroneous(none, none, none)
        .steps(std::abs(times.front() - state_.time) + times.back() - times.front(), kAnglePerStep);
  }

 private:
  FreeBody erroneous(const Vector3d& orientation_error, const Vector3d& rate_error,
                     const Vector3d& moments_error) const {
    FreeBody body{moments_.cwiseProduct(moments_error.array().exp().matrix()),
                  state_.pose.orientation * rotation_exp(orientation_error) * R_TP_,
                  Vector3d::Zero()};
    if (!is_point_mass_) body.w = body.q.conjugate() * (state_.angular_velocity + rate_error);
    return body;
  }

  TargetState state_;
  bool is_point_mass_;
  Vector3d moments_ = Vector3d::Ones();
  Eigen::Quaterniond R_TP_;
  Vector3d normal_P_;
};

/// How many of the sampled normals lie within the problem's half-angle, at the instant of the
/// window with the fewest.
struct Sampled {
  double fraction = 0, time = 0;
  int count = 0;
};

Sampled sample_normals(const Context& context, const ContactFeature& feature) {
  const CaptureProblem& problem = context.problem;
  const double half_angle = problem.uncertainty.cone_half_angle;
  const EstimateDeviations& sigma = *problem.target_deviations;
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  std::vector<double> times{lower};
  for (int i = 1; i < kInstants && upper > lower; ++i) {
    times.push_back(lower + (upper - lower) * i / (kInstants - 1));
  }

  const Normals normals(problem, feature);
  const Vector3d none = Vector3d::Zero();
  const std::vector<Vector3d> nominal = normals.at(times, none, none, none);
  const auto& plane = problem.uncertainty.cone_plane_normal;
  const Vector3d plane_N = plane ? problem.base.orientation * *plane : Vector3d::Zero();

  // As many samples as some seconds allow.
  const int count = static_cast<int>(std::clamp(2e6 / normals.steps(times), 500.0, 6000.0));
  std::vector<int> inside(times.size(), 0);
  Random random(1);
  const auto error = [&](const Vector3d& deviation) -> Vector3d {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return deviation.cwiseProduct(Vector3d(x, y, z));
  };
  for (int i = 0; i < count; ++i) {
    if (context.options.stop.reached()) throw std::runtime_error("stopped");
    const Vector3d orientation = error(sigma.orientation), rate = error(sigma.angular_velocity),
                   moments = error(sigma.moments);
    const std::vector<Vector3d> sampled = normals.at(times, orientation, rate, moments);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Vector3d& n = nominal[k];
      // In a wedge the angle about the plane's normal counts.
      const double angle =
          plane ? std::abs(std::atan2(plane_N.dot(n.cross(sampled[k])), n.dot(sampled[k])))
                : angle_between(n, sampled[k]);
      if (angle <= half_angle * (1 + 1e-12)) ++inside[k];
    }
  }
  const auto least = std::min_element(inside.begin(), inside.end());
  return {static_cast<double>(*least) / count,
          times[static_cast<std::size_t>(least - inside.begin())], count};
}

/// Four standard errors of a fraction of `count`, and a hundredth for errors that are not Gaussian.
double fraction_tolerance(double fraction, int count) {
  return 4 * std::sqrt(fraction * (1 - fraction) / count) + 0.01;
}

/// How often.
long warns_of(const Plan& plan, const std::string& code) {
  return std::count_if(plan.warnings.begin(), plan.warnings.end(),
                       [&](const PlanWarning& warning) { return warning.code == code; });
}

/// What the problem states of the uncertainty and the measure does not count: the plan says so.
void check_unused(const Context& context, bool has_covariance, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const UncertaintySpec& spread = problem.uncertainty;
  const bool has_residual = spread.residual_velocity.has_value();
  long unused = 0;
  if (has_residual && problem.measure.kind == RiskMeasure::Expectation) {
    for (const double half_range : {spread.restitution, spread.target_mass, spread.target_inertia,
                                    spread.contact_point, spread.contact_time}) {
      unused += half_range > 0 ? 1 : 0;
    }
    unused += (spread.joint_position.array() > 0).any() ? 1 : 0;
    unused += problem.measure.samples != MeasureSpec{}.samples ? 1 : 0;
    unused += problem.measure.seed != MeasureSpec{}.seed ? 1 : 0;
  }
  const bool is_unused_covariance = has_covariance && !has_residual &&
                                    problem.impulse.source != ImpulseSource::Given &&
                                    problem.impulse.contact != ContactLaw::Frictionless;
  const long said = warns_of(context.plan, "not-in-measure");
  const long covariances = warns_of(context.plan, "unused-covariance");
  if (unused + said + covariances == 0 && !is_unused_covariance) return;
  Objections objections;
  objections.demand(
      said == unused,
      fmt::format("{} stated things are not in the measure, the plan says {}", unused, said));
  objections.demand(covariances == (is_unused_covariance ? 1 : 0),
                    is_unused_covariance ? "the plan does not say that it leaves the covariance out"
                                         : "the plan says that it leaves a covariance out");
  claims.none_wrong("unused_uncertainty", objections,
                    "the plan names what its problem states as uncertain and its measure does not "
                    "count");
}

/// A covariance of the relative velocity stated beside that of the estimate: the plan warns where
/// it is smaller at the plan's contact.
void check_residual_warning(const Context& context, ClaimList& claims) {
  constexpr double kEqual = 1e-3;  // of the integrations of the covariance
  const CaptureProblem& problem = context.problem;
  if (!context.situation.event.velocity) return;
  const Matrix6d stated = residual_case(context.situation).covariance;
  CaptureProblem carried = problem;
  carried.uncertainty.residual_velocity = ResidualVelocity{};
  const Matrix6d implied = residual_case(Situation(carried, context.plan.configuration)).covariance;
  Matrix6d excess = stated * (1 + kEqual) - implied;
  Vector6d unit;
  for (int i = 0; i < 6; ++i) unit[i] = 1 / std::sqrt(std::max(implied(i, i), 1e-300));
  excess = unit.asDiagonal() * excess * unit.asDiagonal();
  const bool is_smaller = symmetric_eigenvalues(excess).minCoeff() < -kEqual;
  Objections objections;
  objections.demand(!is_smaller || warns_of(context.plan, "narrow-residual") == 1,
                    "the plan does not say that its covariance of the relative velocity is smaller "
                    "than that of the estimate");
  claims.none_wrong("residual_warning", objections,
                    "the stated covariance of the relative velocity and that of the estimate");
}

/// A cone stated beside a covariance: the plan warns exactly where the cone does not hold 95 % of
/// the directions.
void check_warning(const Context& context, const ContactFeature& feature, ClaimList& claims) {
  constexpr double kProbability = 0.95;
  const bool warns = warns_of(context.plan, "narrow-cone") > 0;
  const Sampled sampled = sample_normals(context, feature);
  const double margin = fraction_tolerance(kProbability, sampled.count);
  Objections objections;
  objections.demand(warns || sampled.fraction >= kProbability - margin,
                    "the plan does not say that its cone is narrower");
  objections.demand(!warns || sampled.fraction <= kProbability + margin,
                    "the plan says that its cone is narrower");
  claims.none_wrong("cone_warning", objections,
                    fmt::format("the stated cone of {:.6g} rad holds {:.4f} of {} directions "
                                "sampled from the covariance of the estimate at {:.6g} s",
                                context.problem.uncertainty.cone_half_angle, sampled.fraction,
                                sampled.count, sampled.time));
}

}  // namespace

void check_direction_cone(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const std::optional<ContactFeature> feature = feature_of(problem);
  const bool follows = problem.target_deviations && feature && !problem.impulse.direction;
  check_unused(context, follows, claims);
  const auto& residual = problem.uncertainty.residual_velocity;
  if (follows && residual && residual->covariance) check_residual_warning(context, claims);
  if (!problem.uncertainty.cone_confidence) {
    const bool has_cone = problem.impulse.contact == ContactLaw::Frictionless &&
                          problem.impulse.source != ImpulseSource::Given &&
                          !problem.uncertainty.residual_velocity;
    if (follows && has_cone) check_warning(context, *feature, claims);
    return;
  }
  const double confidence = *problem.uncertainty.cone_confidence;
  const double half_angle = problem.uncertainty.cone_half_angle;
  if (!follows) {
    throw std::runtime_error("no covariance of a target from which a cone could follow");
  }
  const Sampled sampled = sample_normals(context, *feature);
  if (half_angle == 0) {
    // No error changes the normal.
    claims.at_most("direction_cone", 1 - sampled.fraction, 0, "1", "no sampled normal changes");
    return;
  }
  claims.at_most(
      "direction_cone", std::abs(sampled.fraction - confidence),
      fraction_tolerance(confidence, sampled.count), "1",
      fmt::format(
          "a half-angle of {:.6g} rad contains {:.4f} of {} sampled directions at {:.6g} s, "
          "the smallest share over the window; stated {:.4f}",
          half_angle, sampled.fraction, sampled.count, sampled.time, confidence));
}

}  // namespace stillbase::verification
