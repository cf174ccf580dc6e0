// The robots in problems/robots against the numbers of their sources.
#include <algorithm>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/physical_checks.hpp>
#include <stillbase/robot/urdf_reader.hpp>

using namespace stillbase;

namespace {

RobotModel shipped(const std::string& name) {
  const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/" + name + ".urdf";
  return read_urdf(read_text_file(path), path, "hand");
}

/// Pose of the hand in B.
Pose hand_pose(const RobotModel& robot, const std::vector<double>& phi) {
  Pose pose{robot.p_hand, Eigen::Quaterniond(robot.R_hand)};
  for (int k = robot.hand_body; k != kBase; k = robot.joints[k].parent) {
    const Joint& joint = robot.joints[k];
    const Pose turn{Vector3d::Zero(),
                    Eigen::Quaterniond(Eigen::AngleAxisd(phi[k], Vector3d::UnitZ()))};
    pose = Pose{joint.p, Eigen::Quaterniond(joint.R.matrix())} * turn * pose;
  }
  return pose;
}

Pose straight_hand(const RobotModel& robot) {
  return hand_pose(robot, std::vector<double>(robot.joints.size(), 0.0));
}

struct Expected {
  const char* name;
  int joints;
  double base_mass, total_mass;
  Vector3d base_moments;
};

}  // namespace

TEST_CASE("every shipped robot is read, with the masses of its source") {
  const double deg = std::acos(-1.0) / 180;
  const Expected table[] = {
      {"planar_two_link_a", 2, 1000, 1200, {337.98, 337.98, 563.3}},
      {"planar_two_link_b", 2, 1000, 1200, {337.98, 337.98, 563.3}},
      {"planar_three_link", 3, 100, 122, {66.66, 66.66, 66.66}},
      {"spart_sc_3dof", 3, 105, 130, {10.540476, 10.540476, 9.35}},
      {"iiwa_on_cube", 7, 100, 117.5, {9.3, 9.3, 9.3}},
      {"ets7", 6, 2550, 2690.4, {6200, 3540, 7090}},
      {"deos", 7, 696.2, 719.3, {197.256667, 197.256667, 167.088}},
      {"servicer_6dof", 6, 700, 752, {338.333333, 338.333333, 298.666667}},
  };
  for (const Expected& expected : table) {
    INFO(expected.name);
    const RobotModel robot = shipped(expected.name);
    CHECK(robot.name == expected.name);
    CHECK(robot.n() == expected.joints);
    CHECK(robot.base.mass == Approx(expected.base_mass).epsilon(1e-12));
    CHECK(robot.total_mass() == Approx(expected.total_mass).epsilon(1e-12));
    CHECK((robot.base.inertia.diagonal() - expected.base_moments).norm() <
          1e-6 * expected.base_moments.norm());
    CHECK(leaf_links(robot) == std::vector<std::string>{"hand"});
    for (int k = 0; k < robot.n(); ++k) {
      CHECK(robot.moves_hand[k]);
      CHECK(robot.joints[k].parent == k - 1);
      CHECK(std::isfinite(robot.joints[k].max_velocity));
      CHECK(std::isfinite(robot.joints[k].max_effort));
      CHECK(robot.joints[k].max_velocity > 1 * deg);
      CHECK(inertia_fault(robot.bodies[k].inertia).empty());
      // Every body takes part in collision checks.
      const auto on_body = [&](const CollisionShape& shape) { return shape.body == k; };
      CHECK(std::any_of(robot.shapes.begin(), robot.shapes.end(), on_body));
    }
  }
}

TEST_CASE("the planar two-link robots reach the paper's hand positions") {
  const double deg = std::acos(-1.0) / 180;
  const std::vector<double> phi = {-80 * deg, 160 * deg};
  const Vector3d a = hand_pose(shipped("planar_two_link_a"), phi).position;
  const Vector3d b = hand_pose(shipped("planar_two_link_b"), phi).position;
  CHECK((a - Vector3d(2.094593, 0, 0)).norm() < 1e-6);
  CHECK((b - Vector3d(2.094593, 1.2, 0)).norm() < 1e-6);
}

TEST_CASE("the planar three-link robot stretches to 3.05 m") {
  const RobotModel robot = shipped("planar_three_link");
  CHECK((straight_hand(robot).position - Vector3d(1.05 + 0.9 + 0.7 + 0.3 + 0.1, 0, 0)).norm() <
        1e-14);
  CHECK(robot.joints[0].max_effort == 0.5);
  CHECK(robot.joints[0].max_velocity == Approx(50 * std::acos(-1.0) / 180).epsilon(1e-15));
}

