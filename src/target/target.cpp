#include <stillbase/target/target.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <stillbase/core/linear_algebra.hpp>

#include "target/motion_table.hpp"

// The rotation is integrated in Euler parameters alone: with the angular momentum L constant in N,
// omega = R I^-1 R' L is a function of the attitude. L is then conserved by construction and the
// energy as well as the attitude is.

namespace stillbase {
namespace {

// w, x, y, z of R_NT.
using EulerParameters = std::array<double, 4>;
using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<EulerParameters>;

constexpr double kMaxNodes = 1e7;          // 500 000 rad on either side of the estimate
constexpr std::size_t kMaxSeries = 20000;  // of 320 bytes each

EulerParameters to_array(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }
Eigen::Quaterniond to_quaternion(const EulerParameters& e) {
  return Eigen::Quaterniond(e[0], e[1], e[2], e[3]).normalized();
}

// d/dt of the Euler parameters: q_dot = 1/2 q * omega (in T).
struct FreeRotation {
  const Matrix3d& inverse_inertia;
  const Vector3d& L;  // in N

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

Eigen::Quaterniond step(const FreeRotation& rotation, const Eigen::Quaterniond& from, double dt) {
  EulerParameters e = to_array(from);
  Stepper stepper;
  stepper.do_step(rotation, e, 0.0, dt);
  return to_quaternion(e);
}

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

void MotionTable::reserve(double rotation) {
  nodes.reserve(static_cast<std::size_t>(2 * std::ceil(rotation / angle_per_node) + 1));
}

double MotionTable::largest_rate(const TargetState& from) const {
  if (!rotates(body, from)) return from.angular_velocity.norm();
  const Vector3d w = from.pose.orientation.conjugate() * from.angular_velocity;
  return std::sqrt(w.dot(body.inertia * w) / principal_moments(body.inertia)[0]);
}

void MotionTable::restart(const TargetState& from, double new_horizon) {
  if (!(new_horizon > 0) || !std::isfinite(new_horizon)) {
    throw std::invalid_argument("TargetMotion: the horizon must be finite and positive");
  }
  TargetState start = from;
  start.pose.orientation.normalize();
  const Eigen::Quaterniond q = start.pose.orientation;
  const Matrix3d& I = body.inertia;
  const Vector3d w = q.conjugate() * start.angular_velocity;
  const Vector3d L = I * w;
  // About a principal axis (always so for a sphere) the rate is constant, up to rounding.
  const bool is_constant =
      !rotates(body, start) ||
      w.cross(L).norm() <= 8 * std::numeric_limits<double>::epsilon() * w.norm() * L.norm();
  int side = 0;
  if (!is_constant) {
    assert(I.llt().info() == Eigen::Success);
    const double count = std::ceil(new_horizon * largest_rate(start) / angle_per_node);
    if (!(count <= kMaxNodes)) {
      throw std::invalid_argument(
          "TargetMotion: the target rotates by more than 500 000 rad within the horizon");
    }
    side = std::max(1, static_cast<int>(count));
  }
  estimate = start;
  horizon = new_horizon;
  nodes.clear();
  series.clear();
  constant_rate.setZero();
  if (is_constant) {
    if (rotates(body, start)) constant_rate = start.angular_velocity;
    return;
  }
  inverse_inertia = I.inverse();
  angular_momentum = q * L;
  spacing = horizon / side;
  middle = side;
  nodes.resize(2 * static_cast<std::size_t>(side) + 1);
  const auto node = [&](int i) -> Eigen::Quaterniond& {
    const int place = side + i;
    return nodes[static_cast<std::size_t>(place)];
  };
  const FreeRotation rotation{inverse_inertia, angular_momentum};
  node(0) = q;
  for (int i = 1; i <= side; ++i) {
    node(i) = step(rotation, node(i - 1), spacing);
    node(-i) = step(rotation, node(1 - i), -spacing);
  }
}

void MotionTable::expand() {
  series.clear();
  if (nodes.size() > kMaxSeries) return;
  series.reserve(nodes.size());
  for (const Eigen::Quaterniond& q : nodes) {
    series.emplace_back(q, inverse_inertia, angular_momentum);
  }
}

Eigen::Quaterniond MotionTable::orientation(double dt) const {
  if (nodes.empty()) {
    return (rotation_exp(dt * constant_rate) * estimate.pose.orientation).normalized();
  }
  const int nearest = static_cast<int>(std::lround(dt / spacing));
  const int place = nearest + middle;
  const double from_node = dt - nearest * spacing;
  if (!series.empty()) return series[static_cast<std::size_t>(place)].at(from_node);
  return step({inverse_inertia, angular_momentum}, nodes[static_cast<std::size_t>(place)],
              from_node);
}

Vector3d MotionTable::angular_velocity(const Eigen::Quaterniond& q) const {
  if (nodes.empty()) return constant_rate;
  return q * FreeRotation{inverse_inertia, angular_momentum}.rate_in_T(q);
}

TargetState MotionTable::state(double time) const {
  double dt = time - estimate.time;
  // Times at the ends of the horizon may differ from them by rounding.
  const double slack = 1e-12 * (horizon + std::abs(estimate.time));
  if (!(std::abs(dt) <= horizon + slack)) {
    throw std::out_of_range("TargetMotion: time outside the horizon");
  }
  dt = std::min(std::max(dt, -horizon), horizon);
  TargetState out;
  out.time = time;
  out.pose.position = estimate.pose.position + (time - estimate.time) * estimate.linear_velocity;
  out.linear_velocity = estimate.linear_velocity;
  out.pose.orientation = orientation(dt);
  out.angular_velocity = angular_velocity(out.pose.orientation);
  return out;
}

ContactState MotionTable::contact(const ContactFeature& feature, double time) const {
  const TargetState s = state(time);
  const Eigen::Quaterniond& q = s.pose.orientation;
  const Vector3d& omega = s.angular_velocity;
  ContactState contact;
  contact.r = q * feature.point;
  contact.normal = q * feature.normal;
  contact.point = s.pose.position + contact.r;
  contact.velocity = s.linear_velocity + omega.cross(contact.r);
  return contact;
}

struct TargetMotion::Table : MotionTable {};

TargetMotion::TargetMotion(TargetBody body, const TargetState& estimate, double horizon) {
  auto table = std::make_shared<Table>();
  table->body = std::move(body);
  table->restart(estimate, horizon);
  table->expand();
  table_ = std::move(table);
}

const TargetBody& TargetMotion::body() const { return table_->body; }

TargetState TargetMotion::state(double time) const { return table_->state(time); }

ContactState TargetMotion::contact(const ContactFeature& feature, double time) const {
  return table_->contact(feature, time);
}

}  // namespace stillbase
