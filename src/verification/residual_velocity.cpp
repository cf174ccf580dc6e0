#include "verification/residual_velocity.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/free_body.hpp"
#include "verification/objective.hpp"

namespace stillbase::verification {
namespace {

/// Integration of the covariance, and the search for maxima over the ellipsoid.
struct ResidualOptions {
  double angle_per_step = 0.01;  ///< rad; an error below 1e-9 rad after 1000 steps
  double no_variance = 1e-14;    ///< of the largest variance: rounding
  double no_distance = 1e-9;     ///< of the velocities, in a direction without variance
  int ascents = 5000;            ///< steps towards a local maximum, of which each adds little
  double arrived = 1e-12;        ///< of the unit ball: a shorter step is the last
  double same_maximum = 1e-6;    ///< of the unit ball: distance of maxima that are one
  double isolated = 1e-2;        ///< relative, by which the square falls at least from a maximum
  int thirds = 300;              ///< of the range of the multiplier, until rounding ends them
};
constexpr ResidualOptions kResidual;

/// [v; omega] in N of a contact feature at a time, for an estimate with one of its errors.
class FeatureVelocity {
 public:
  FeatureVelocity(const CaptureProblem& problem, const ContactFeature& feature, double time)
      : state_(problem.target_state),
        duration_(time - problem.target_state.time),
        rotates_(!problem.target->is_point_mass) {
    if (!rotates_) return;
    axes_ = principal_axes(problem.target->inertia);
    point_P_ = axes_.R_TP.conjugate() * feature.point;
  }

  Vector6d with(const Vector3d& orientation, const Vector3d& rate, const Vector3d& moments) const {
    Vector6d out;
    out << state_.linear_velocity, Vector3d::Zero();
    if (!rotates_) return out;
    FreeBody body = erroneous_body(axes_, state_, orientation, rate, moments);
    body.advance(duration_, kResidual.angle_per_step);
    const Vector3d omega = body.q * body.w;
    out.head<3>() += omega.cross(body.q * point_P_);
    out.tail<3>() = omega;
    return out;
  }
  bool rotates() const { return rotates_; }

 private:
  TargetState state_;
  double duration_;
  bool rotates_;
  PrincipalAxes axes_;
  Vector3d point_P_ = Vector3d::Zero();
};

/// In N: of independent errors, each at sqrt(3) of its deviation to both sides.
Matrix6d carried_covariance(const CaptureProblem& problem, const ContactFeature& feature,
                            double time) {
  const EstimateDeviations& sigma = *problem.target_deviations;
  Matrix6d out = Matrix6d::Zero();
  out.diagonal().head<3>() = sigma.linear_velocity.cwiseAbs2();
  const FeatureVelocity velocity(problem, feature, time);
  if (!velocity.rotates()) return out;
  const Vector3d none = Vector3d::Zero();
  const Vector6d nominal = velocity.with(none, none, none);
  for (int kind = 0; kind < 3; ++kind) {
    for (int i = 0; i < 3; ++i) {
      for (const double side : {-std::sqrt(3.0), std::sqrt(3.0)}) {
        const auto error = [&](int of, const Vector3d& deviation) -> Vector3d {
          return of == kind ? Vector3d(side * deviation[i] * Vector3d::Unit(i))
                            : Vector3d(Vector3d::Zero());
        };
        const Vector6d d =
            velocity.with(error(0, sigma.orientation), error(1, sigma.angular_velocity),
                          error(2, sigma.moments)) -
            nominal;
        out += d * d.transpose() / 6;
      }
    }
  }
  return out;
}

/// R A R' of the two halves.
Matrix6d rotated(const Matrix3d& R, const Matrix6d& A) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  return both * A * both.transpose();
}

/// |y|^2 of the impulse that a relative velocity gives by the contact law, as a linear one: what
/// separates pulls.
/// @param before of the robot; empty: at rest
double square_at(const Situation& at, const Vector6d& V,
                 const std::optional<MotionOfRobot>& before = std::nullopt) {
  const CaptureProblem& problem = at.problem;
  ContactEvent event = at.event;
  event.velocity = V.head<3>();
  event.omega = V.tail<3>();
  if (problem.impulse.contact == ContactLaw::Frictionless) {
    // The square does not know the sign.
    if (event.n.dot(*event.velocity) < 0) *event.velocity *= -1;
    return square_of(problem, at.response, impulse_along(problem, event, at.response, event.n));
  }
  PostureResponse response = at.response;
  response.before = before;
  ContactEvent in_N = event;
  if (before) {
    *in_N.velocity += before->hand.head<3>();
    in_N.omega += before->hand.tail<3>();
  }
  hold_latched(problem, in_N, response);
  const Vector6d Fbar = reference::impulse_that_joins(response.dynamics, response.added_inertia,
                                                      response.locked, met_body(problem, event),
                                                      problem.impulse.contact == ContactLaw::Latch);
  return square_of(problem, response, Fbar);
}

/// The linear part where the hand moves, from velocities as large as the hand's:
/// without any there is no contact.
void add_motion_before(const Situation& at, const MotionOfRobot& before, ResidualCase& out) {
  const double speed = before.hand.head<3>().norm(), rate = before.hand.tail<3>().norm();
  for (int i = 0; i < 6; ++i) {
    const double size = i < 3 ? speed : rate, step = size > 0 ? size : 1;
    const double plus = square_at(at, step * Vector6d::Unit(i), before);
    const double minus = square_at(at, -step * Vector6d::Unit(i), before);
    out.linear[i] = (plus - minus) / (4 * step);
  }
}

}  // namespace

