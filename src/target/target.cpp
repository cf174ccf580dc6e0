#include <stillbase/target/target.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <stillbase/core/linear_algebra.hpp>

// The rotation is integrated in Euler parameters alone: with the angular momentum L constant in N,
// omega = R I^-1 R' L is a function of the attitude. L is then conserved by construction and the
// energy as well as the attitude is.

namespace stillbase {
namespace {

// w, x, y, z of R_NT.
using EulerParameters = std::array<double, 4>;
using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<EulerParameters>;

// Rotation between nodes, rad. With a step of order 8 the local error is below the rounding error.
constexpr double kAnglePerNode = 0.05;
constexpr double kMaxNodes = 1e7;  // 500 000 rad on either side of the estimate

EulerParameters to_array(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }
Eigen::Quaterniond to_quaternion(const EulerParameters& e) {
  return Eigen::Quaterniond(e[0], e[1], e[2], e[3]).normalized();
}

// d/dt of the Euler parameters: q_dot = 1/2 q * omega (in T).
struct FreeRotation {
  Matrix3d inverse_inertia;
  Vector3d L;  // in N

  Vector3d rate_in_T(const Eigen::Quaterniond& q) const {
    return inverse_inertia * (q.conjugate() * L);
  }
  void operator()(const EulerParameters& e, EulerParameters& rate, double /*time*/) const {
    // Stages of the integrator differ from unit length; only the direction is an attitude.
    const Vector3d w = rate_in_T(to_quaternion(e));
    rate[0] = -0.5 * (e[1] * w.x() + e[2] * w.y() + e[3] * w.z());
    rate[1] = 0.5 * (e[0] * w.x() + e[2] * w.z() - e[3] * w.y());
    rate[2] = 0.5 * (e[0] * w.y() + e[3] * w.x() - e[1] * w.z());
    rate[3] = 0.5 * (e[0] * w.z() + e[1] * w.y() - e[2] * w.x());
  }
};

bool rotates(const TargetBody& body, const TargetState& estimate) {
  return !body.is_point_mass && !body.inertia.isZero(0) && !estimate.angular_velocity.isZero(0);
}

}  // namespace

Matrix3d TargetBody::inverse_inertia() const {
  return is_point_mass || inertia.isZero(0) ? Matrix3d(Matrix3d::Zero())
                                            : Matrix3d(inertia.inverse());
}

double target_inverse_mass(double mass, const Matrix3d& inverse_inertia, const Vector3d& r,
                           const Vector3d& n) {
  const Vector3d lever = r.cross(n);
  return 1 / mass + lever.dot(inverse_inertia * lever);
}

struct TargetMotion::Table {
  TargetBody body;
  TargetState estimate;
  double horizon = 0;
  // Nodes are at estimate.time + (i - middle) * spacing; empty when the rate is constant in N.
  std::vector<Eigen::Quaterniond> nodes;
  double spacing = 0;
  int middle = 0;
  Vector3d constant_rate = Vector3d::Zero();  // in N
  FreeRotation rotation;

  Eigen::Quaterniond step(const Eigen::Quaterniond& from, double dt) const {
    EulerParameters e = to_array(from);
    Stepper stepper;
    stepper.do_step(rotation, e, 0.0, dt);
    return to_quaternion(e);
  }

  Eigen::Quaterniond orientation(double dt) const {
    if (nodes.empty()) {
      return (rotation_exp(dt * constant_rate) * estimate.pose.orientation).normalized();
    }
    const int nearest = static_cast<int>(std::lround(dt / spacing));
    return step(nodes[static_cast<std::size_t>(nearest + middle)], dt - nearest * spacing);
  }

  Vector3d angular_velocity(const Eigen::Quaterniond& q) const {
    return nodes.empty() ? constant_rate : Vector3d(q * rotation.rate_in_T(q));
  }

