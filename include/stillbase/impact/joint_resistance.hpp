// How the joints resist during the impact. Changes the answer by 10 to 100 times, so it is always
// explicit and reported.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase {

enum class ResistanceModel {
  Free,          ///< the paper: joints move freely during the impact
  RotorInertia,  ///< Yoshida's virtual rotor inertia: H_phi + diag(I_r); stays in the plant
                 ///< afterwards
  Servo,         ///< stiffness K and damping D over a contact of duration h under a constant force:
                 ///< H_phi + h D/2 + h^2 K/6 in the jump (leading order); ends with the impact
  Locked         ///< the named joints do not move during the impact; ends with the impact
};

struct JointResistance {
  ResistanceModel model = ResistanceModel::Free;
  JointVectord rotor_inertia;   ///< RotorInertia: n, kg m^2 (kg), >= 0
  JointVectord stiffness;       ///< Servo: n, N m/rad
  JointVectord damping;         ///< Servo: n, N m s/rad
  double contact_duration = 0;  ///< Servo: s
  std::vector<bool> locked;     ///< Locked: n
};

/// What is added to the diagonal of H_phi in the jump (n): zero, I_r, or h D/2 + h^2 K/6.
JointVectord added_impact_inertia(const JointResistance& resistance, int n);

/// What is added to the diagonal of H_phi in the plant before and after the impact (n): I_r or
/// zero.
JointVectord added_plant_inertia(const JointResistance& resistance, int n);

/// "free", "rotor_inertia", "servo", "locked".
std::string to_string(ResistanceModel model);

}  // namespace stillbase
