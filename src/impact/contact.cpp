#include <stillbase/impact/contact.hpp>

namespace stillbase {

double normal_impulse(double restitution, double closing_speed, double hand_inverse_mass,
                      double target_inverse_mass) {
  if (closing_speed <= 0) return 0;
  return (1 + restitution) * closing_speed / (hand_inverse_mass + target_inverse_mass);
}

}  // namespace stillbase