TEST_CASE("the SPART robot's mount is merged into its base as computed by hand") {
  const RobotModel robot = shipped("spart_sc_3dof");
  // 5 kg at 0.375 + 0.125 m above 100 kg.
  const double c = 5 * 0.5 / 105;
  CHECK(c == Approx(0.0238095).epsilon(0).margin(5e-8));
  CHECK(robot.links[0].pose.position.z() == Approx(-c).epsilon(1e-14));
  const double I = 9.3 + 0.05 + 100 * c * c + 5 * (0.5 - c) * (0.5 - c);
  CHECK((robot.base.inertia - Matrix3d(Vector3d(I, I, 9.35).asDiagonal())).norm() < 1e-13);
  CHECK(I == Approx(10.540476).epsilon(0).margin(5e-7));
  CHECK(robot.base.merged_links == std::vector<std::string>{"mount"});
  const Pose hand = straight_hand(robot);
  CHECK((hand.position - Vector3d(0, 0, 0.375 + 0.25 + 0.2 + 0.75 + 0.75 - c)).norm() < 1e-14);
  // The cube is centred at the base link, not at the merged centroid.
  CHECK(robot.shapes[0].pose.position.z() == Approx(-c).epsilon(1e-14));
}

TEST_CASE("the iiwa stands straight up at zero") {
  const Pose hand = straight_hand(shipped("iiwa_on_cube"));
  const double height = 0.375 + 0.1575 + 0.2025 + 0.2045 + 0.2155 + 0.1845 + 0.2155 + 0.081 + 0.1;
  CHECK((hand.position - Vector3d(0, 0, height)).norm() < 1e-14);
  CHECK((hand.orientation * Vector3d::UnitZ() - Vector3d::UnitZ()).norm() < 1e-14);
}

TEST_CASE("ETS-VII's published link tensors are kept, rotated into link axes") {
  const RobotModel robot = shipped("ets7");
  CHECK(robot.base.inertia(0, 1) == 48.2);
  CHECK(robot.base.inertia(0, 2) == 78.5);
  CHECK(robot.base.inertia(1, 2) == -29.2);
  const double traces[] = {1.22 + 0.513 + 1.33,   0.10 + 3.38 + 3.36,  0.43 + 2.27 + 1.91,
                           0.39 + 0.396 + 0.0727, 0.57 + 0.65 + 0.129, 0.17 + 0.24 + 0.14};
  for (int k = 0; k < 6; ++k) {
    CHECK(robot.bodies[k].inertia.trace() == Approx(traces[k]).epsilon(1e-13));
  }
  // Least resistance about the link: the long direction of link 3 goes from joint 3 to joint 4.
  Matrix3d I = robot.bodies[2].inertia;
  const Vector3d along = robot.joints[3].p.normalized();
  const Vector3d across = along.unitOrthogonal();
  CHECK(along.dot(I * along) < 0.2 * across.dot(I * across));
  CHECK((straight_hand(robot).orientation * Vector3d::UnitZ()).norm() == Approx(1));
}

TEST_CASE("the DEOS arm reaches about 3.1 m from joint 1 when stretched") {
  const RobotModel robot = shipped("deos");
  const Vector3d hand = straight_hand(robot).position;
  CHECK((hand - Vector3d(-0.42, 0.47, -0.56)).norm() == Approx(3.1).epsilon(0).margin(0.05));
  CHECK((robot.joints[0].p - Vector3d(-0.42, 0.47, -0.56)).norm() < 1e-15);
}

TEST_CASE("joint 1 of DEOS has SpaceDyn's axes: turns about x, new y, new z") {
  const double deg = std::acos(-1.0) / 180;
  const Matrix3d expected = (Eigen::AngleAxisd(-90 * deg, Vector3d::UnitX()) *
                             Eigen::AngleAxisd(-45 * deg, Vector3d::UnitY()) *
                             Eigen::AngleAxisd(90 * deg, Vector3d::UnitZ()))
                                .toRotationMatrix();
  CHECK((shipped("deos").joints[0].R.matrix() - expected).norm() < 1e-14);
  const Matrix3d third = (Eigen::AngleAxisd(90 * deg, Vector3d::UnitX()) *
                          Eigen::AngleAxisd(180 * deg, Vector3d::UnitZ()))
                             .toRotationMatrix();
  CHECK((shipped("deos").joints[2].R.matrix() - third).norm() < 1e-14);
}

TEST_CASE("the servicer's arm stretches straight up from its mount") {
  const Vector3d hand = straight_hand(shipped("servicer_6dof")).position;
  CHECK((hand - Vector3d(0.5, 0, 0.9 + 0.25 + 1.0 + 0.9 + 0.25 + 0.25 + 0.2)).norm() < 1e-14);
}

TEST_CASE("arms to be mounted are read, with meshes and a coupled finger") {
  const std::string folder = STILLBASE_SOURCE_DIR "/problems/arms/";
  const RobotModel six =
      read_robot(folder + "six_joint_arm.urdf", "tool0", {.may_lack_base = true});
  CHECK(six.n() == 6);
  CHECK(six.base.mass == 0);
  REQUIRE(six.shapes.size() == 6);
  CHECK(std::get<ConvexMesh>(six.shapes[0].geometry).vertices.size() == 24);
  const RobotModel seven = read_robot(folder + "seven_joint_arm.urdf", "grasp");
  CHECK(seven.n() == 8);  // a finger moves, the other follows
  CHECK(seven.num_bodies() == 9);
  CHECK(seven.remarks.empty());
}
