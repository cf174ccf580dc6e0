// One impact on a shipped robot, with the headers, the library and the data of an installed
// package.
#include <iostream>

#include <stillbase/core/file.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/robot/urdf_reader.hpp>

int main() {
  using namespace stillbase;
  const std::string path = PROBLEMS_DIR "/robots/iiwa_on_cube.urdf";
  const RobotModel robot = read_urdf(read_text_file(path), path, "hand");
  const int n = robot.n();

  const ImpactResistance free_joints{JointVectord::Zero(n), {}};
  const JointVectord phi = JointVectord::Constant(n, 0.4);
  Vector6d F;
  F << 0, 0, -1, 0, 0, 0;
  const auto posture = evaluate_posture<double>(robot, free_joints, phi);
  const auto response = respond<double>(posture, F);

  // The jump carries the whole impulse: linear momentum f, angular momentum r_gh x f + t.
  const auto momentum = compute_momentum<double>(posture.inertia, posture.tilde,
                                                 response.d.Delta_Omega, response.d.Delta_phidot);
  const double error = (momentum.P - F.head<3>()).norm() + (momentum.L_g - response.total).norm();
  std::cout << "base rate after 1 N s: " << response.omega().norm() << " rad/s, momentum error "
            << error << '\n';
  return response.omega().norm() > 0 && error < 1e-12 ? 0 : 1;
}
