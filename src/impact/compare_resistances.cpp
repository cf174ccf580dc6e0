#include <stillbase/impact/compare_resistances.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/jacobian.hpp>

namespace stillbase {

namespace {

constexpr double kServoFrequency = 2 * kPi * 10;  // rad/s
constexpr double kServoContact = 0.01;            // s

}  // namespace

std::vector<ComparedResistance> resistances_to_compare(const RobotModel& robot,
                                                       const JointVectord& phi,
                                                       const JointResistance& stated) {
  const int n = robot.n();
  const auto kinematics = compute_kinematics<double>(robot, phi);
  const auto hat = compute_hat_inertia(compute_inertia(robot, kinematics),
                                       compute_hand_jacobian(robot, kinematics));
  const JointVectord own = hat.Hhat_phi.diagonal();

  std::vector<ComparedResistance> list(4);
  JointResistance& rotor = list[1].resistance;
  rotor.model = ResistanceModel::RotorInertia;
  list[1].is_illustrative = stated.rotor_inertia.size() != n;
  rotor.rotor_inertia = list[1].is_illustrative ? own : stated.rotor_inertia;

  JointResistance& servo = list[2].resistance;
  servo.model = ResistanceModel::Servo;
  list[2].is_illustrative =
      stated.stiffness.size() != n || stated.damping.size() != n || !(stated.contact_duration > 0);
  if (list[2].is_illustrative) {
    servo.stiffness = own * (kServoFrequency * kServoFrequency);
    servo.damping = own * (2 * kServoFrequency);
    servo.contact_duration = kServoContact;
  } else {
    servo.stiffness = stated.stiffness;
    servo.damping = stated.damping;
    servo.contact_duration = stated.contact_duration;
  }

  JointResistance& locked = list[3].resistance;
  locked.model = ResistanceModel::Locked;
  locked.locked.assign(static_cast<std::size_t>(n), true);
  if (stated.model == ResistanceModel::Locked) locked.locked = stated.locked;
  return list;
}

}  // namespace stillbase
