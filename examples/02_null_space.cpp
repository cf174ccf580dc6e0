// The reaction null space: joint rates that leave the base still.
//
//   rank of the angular coupling   3 of 7 joints
//   base rate                      2e-17 deg/s
//
// Run from the root of the repository.
#include <cstdio>

#include <stillbase/stillbase.hpp>

int main() {
  using namespace stillbase;
  const RobotModel robot = read_robot("problems/robots/iiwa_on_cube.urdf", "hand");
  const JointVectord phi = JointVectord::Constant(robot.n(), 0.4);  // rad

  // Each value is computed from the one before it; nothing is stored in the robot.
  const auto kinematics = compute_kinematics<double>(robot, phi);
  const auto inertia = compute_inertia<double>(robot, kinematics);
  const auto tilde = compute_tilde_inertia<double>(inertia);  // base translation eliminated
  const ReactionNullSpace space = angular_reaction_null_space(tilde);
  std::printf("rank of the angular coupling   %d of %d joints\n", space.rank, robot.n());

  // Any joint rates, projected onto the null space (equations 9 and 10).
  const JointVectord wanted = JointVectord::Constant(robot.n(), 0.1);  // rad/s
  const JointVectord phidot = decompose_joint_velocity(space, wanted).rns;

  // Without momentum the base rate follows from H~omega omega + H~omegaphi phidot = 0.
  const Vector3d omega = -tilde.Htilde_omega.llt().solve(tilde.Htilde_omegaphi * phidot);
  std::printf("joint rates                    %.4g rad/s in norm\n", phidot.norm());
  std::printf("base rate                      %.2g deg/s\n", omega.norm() * 180 / M_PI);
  return omega.norm() < 1e-12 && phidot.norm() > 0.1 ? 0 : 1;
}