ResidualCase residual_case(const Situation& at) {
  const CaptureProblem& problem = at.problem;
  const ResidualVelocity& stated = *problem.uncertainty.residual_velocity;
  const ContactEvent& event = at.event;
  ResidualCase out;
  out.velocity << *event.velocity, event.omega;
  const std::optional<MotionOfRobot>& before = at.response.before;
  out.size = out.velocity.norm() + (before ? before->hand.norm() : 0.0);
  if (before) out.velocity -= before->hand;
  out.deviations = stated.deviations;
  const Matrix3d R_BN = at.at.base.orientation.conjugate().toRotationMatrix();
  if (stated.covariance) {
    const bool in_target = stated.frame == ResidualFrame::Target;
    out.covariance = rotated(in_target ? Matrix3d(R_BN * event.R_NT.toRotationMatrix()) : R_BN,
                             *stated.covariance);
  } else {
    out.covariance =
        rotated(R_BN, carried_covariance(problem, *feature_of(problem), at.at.contact_time));
    out.covariance.diagonal().head<3>().array() += std::pow(stated.linear_tracking, 2);
    out.covariance.diagonal().tail<3>().array() += std::pow(stated.angular_tracking, 2);
  }
  if (!before || problem.impulse.contact != ContactLaw::Latch) {
    const double speed = event.n.dot(out.velocity.head<3>());
    const double variance = event.n.dot(out.covariance.topLeftCorner<3, 3>() * event.n);
    out.separating = variance > 0 ? std::erfc(speed / std::sqrt(2 * variance)) / 2 : speed <= 0;
  }

  Vector6d alone;
  for (int i = 0; i < 6; ++i) alone[i] = square_at(at, Vector6d::Unit(i));
  for (int i = 0; i < 6; ++i) {
    out.form(i, i) = alone[i];
    for (int j = 0; j < i; ++j) {
      const double both = square_at(at, Vector6d::Unit(i) + Vector6d::Unit(j));
      out.form(i, j) = out.form(j, i) = (both - alone[i] - alone[j]) / 2;
    }
  }
  if (before) add_motion_before(at, *before, out);
  out.nominal = square_at(at, out.velocity, before);
  return out;
}

double ResidualCase::distance(const Vector6d& V) const {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const Eigen::VectorXd d = eigen.vectors.transpose() * (V - velocity);
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] > kResidual.no_variance * eigen.values[5]) {
      sum += d[i] * d[i] / eigen.values[i];
    } else if (std::abs(d[i]) > kResidual.no_distance * (V.norm() + size)) {
      return kInfinity;
    }
  }
  return std::sqrt(sum) / deviations;
}

