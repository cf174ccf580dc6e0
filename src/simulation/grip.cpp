#include "simulation/grip_kernel.hpp"

namespace stillbase {

Vector6d grip_wrench(const HeldTarget& held, const RobotModel& robot,
                     const Kinematics<double>& kinematics, const PlantState& state,
                     const PlantAcceleration& acceleration) {
  return kernel::grip_wrench<double>(held.body.mass, held.body.inertia, held.hand_target.position,
                                     held.hand_target.orientation.toRotationMatrix(), robot,
                                     kinematics, state.Omega, state.phidot, acceleration.dot_Omega,
                                     acceleration.phiddot);
}

}  // namespace stillbase
