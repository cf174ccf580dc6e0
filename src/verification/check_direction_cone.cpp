// The direction cone that follows from the covariance of the target's estimate: by samples, each
// moved by an integration of its own, where the planner carries a few weighted points.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <stillbase/core/random.hpp>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

constexpr int kInstants = 7;
constexpr double kTurnPerStep = 0.02;  // rad; an error below 1e-6 rad after 1000 of them

/// Torque-free rotation by Euler's equations in principal axes, classical Runge-Kutta.
struct FreeBody {
  Vector3d moments;      // kg m^2
  Eigen::Quaterniond q;  // R_NP, P the principal axes
  Vector3d w;            // in P, rad/s

  struct Rate {
    Eigen::Vector4d q;  // w, x, y, z
    Vector3d w;
  };
  Rate rate(const Eigen::Vector4d& e, const Vector3d& v) const {
    return {0.5 * Eigen::Vector4d(-e[1] * v[0] - e[2] * v[1] - e[3] * v[2],
                                  e[0] * v[0] + e[2] * v[2] - e[3] * v[1],
                                  e[0] * v[1] + e[3] * v[0] - e[1] * v[2],
                                  e[0] * v[2] + e[1] * v[1] - e[2] * v[0]),
            {(moments[1] - moments[2]) / moments[0] * v[1] * v[2],
             (moments[2] - moments[0]) / moments[1] * v[2] * v[0],
             (moments[0] - moments[1]) / moments[2] * v[0] * v[1]}};
  }
  int steps(double duration) const {
    // The energy bounds the rate.
    const double fastest =
        std::sqrt(moments.dot(w.cwiseAbs2()) / moments.minCoeff()) * std::abs(duration);
    return 1 + static_cast<int>(fastest / kTurnPerStep);
  }
  void advance(double duration) {
    const int count = steps(duration);
    const double h = duration / count;
    Eigen::Vector4d e(q.w(), q.x(), q.y(), q.z());
    for (int i = 0; i < count; ++i) {
      const Rate a = rate(e, w);
      const Rate b = rate(e + h / 2 * a.q, w + h / 2 * a.w);
      const Rate c = rate(e + h / 2 * b.q, w + h / 2 * b.w);
      const Rate d = rate(e + h * c.q, w + h * c.w);
      e += h / 6 * (a.q + 2 * b.q + 2 * c.q + d.q);
      w += h / 6 * (a.w + 2 * b.w + 2 * c.w + d.w);
      e.normalize();
    }
    q = Eigen::Quaterniond(e[0], e[1], e[2], e[3]);
  }
};

/// Where the normal looks at the instants, for an estimate that is off by the given errors.
class Normals {
 public:
  Normals(const CaptureProblem& problem, const ContactFeature& feature)
      : problem_(problem), body_(*problem.target), feature_(feature) {
    axes_.setIdentity();
    moments_.setOnes();
    if (!body_.is_point_mass) {
      const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(body_.inertia);
      axes_ = principal.eigenvectors();
      if (axes_.determinant() < 0) axes_.col(2) *= -1;
      moments_ = principal.eigenvalues();
    }
  }

  std::vector<Vector3d> at(const std::vector<double>& times, const Vector3d& orientation_error,
                           const Vector3d& rate_error, const Vector3d& moments_error) const {
    const TargetState& state = problem_.target_state;
    const Eigen::Quaterniond R_NT = state.pose.orientation * rotation_exp(orientation_error);
    const Eigen::Quaterniond R_TP(axes_);
    FreeBody body{moments_.cwiseProduct(moments_error.array().exp().matrix()), R_NT * R_TP,
                  Vector3d::Zero()};
    if (!body_.is_point_mass) {
      body.w = body.q.conjugate() * (state.angular_velocity + rate_error);
    }
    const Vector3d normal = R_TP.conjugate() * feature_.normal;
    std::vector<Vector3d> normals;
    double now = state.time;
    for (const double time : times) {
      body.advance(time - now);
      now = time;
      normals.push_back(body.q * normal);
    }
    return normals;
  }

  /// Integration steps of the estimate itself until the last instant.
  double steps(const std::vector<double>& times) const {
    const FreeBody body{
        moments_, problem_.target_state.pose.orientation * Eigen::Quaterniond(axes_),
        (problem_.target_state.pose.orientation * Eigen::Quaterniond(axes_)).conjugate() *
            problem_.target_state.angular_velocity};
    return body.steps(std::abs(times.front() - problem_.target_state.time) + times.back() -
                      times.front());
  }

 private:
  const CaptureProblem& problem_;
  const TargetBody& body_;
  const ContactFeature& feature_;
  Matrix3d axes_;
  Vector3d moments_;
};

}  // namespace

void check_direction_cone(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  if (!problem.uncertainty.cone_confidence) return;
  const double confidence = *problem.uncertainty.cone_confidence;
  const double half_angle = problem.uncertainty.cone_half_angle;
  const std::optional<ContactFeature> feature = feature_of(problem);
  if (!problem.target_deviations || !feature || problem.impulse.direction) {
    throw std::runtime_error("no covariance of a target from which a cone could follow");
  }
  const EstimateDeviations& sigma = *problem.target_deviations;
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  std::vector<double> times{lower};
  for (int i = 1; i < kInstants && upper > lower; ++i) {
    times.push_back(lower + (upper - lower) * i / (kInstants - 1));
  }

  const Normals normals(problem, *feature);
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
      // In a wedge the turn about the plane's normal counts.
      const double angle =
          plane ? std::abs(std::atan2(plane_N.dot(n.cross(sampled[k])), n.dot(sampled[k])))
                : angle_between(n, sampled[k]);
      if (angle <= half_angle * (1 + 1e-12)) ++inside[k];
    }
  }
  const auto least = std::min_element(inside.begin(), inside.end());
  const double fraction = static_cast<double>(*least) / count;
  if (half_angle == 0) {
    // Nothing that turns the normal is uncertain.
    claims.at_most("direction_cone", 1 - fraction, 0, "1", "no sampled normal turns");
    return;
  }
  // Four standard errors of the fraction, and a hundredth for errors that are not Gaussian.
  const double limit = 4 * std::sqrt(confidence * (1 - confidence) / count) + 0.01;
  claims.at_most(
      "direction_cone", std::abs(fraction - confidence), limit, "1",
      fmt::format("a half-angle of {:.6g} rad holds {:.4f} of {} sampled directions at {:.6g} s, "
                  "where it holds the fewest; stated {:.4f}",
                  half_angle, fraction, count,
                  times[static_cast<std::size_t>(least - inside.begin())], confidence));
}

}  // namespace stillbase::verification
