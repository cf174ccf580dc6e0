#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

JointVectord added_impact_inertia(const JointResistance& resistance, int n) {
  switch (resistance.model) {
    case ResistanceModel::RotorInertia:
      return resistance.rotor_inertia;
    case ResistanceModel::Servo: {
      const double h = resistance.contact_duration;
      return resistance.damping * (h / 2) + resistance.stiffness * (h * h / 6);
    }
    case ResistanceModel::Free:
    case ResistanceModel::Locked:
      break;
  }
  return JointVectord::Zero(n);
}

JointVectord added_plant_inertia(const JointResistance& resistance, int n) {
  if (resistance.model == ResistanceModel::RotorInertia) return resistance.rotor_inertia;
  return JointVectord::Zero(n);
}

std::string to_string(ResistanceModel model) {
  switch (model) {
    case ResistanceModel::Free:
      return "free";
    case ResistanceModel::RotorInertia:
      return "rotor_inertia";
    case ResistanceModel::Servo:
      return "servo";
    case ResistanceModel::Locked:
      return "locked";
  }
  return "";
}

}  // namespace stillbase
