#include "simulation/robots.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase::test {
namespace {

void add_link(RobotModel& robot, const Vector3d& p, double mass, const Vector3d& centroid,
              const Matrix3d& inertia, const Matrix3d& R = Matrix3d::Identity()) {
  const int k = robot.n();
  Joint joint;
  joint.name = "joint" + std::to_string(k + 1);
  joint.type = JointType::Continuous;
  joint.parent = k - 1;
  joint.p = p;
  joint.R = R;
  robot.joints.push_back(joint);
  robot.bodies.push_back({"link" + std::to_string(k + 1), {}, mass, centroid, inertia});
  robot.moves_hand.push_back(true);
  robot.hand_body = k;
}

Matrix3d diagonal(double x, double y, double z) { return Vector3d(x, y, z).asDiagonal(); }

// One number after the other: compilers evaluate operands in different orders.
Vector3d random_vector(Random& random, double lower, double upper) {
  const Vector3d direction = random.unit_vector();
  return random.uniform(lower, upper) * direction;
}

Matrix3d random_rotation(Random& random) {
  return rotation_exp(random_vector(random, 0, 3.1)).toRotationMatrix();
}

/// Of a cloud of point masses, so it is possible.
Matrix3d random_inertia(Random& random, double mass) {
  Matrix3d I = Matrix3d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector3d r = 0.3 * random_vector(random, 0.3, 1);
    I += mass / 6 * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  return I;
}

}  // namespace

RobotModel planar_two_link(char reading) {
  RobotModel robot;
  robot.name = std::string("planar_two_link_") + reading;
  robot.base = {"base", {}, 1000, Vector3d::Zero(), diagonal(338, 338, 563.3)};
  const Matrix3d rod = diagonal(0.333, 33.3, 33.3);
  add_link(robot, {1.4, reading == 'A' ? 0.0 : 1.2, 0}, 100, {1, 0, 0}, rod);
  add_link(robot, {2, 0, 0}, 100, {1, 0, 0}, rod);
  robot.p_hand = {2, 0, 0};
  return robot;
}

RobotModel planar_three_link() {
  RobotModel robot;
  robot.name = "planar_three_link";
  robot.base = {"base", {}, 100, Vector3d::Zero(), diagonal(40, 40, 66.66)};
  add_link(robot, {1.05, 0, 0}, 10, {0.45, 0, 0}, diagonal(0.005396, 0.5396, 0.5396));
  add_link(robot, {0.9, 0, 0}, 8, {0.35, 0, 0}, diagonal(0.00245, 0.245, 0.245));
  add_link(robot, {0.7, 0, 0}, 4, {0.15, 0, 0}, diagonal(0.0001583, 0.01583, 0.01583));
  robot.p_hand = {0.4, 0, 0};
  return robot;
}

RobotModel spart_3dof() {
  RobotModel robot;
  robot.name = "spart_3dof";
  robot.base = {"base", {}, 105, Vector3d::Zero(), diagonal(10.540476, 10.540476, 9.35)};
  // Joint frames have z along the joint axis; joints 2 and 3 turn about the chain's x axis.
  Matrix3d z_to_x;  // columns: axes of the joint frame, z = chain x, x = chain y, y = chain z
  z_to_x << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const double shift = 0.0238095;
  add_link(robot, {0, 0, 0.375 + 0.25 - shift}, 5, {0, 0, 0.1}, diagonal(0.05, 0.05, 0.05));
  add_link(robot, {0, 0, 0.2}, 10, {0, 0.375, 0}, diagonal(0.1, 0.1, 0.1), z_to_x);
  add_link(robot, {0, 0.75, 0}, 10, {0, 0.375, 0}, diagonal(0.1, 0.1, 0.1));
  robot.p_hand = {0, 0.75, 0};
  return robot;
}

RobotModel random_robot(Random& random, int n, bool prismatic) {
  RobotModel robot;
  robot.name = "random";
  const double base_mass = random.uniform(20, 60);
  robot.base = {"base", {}, base_mass, Vector3d::Zero(), random_inertia(random, 4 * base_mass)};
  for (int k = 0; k < n; ++k) {
    const double mass = random.uniform(1, 10);
    const Matrix3d R = random_rotation(random), inertia = random_inertia(random, mass);
    const Vector3d centroid = random_vector(random, 0, 0.3), p = random_vector(random, 0.2, 0.7);
    add_link(robot, p, mass, centroid, inertia, R);
    Joint& joint = robot.joints.back();
    joint.parent = k == 0 ? kBase : random.index(k + 1) - 1;
    if (prismatic && k % 3 == 2) joint.type = JointType::Prismatic;
  }
  robot.p_hand = 0.3 * random.unit_vector();
  robot.hand_body = n - 1;
  std::fill(robot.moves_hand.begin(), robot.moves_hand.end(), false);
  for (int k = n - 1; k != kBase; k = robot.joints[static_cast<std::size_t>(k)].parent) {
    robot.moves_hand[static_cast<std::size_t>(k)] = true;
  }
  return robot;
}

PlantState random_state(Random& random, int n, double rate) {
  PlantState state;
  state.base.position = random.unit_vector();
  state.base.orientation = Eigen::Quaterniond(random_rotation(random));
  state.phi.resize(n);
  state.phidot.resize(n);
  for (int k = 0; k < n; ++k) {
    state.phi[k] = random.uniform(-1, 1);
    state.phidot[k] = random.uniform(-rate, rate);
  }
  state.Omega << rate * random.unit_vector(), rate * random.unit_vector();
  return state;
}

TEST_CASE("the paper's robots have the printed inertias", "[simulation]") {
  const RobotModel robot = planar_two_link('A');
  JointVectord phi(2);
  phi << -80 * kDegree, 160 * kDegree;
  const TildeInertia<double> tilde =
      compute_tilde_inertia(compute_inertia(robot, compute_kinematics(robot, phi)));
  CHECK(tilde.Htilde_omega(2, 2) == Approx(1306.4125).epsilon(1e-7));
  CHECK(tilde.Htilde_omegaphi(2, 0) == Approx(335.4101).epsilon(1e-6));
  CHECK(tilde.Htilde_omegaphi(2, 1) == Approx(-19.2206).epsilon(1e-5));
}

}  // namespace stillbase::test
