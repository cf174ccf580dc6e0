// The direction cone that follows from the covariance of the target's estimate: by samples, each
// integrated on its own, where the planner propagates a few weighted points.
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include "verification/checks.hpp"
#include "verification/free_body.hpp"
#include "verification/residual_velocity.hpp"

namespace stillbase::verification {
namespace {

/// How features are sampled, and how well their fractions and covariances are known.
struct ConeCheckOptions {
  int instants = 7;              ///< of the window of contact times, evenly
  double angle_per_step = 0.02;  ///< rad; an error below 1e-6 rad after 1000 steps
  /// Integration steps of all samples: as many samples as some seconds allow, within their ends.
  double steps = 2e6;
  double fewest_samples = 500, most_samples = 6000;
  double on_rim = 1e-12;  ///< relative, by which an angle of the half-angle rounds
  /// Of a fraction of samples: standard errors, and a part for errors that are not Gaussian.
  double standard_errors = 4, not_gaussian = 0.01;
  double integrations = 1e-3;  ///< relative, between two integrations of a covariance
  double no_variance = 1e-12;  ///< of the sum of two covariances: rounding of its largest variances
  double probability = 0.95;   ///< of the warnings
};
constexpr ConeCheckOptions kCone;

/// Where the feature is.
struct Feature {
  Vector3d point, normal;  ///< in N
};

/// Errors of an estimate: normal ones with its standard deviations.
struct DrawnError {
  Vector3d orientation = Vector3d::Zero(), rate = Vector3d::Zero(), moments = Vector3d::Zero(),
           position = Vector3d::Zero(), velocity = Vector3d::Zero();
};

/// The feature at the instants, for an estimate with the given errors.
class Features {
 public:
  Features(const CaptureProblem& problem, const ContactFeature& feature)
      : state_(problem.target_state), is_point_mass_(problem.target->is_point_mass) {
    if (!is_point_mass_) axes_ = principal_axes(problem.target->inertia);
    normal_P_ = axes_.R_TP.conjugate() * feature.normal;
    point_P_ = axes_.R_TP.conjugate() * feature.point;
  }

  std::vector<Feature> at(const std::vector<double>& times, const DrawnError& error) const {
    FreeBody body = erroneous(error);
    std::vector<Feature> features;
    double now = state_.time;
    for (const double time : times) {
      body.advance(time - now, kCone.angle_per_step);
      now = time;
      const Vector3d centroid = state_.pose.position + error.position +
                                (time - state_.time) * (state_.linear_velocity + error.velocity);
      features.push_back({centroid + body.q * point_P_, body.q * normal_P_});
    }
    return features;
  }

  /// Integration steps of the estimate itself until the last instant.
  double steps(const std::vector<double>& times) const {
    return erroneous({}).steps(std::abs(times.front() - state_.time) + times.back() - times.front(),
                               kCone.angle_per_step);
  }

 private:
  FreeBody erroneous(const DrawnError& error) const {
    FreeBody body = erroneous_body(axes_, state_, error.orientation, error.rate, error.moments);
    if (is_point_mass_) body.w.setZero();
    return body;
  }