Vector6d ResidualCase::at(const Vector6d& s) const { return velocity + deviations * root() * s; }

Matrix6d ResidualCase::root() const {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.vectors.transpose();
}

namespace {

/// |y|^2 over the ball |s| <= 1, V = Vbar + k root s: c + 2 q's + s'P s.
struct OverBall {
  Matrix6d P;
  Vector6d q;
  double c;

  explicit OverBall(const ResidualCase& residual) {
    const Matrix6d L = residual.deviations * residual.root();
    P = L.transpose() * residual.form * L;
    q = L.transpose() * residual.slope(residual.velocity);
    c = residual.nominal;
  }
  double square(const Vector6d& s) const { return c + s.dot(P * s + 2 * q); }
  /// The value rises with s -> (P s + q) / |P s + q|.
  Vector6d ascend(Vector6d s) const {
    for (int i = 0; i < kResidual.ascents; ++i) {
      const Vector6d next = P * s + q;
      if (!(next.norm() > 0)) break;
      const Vector6d before = s;
      s = next.normalized();
      if ((s - before).norm() < kResidual.arrived) break;
    }
    return s;
  }
};

}  // namespace

std::vector<Vector6d> local_maxima(const ResidualCase& residual) {
  const OverBall ball(residual);
  const SymmetricEigen axes = symmetric_eigen(ball.P);
  std::vector<Vector6d> out;
  for (int i = 5; i >= 0; --i) {
    for (const double side : {1.0, -1.0}) {
      const Vector6d s = ball.ascend(side * axes.vectors.col(i));
      const auto is_same = [&s](const Vector6d& other) {
        return (other - s).norm() < kResidual.same_maximum;
      };
      if (std::none_of(out.begin(), out.end(), is_same)) out.push_back(s);
    }
  }
  std::stable_sort(out.begin(), out.end(), [&ball](const Vector6d& a, const Vector6d& b) {
    return ball.square(a) > ball.square(b);
  });
  return out;
}

bool is_isolated(const ResidualCase& residual, const Vector6d& s) {
  const OverBall ball(residual);
  // (P s + q) = mu s at a maximum; along the sphere the square bends by P - mu E.
  const double mu = s.dot(ball.P * s + ball.q);
  const Eigen::MatrixXd across = PivotedQr(s).complement();
  const Eigen::VectorXd bends = symmetric_eigenvalues(across.transpose() * ball.P * across);
  return !(mu > 0) || bends[bends.size() - 1] < (1 - kResidual.isolated) * mu;
}

LargestSquare largest_square(const ResidualCase& residual) {
  const OverBall ball(residual);
  const double c = ball.c;
  const SymmetricEigen axes = symmetric_eigen(ball.P);
  LargestSquare out{residual.velocity, c, c};
  const auto take = [&](const Vector6d& s) {
    const Vector6d V = residual.at(s);
    const double value = residual.square(V);
    if (value > out.value) out = {V, value, value};
  };
  take(local_maxima(residual).front());
  // For every mu >= lambda_max(P): value <= c + mu + q' (mu E - P)^-1 q, convex in mu.
  const Vector6d along = axes.vectors.transpose() * ball.q;
  const double largest = std::max(axes.values[5], 0.0), reach = along.norm();
  const auto dual = [&](double mu) {
    double sum = c + mu;
    for (int i = 0; i < 6; ++i) {
      if (along[i] != 0) sum += along[i] * along[i] / (mu - axes.values[i]);
    }
    return sum;
  };
  double low = largest, high = largest + reach;
  for (int i = 0; i < kResidual.thirds && high > low; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (dual(a) < dual(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  const double bound = high > largest ? dual(high) : c + largest;
  // Where the largest eigenvalues are close, the ascent takes long to where the bound is attained.
  if (high > largest) {
    const Eigen::ArrayXd shifted = high - axes.values.array();
    take(ball.ascend((axes.vectors * (along.array() / shifted).matrix()).normalized()));
  }
  out.bound = std::max(out.value, std::isfinite(bound) ? bound : c + largest + reach);
  return out;
}

}  // namespace stillbase::verification
