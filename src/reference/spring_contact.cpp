#include "reference/spring_contact.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::reference {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// One step of x'' = -2 zeta x' - x for [x; x'], classical Runge-Kutta.
Vector2d stepped(const Vector2d& x, double zeta, double h) {
  const auto rate = [&](const Vector2d& y) { return Vector2d(y[1], -2 * zeta * y[1] - y[0]); };
  const Vector2d a = rate(x), b = rate(x + h / 2 * a), c = rate(x + h / 2 * b), d = rate(x + h * c);
  return x + h / 6 * (a + 2 * b + 2 * c + d);
}

// Part of the speed that is left where the force x + 2 zeta x' has become zero.
double speed_left(double zeta) {
  const double h = 2e-3 / (1 + 2 * zeta);
  const auto force = [&](const Vector2d& x) { return x[0] + 2 * zeta * x[1]; };
  Vector2d x(0, 1), next = stepped(x, zeta, h);
  while (force(next) > 0) {
    x = next;
    next = stepped(x, zeta, h);
  }
  double low = 0, high = h;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (force(stepped(x, zeta, middle)) > 0 ? low : high) = middle;
  }
  return -stepped(x, zeta, low)[1];
}

}  // namespace

ContactPush contact_push(const SpringContact& contact, const BodyMotion& body, const Vector3d& hand,
                         const Vector3d& hand_velocity) {
  const Eigen::Matrix3d R = body.pose.orientation.toRotationMatrix();
  const Vector3d& n = contact.normal;
  const Vector3d arm = R.transpose() * (hand - body.pose.position);
  const Vector3d u = R.transpose() * (hand_velocity - body.velocity) - body.rate.cross(arm);
  const Vector3d t = u - n.dot(u) * n;
  ContactPush out;
  out.gap = n.dot(arm - contact.point);
  out.push = -contact.stiffness * out.gap - contact.damping * n.dot(u);
  const double part = contact.friction / std::max(t.norm(), contact.slip_rate);
  const Vector3d force = std::max(0.0, out.push) * (n - part * t);
  out.force = R * force;
  if (contact.inertia.isZero(0)) return out;
  const Eigen::LDLT<Eigen::Matrix3d> inertia(contact.inertia);
  out.spin_rate = -inertia.solve(body.rate.cross(Vector3d(contact.inertia * body.rate)));
  out.moment_rate = -inertia.solve(arm.cross(force));
  return out;
}

double damping_for(double restitution, double stiffness, double effective_mass) {
  double low = 0, high = 1;
  while (speed_left(high) > restitution) high *= 2;
  for (int i = 0; i < 50; ++i) {
    const double zeta = (low + high) / 2;
    (speed_left(zeta) > restitution ? low : high) = zeta;
  }
  return 2 * high * std::sqrt(stiffness * effective_mass);
}

}  // namespace stillbase::reference
