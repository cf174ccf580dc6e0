#include <stillbase/impact/contact_impulse.hpp>

#include <stdexcept>

#include <Eigen/Cholesky>

#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/gradient.hpp>

namespace stillbase {

namespace {

Vector3d lever(const ContactTarget& target) {
  return target.is_point_mass() ? Vector3d(Vector3d::Zero()) : target.r;
}

void require_inertia(const ContactTarget& target) {
  if (target.is_point_mass()) {
    throw std::invalid_argument("a latch needs a target with inertia, not a point mass");
  }
}

Vector3d angular_velocity_change(const ContactTarget& target, const Vector3d& moment) {
  if (target.is_point_mass()) return Vector3d::Zero();
  return target.inertia.llt().solve(moment);
}

}  // namespace

double normal_impulse(double restitution, double closing_speed, double hand_inverse_mass,
                      double target_inverse_mass) {
  if (closing_speed <= 0) return 0;
  return (1 + restitution) * closing_speed / (hand_inverse_mass + target_inverse_mass);
}

std::string to_string(ContactStatus status) {
  constexpr const char* kNames[] = {"hit", "separating", "pulling"};
  return kNames[static_cast<std::size_t>(status)];
}

Vector6d ContactTarget::contact_velocity() const {
  Vector6d V;
  V << velocity + angular_velocity.cross(lever(*this)), angular_velocity;
  return V;
}

Matrix3d target_inverse_inertia3(const ContactTarget& target) {
  Matrix3d W = Matrix3d::Identity() / target.mass;
  if (!target.is_point_mass()) {
    const Matrix3d S = skew(target.r);
    W -= S * target.inertia.llt().solve(S);
  }
  return (W + W.transpose()) / 2;
}

Matrix6d target_inverse_inertia6(const ContactTarget& target) {
  require_inertia(target);
  const Matrix3d inverse = target.inertia.llt().solve(Matrix3d::Identity());
  Matrix6d W;
  W.topLeftCorner<3, 3>() = target_inverse_inertia3(target);
  W.bottomLeftCorner<3, 3>() = inverse * skew(target.r);
  W.topRightCorner<3, 3>() = W.bottomLeftCorner<3, 3>().transpose();
  W.bottomRightCorner<3, 3>() = (inverse + inverse.transpose()) / 2;
  return W;
}

ContactImpulse contact_impulse(const Contact& contact, const Matrix6d& W_h,
                               const Vector6d& hand_velocity, const ContactTarget& target) {
  const Vector6d V_rel = target.contact_velocity() - hand_velocity;
  ContactImpulse out;
  out.closing_speed = contact.n.dot(V_rel.head<3>());
  const bool closing =
      contact.is_grasped ||
      (contact.law == ContactLaw::Latch ? out.closing_speed >= 0 : out.closing_speed > 0);
  if (contact.law == ContactLaw::Latch) require_inertia(target);
  if (!closing) return out;

  const Matrix3d W_h3 = W_h.topLeftCorner<3, 3>();
  out.status = ContactStatus::Hit;
  switch (contact.law) {
    case ContactLaw::Frictionless: {
      const double p =
          normal_impulse(contact.restitution, out.closing_speed, contact.n.dot(W_h3 * contact.n),
                         contact.n.dot(target_inverse_inertia3(target) * contact.n));
      out.Fbar.head<3>() = p * contact.n;
      break;
    }
    case ContactLaw::Sticking: {
      const Matrix3d W = W_h3 + target_inverse_inertia3(target);
      const Vector3d f = W.llt().solve(Vector3d(V_rel.head<3>()));
      if (f.dot(contact.n) < 0) {
        out.status = ContactStatus::Pulling;
      } else {
        out.Fbar.head<3>() = f;
      }
      break;
    }
    case ContactLaw::Latch: {
      const Matrix6d W = W_h + target_inverse_inertia6(target);
      out.Fbar = W.llt().solve(V_rel);
      break;
    }
  }
  return out;
}

ContactOutcome apply_contact(const RobotModel& robot, const JointVectord& phi,
                             const Vector6d& Omega, const JointVectord& phidot,
                             const JointResistance& resistance, const Contact& contact,
                             const ContactTarget& target) {
  const auto posture = evaluate_posture(robot, prepare_resistance(resistance, robot.n()), phi);
  const InertiaFactor<double>& factor = posture.factor;
  const HandJacobian<double>& jacobian = posture.jacobian;
  const Vector6d hand = jacobian.R_bh * Omega + jacobian.J_phi * phidot;

  ContactOutcome out;
  out.impulse = contact_impulse(contact, extended_inverse_inertia(factor, jacobian), hand, target);
  const Vector6d& Fbar = out.impulse.Fbar;
  const auto jump = compute_jump<double>(factor, jacobian, Fbar);
  out.after.Omega = Omega + jump.Delta_Omega;
  out.after.phidot = phidot + jump.Delta_phidot;
  const Vector3d f = Fbar.head<3>(), t = Fbar.tail<3>();
  out.after.target_velocity = target.velocity - f / target.mass;
  out.after.target_angular_velocity =
      target.angular_velocity - angular_velocity_change(target, lever(target).cross(f) + t);

  ContactTarget moved = target;
  moved.velocity = out.after.target_velocity;
  moved.angular_velocity = out.after.target_angular_velocity;
  const Vector6d hand_after = jacobian.R_bh * out.after.Omega + jacobian.J_phi * out.after.phidot;
  out.separation_speed = contact.n.dot((hand_after - moved.contact_velocity()).head<3>());
  return out;
}

}  // namespace stillbase
