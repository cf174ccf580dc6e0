#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

JointVectord added_impact_inertia(const JointResistance& resistance, int n) {
  if (resistance.model == ResistanceModel::Servo) {
    const double h = resistance.contact_duration;
    return resistance.damping * (h / 2) + resistance.stiffness * (h * h / 6);
  }
  return added_plant_inertia(resistance, n);
}

JointVectord added_plant_inertia(const JointResistance& resistance, int n) {
  if (resistance.model == ResistanceModel::RotorInertia) return resistance.rotor_inertia;
  return JointVectord::Zero(n);
}

std::string to_string(ResistanceModel model) {
  constexpr const char* kNames[] = {"free", "rotor_inertia", "servo", "locked"};
  return kNames[static_cast<std::size_t>(model)];
}

}  // namespace stillbase
