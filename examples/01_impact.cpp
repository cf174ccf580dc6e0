// One impact on a free-floating robot: 1 N s on the hand, along -z of the base.
//
//   base rate after the impact   0.8551 deg/s
//   case                         G1
//
// Run from the root of the repository.
#include <cstdio>

#include <stillbase/stillbase.hpp>

int main() {
  using namespace stillbase;
  const RobotModel robot = read_robot("problems/robots/iiwa_on_cube.urdf", "hand");
  const JointVectord phi = JointVectord::Constant(robot.n(), 0.4);  // rad

  Vector6d Fbar;  // [force; moment] on the hand in the base frame, N s and N m s
  Fbar << 0, 0, -1, 0, 0, 0;
  const JointResistance free_joints{};
  const ImpactSummary impact = summarize_impact(robot, phi, free_joints, Fbar, 0);

  // Delta_Omega is the velocity jump of the base, linear part first (equation 6 of the paper).
  const Vector3d omega = impact.Delta_Omega.tail<3>();
  std::printf("base rate after the impact   %.4g deg/s\n", omega.norm() * 180 / M_PI);
  std::printf("case                         %s\n", to_string(impact.judgement.impact_case).c_str());

  // The angular momentum that the impulse brings is shared by base and arm (equation 16).
  const double error = (impact.base + impact.coupling - impact.total).norm();
  std::printf("base %.4g + arm = total %.4g N m s, to %.0e\n", impact.base.norm(),
              impact.total.norm(), error);
  return error < 1e-12 ? 0 : 1;
}
