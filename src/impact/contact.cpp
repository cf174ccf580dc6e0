#include <stillbase/impact/contact.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace stillbase {

double target_inverse_mass(double mass, const Matrix3d& inertia, const Vector3d& r,
                           const Vector3d& n) {
  double w = 1 / mass;
  const Vector3d lever = r.cross(n);
  if (!inertia.isZero(0) && !lever.isZero(0)) w += lever.dot(inertia.llt().solve(lever));
  return w;
}

double normal_impulse(double restitution, double closing_speed, double hand_inverse_mass,
                      double target_inverse_mass) {
  if (closing_speed <= 0) return 0;
  return (1 + restitution) * closing_speed / (hand_inverse_mass + target_inverse_mass);
}

}  // namespace stillbase