  // Euler's equations: I omega_dot = -omega x I omega, in N.
  Vector3d angular_acceleration(const Eigen::Quaterniond& q, const Vector3d& omega) const {
    if (nodes.empty()) return Vector3d::Zero();
    return -(q * (rotation.inverse_inertia * (q.conjugate() * omega.cross(rotation.L))));
  }
};

TargetMotion::TargetMotion(TargetBody body, const TargetState& estimate, double horizon) {
  if (!(horizon > 0) || !std::isfinite(horizon)) {
    throw std::invalid_argument("TargetMotion: the horizon must be finite and positive");
  }
  auto table = std::make_shared<Table>();
  table->body = std::move(body);
  table->estimate = estimate;
  table->estimate.pose.orientation.normalize();
  table->horizon = horizon;

  if (rotates(table->body, estimate)) {
    const Eigen::Quaterniond q = table->estimate.pose.orientation;
    const Matrix3d& I = table->body.inertia;
    assert(I.llt().info() == Eigen::Success);
    const Vector3d w = q.conjugate() * estimate.angular_velocity;
    const Vector3d L = I * w;
    // About a principal axis (always so for a sphere) the rate is constant, up to rounding.
    if (w.cross(L).norm() <= 8 * std::numeric_limits<double>::epsilon() * w.norm() * L.norm()) {
      table->constant_rate = estimate.angular_velocity;
    } else {
      table->rotation = {I.inverse(), q * L};
      const double smallest_moment = principal_moments(I)[0];
      // The rate is bounded by the energy: I_min |omega|^2 <= omega' I omega.
      const double max_rate = std::sqrt(w.dot(L) / smallest_moment);
      const double count = std::ceil(horizon * max_rate / kAnglePerNode);
      if (!(count <= kMaxNodes)) {
        throw std::invalid_argument(
            "TargetMotion: the target rotates by more than 500 000 rad within the horizon");
      }
      const int side = std::max(1, static_cast<int>(count));
      table->spacing = horizon / side;
      table->middle = side;
      table->nodes.resize(static_cast<std::size_t>(2 * side + 1));
      const auto node = [&](int i) -> Eigen::Quaterniond& {
        return table->nodes[static_cast<std::size_t>(side + i)];
      };
      node(0) = q;
      for (int i = 1; i <= side; ++i) {
        node(i) = table->step(node(i - 1), table->spacing);
        node(-i) = table->step(node(1 - i), -table->spacing);
      }
    }
  }
  table_ = std::move(table);
}

const TargetBody& TargetMotion::body() const { return table_->body; }

TargetState TargetMotion::state(double time) const {
  const Table& table = *table_;
  double dt = time - table.estimate.time;
  // Times at the ends of the horizon may differ from them by rounding.
  const double slack = 1e-12 * (table.horizon + std::abs(table.estimate.time));
  if (!(std::abs(dt) <= table.horizon + slack)) {
    throw std::out_of_range("TargetMotion: time outside the horizon");
  }
  dt = std::min(std::max(dt, -table.horizon), table.horizon);
  TargetState state;
  state.time = time;
  state.pose.position =
      table.estimate.pose.position + (time - table.estimate.time) * table.estimate.linear_velocity;
  state.linear_velocity = table.estimate.linear_velocity;
  state.pose.orientation = table.orientation(dt);
  state.angular_velocity = table.angular_velocity(state.pose.orientation);
  return state;
}

ContactState TargetMotion::contact(const ContactFeature& feature, double time) const {
  const TargetState s = state(time);
  const Vector3d& omega = s.angular_velocity;
  const Vector3d alpha = table_->angular_acceleration(s.pose.orientation, omega);
  ContactState contact;
  contact.r = s.pose.orientation * feature.point;
  contact.normal = s.pose.orientation * feature.normal;
  contact.point = s.pose.position + contact.r;
  contact.velocity = s.linear_velocity + omega.cross(contact.r);
  contact.point_rate = contact.velocity;
  contact.normal_rate = omega.cross(contact.normal);
  contact.velocity_rate = alpha.cross(contact.r) + omega.cross(omega.cross(contact.r));
  return contact;
}

}  // namespace stillbase