  TargetState state_;
  bool is_point_mass_;
  PrincipalAxes axes_;
  Vector3d normal_P_, point_P_;
};

/// How many of the sampled features are near the nominal one, at the instant of the window with the
/// fewest.
struct Sampled {
  double fraction = 0, time = 0;
  int count = 0;
};

/// Whether a feature is near the nominal one.
using IsNear = std::function<bool(const Feature& nominal, const Feature& sampled)>;

/// By each of several rules, over the same samples.
std::vector<Sampled> sample_features(const Context& context, const ContactFeature& feature,
                                     const std::vector<IsNear>& rules) {
  const CaptureProblem& problem = context.problem;
  const EstimateDeviations& sigma = *problem.target_deviations;
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  std::vector<double> times{lower};
  for (int i = 1; i < kCone.instants && upper > lower; ++i) {
    times.push_back(lower + (upper - lower) * i / (kCone.instants - 1));
  }
  const Features features(problem, feature);
  const std::vector<Feature> nominal = features.at(times, {});

  const int count = static_cast<int>(
      std::clamp(kCone.steps / features.steps(times), kCone.fewest_samples, kCone.most_samples));
  std::vector<std::vector<int>> inside(rules.size(), std::vector<int>(times.size(), 0));
  Random rotations(1), places(2);
  const auto error = [](Random& random, const Vector3d& deviation) -> Vector3d {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return deviation.cwiseProduct(Vector3d(x, y, z));
  };
  for (int i = 0; i < count; ++i) {
    if (context.options.stop.reached()) throw std::runtime_error("stopped");
    DrawnError e;
    e.orientation = error(rotations, sigma.orientation);
    e.rate = error(rotations, sigma.angular_velocity);
    e.moments = error(rotations, sigma.moments);
    e.position = error(places, sigma.position);
    e.velocity = error(places, sigma.linear_velocity);
    const std::vector<Feature> sampled = features.at(times, e);
    for (std::size_t r = 0; r < rules.size(); ++r) {
      for (std::size_t k = 0; k < times.size(); ++k) {
        if (rules[r](nominal[k], sampled[k])) ++inside[r][k];
      }
    }
  }
  std::vector<Sampled> out;
  for (const std::vector<int>& counts : inside) {
    const auto least = std::min_element(counts.begin(), counts.end());
    out.push_back({static_cast<double>(*least) / count,
                   times[static_cast<std::size_t>(least - counts.begin())], count});
  }
  return out;
}

/// Whether the normal is within an angle of the nominal one; in a wedge the angle about the plane's
/// normal counts.
IsNear within_angle(const CaptureProblem& problem, double half_angle) {
  const auto& plane = problem.uncertainty.cone_plane_normal;
  const Vector3d plane_N = plane ? problem.base.orientation * *plane : Vector3d::Zero();
  const bool is_wedge = plane.has_value();
  return [half_angle, plane_N, is_wedge](const Feature& nominal, const Feature& sampled) {
    const Vector3d &n = nominal.normal, &m = sampled.normal;
    const double angle =
        is_wedge ? std::abs(std::atan2(plane_N.dot(n.cross(m)), n.dot(m))) : angle_between(n, m);
    return angle <= half_angle * (1 + kCone.on_rim);
  };
}

/// How many of the sampled normals lie within the problem's half-angle.
Sampled sample_normals(const Context& context, const ContactFeature& feature) {
  const double half_angle = context.problem.uncertainty.cone_half_angle;
  return sample_features(context, feature, {within_angle(context.problem, half_angle)}).front();
}

/// By how much a fraction of `count` samples may differ.
double fraction_tolerance(double fraction, int count) {
  return kCone.standard_errors * std::sqrt(fraction * (1 - fraction) / count) + kCone.not_gaussian;
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
  const CaptureProblem& problem = context.problem;
  if (!context.situation.event.velocity) return;
  const Matrix6d stated = residual_case(context.situation).covariance;
  CaptureProblem carried = problem;
  carried.uncertainty.residual_velocity = ResidualVelocity{};
  const Matrix6d implied = residual_case(Situation(carried, context.plan.configuration)).covariance;
  Matrix6d excess = stated * (1 + kCone.integrations) - implied;
  // In a direction without variance a stated matrix has the rounding of its largest ones.
  excess.diagonal() += kCone.no_variance * (stated + implied).diagonal();
  Vector6d unit;
  for (int i = 0; i < 6; ++i) unit[i] = 1 / std::sqrt(std::max(implied(i, i), 1e-300));
  excess = unit.asDiagonal() * excess * unit.asDiagonal();
  const bool is_smaller = symmetric_eigenvalues(excess).minCoeff() < -kCone.integrations;
  Objections objections;
  objections.demand(!is_smaller || warns_of(context.plan, "narrow-residual") == 1,
                    "the plan does not say that its covariance of the relative velocity is smaller "
                    "than that of the estimate");
  claims.none_wrong("residual_warning", objections,
                    "the stated covariance of the relative velocity and that of the estimate");
}

/// Objections to a plan that warns although everything is known, or does not although something is
/// not: whether 95 % of the samples are near the nominal one, as far as their number tells.
void compare_warning(const Context& context, const std::string& code,
                     const std::vector<Sampled>& known, ClaimList& claims, const std::string& claim,
                     const std::string& words) {
  const bool warns = warns_of(context.plan, code) > 0;
  bool is_surely_open = false, may_be_open = false;
  for (const Sampled& sampled : known) {
    const double margin = fraction_tolerance(kCone.probability, sampled.count);
    is_surely_open = is_surely_open || sampled.fraction < kCone.probability - margin;
    may_be_open = may_be_open || sampled.fraction <= kCone.probability + margin;
  }
  Objections objections;
  objections.demand(warns || !is_surely_open, "the plan does not say " + code);
  objections.demand(!warns || may_be_open, "the plan says " + code);
  claims.none_wrong(claim, objections, words);
}

/// A cone stated beside a covariance: the plan warns exactly where the cone does not hold 95 % of
/// the directions.
void check_warning(const Context& context, const ContactFeature& feature, ClaimList& claims) {
  const Sampled sampled = sample_normals(context, feature);
  compare_warning(context, "narrow-cone", {sampled}, claims, "cone_warning",
                  fmt::format("the stated cone of {:.6g} rad holds {:.4f} of {} directions sampled "
                              "from the covariance of the estimate at {:.6g} s",
                              context.problem.uncertainty.cone_half_angle, sampled.fraction,
                              sampled.count, sampled.time));
}

/// A residual velocity beside a contact along the normal: the plan warns where the normal is known
/// less well than a degree.
void check_normal_warning(const Context& context, const ContactFeature& feature,
                          ClaimList& claims) {
  const IsNear within_degree = within_angle(context.problem, kPi / 180);
  const Sampled sampled = sample_features(context, feature, {within_degree}).front();
  compare_warning(
      context, "fixed-normal", {sampled}, claims, "normal_warning",
      fmt::format("{:.4f} of {} normals sampled from the covariance of the estimate are "
                  "within 1 deg of the nominal one at {:.6g} s",
                  sampled.fraction, sampled.count, sampled.time));
}

/// A hand that takes hold of the target: the plan warns where the feature may be 0.1 m or 30 deg
/// off.
void check_estimate_warning(const Context& context, const ContactFeature& feature,
                            ClaimList& claims) {
  const IsNear near = [](const Feature& nominal, const Feature& sampled) {
    return (sampled.point - nominal.point).norm() <= 0.1;
  };
  const std::vector<Sampled> known =
      sample_features(context, feature, {near, within_angle(context.problem, kPi / 6)});
  compare_warning(context, "wide-estimate", known, claims, "estimate_warning",
                  fmt::format("of {} features sampled from the covariance of the estimate {:.4f} "
                              "are within 0.1 m, {:.4f} within 30 deg of the nominal one",
                              known[0].count, known[0].fraction, known[1].fraction));
}

}  // namespace

void check_direction_cone(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const std::optional<ContactFeature> feature = feature_of(problem);
  const bool follows = problem.target_deviations && feature && !problem.impulse.direction;
  check_unused(context, follows, claims);
  const auto& residual = problem.uncertainty.residual_velocity;
  if (follows && residual && residual->covariance) check_residual_warning(context, claims);
  const bool is_hit = follows && problem.impulse.source != ImpulseSource::Given;
  const ContactLaw law = problem.impulse.contact;
  if (is_hit && residual && law == ContactLaw::Frictionless) {
    check_normal_warning(context, *feature, claims);
  }
  if (is_hit && (problem.hand_motion.moves() || law == ContactLaw::Latch)) {
    check_estimate_warning(context, *feature, claims);
  }
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
