// A robot as URDF, read back.
#include <catch2/catch.hpp>

#include <filesystem>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/export/export.hpp>
#include <stillbase/robot/urdf_reader.hpp>

using namespace stillbase;

namespace {

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  REQUIRE(a.rows() == b.rows());
  REQUIRE(a.cols() == b.cols());
  const double size = std::max(a.size() > 0 ? a.cwiseAbs().maxCoeff() : 0.0, 1e-300);
  return a.size() > 0 ? (a - b).cwiseAbs().maxCoeff() / size : 0;
}

void check_same_matrices(const RobotModel& a, const RobotModel& b, const JointVectord& phi) {
  const auto ka = compute_kinematics<double>(a, phi), kb = compute_kinematics<double>(b, phi);
  const auto Ia = compute_inertia(a, ka), Ib = compute_inertia(b, kb);
  CHECK(difference(Ia.H_b, Ib.H_b) < 1e-12);
  CHECK(difference(Ia.H_bphi, Ib.H_bphi) < 1e-12);
  CHECK(difference(Ia.H_phi, Ib.H_phi) < 1e-12);
  CHECK(difference(ka.r_bh, kb.r_bh) < 1e-12);
  const auto Ja = compute_hand_jacobian(a, ka), Jb = compute_hand_jacobian(b, kb);
  CHECK(difference(Ja.J_phi, Jb.J_phi) < 1e-12);
  CHECK(difference(Ja.R_bh, Jb.R_bh) < 1e-12);
}

void check_same_frames(const RobotModel& a, const RobotModel& b) {
  REQUIRE(a.links.size() == b.links.size());
  for (const LinkFrame& link : a.links) {
    INFO(link.name);
    const LinkFrame* const other = find_link(b, link.name);
    REQUIRE(other != nullptr);
    CHECK(other->body == link.body);
    CHECK((other->pose.position - link.pose.position).norm() < 1e-12);
    CHECK(other->pose.orientation.angularDistance(link.pose.orientation) < 1e-7);
    CHECK((other->pose.orientation.toRotationMatrix() - link.pose.orientation.toRotationMatrix())
              .norm() < 1e-14);
  }
  REQUIRE(a.shapes.size() == b.shapes.size());
  for (std::size_t i = 0; i < a.shapes.size(); ++i) {
    CHECK(a.shapes[i].link == b.shapes[i].link);
    CHECK(a.shapes[i].geometry.index() == b.shapes[i].geometry.index());
    CHECK((a.shapes[i].pose.position - b.shapes[i].pose.position).norm() < 1e-12);
  }
}

}  // namespace

TEST_CASE("every shipped robot written as URDF reads back with the same matrices and frames") {
  int robots = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(STILLBASE_SOURCE_DIR "/problems/robots")) {
    if (entry.path().extension() != ".urdf") continue;
    const std::string path = entry.path().string();
    RobotModel robot = read_urdf(read_text_file(path), path, "");
    INFO(path);
    const std::string text = robot_urdf(robot);
    INFO(text);
    CHECK(text.find("Units: m, rad, kg") != std::string::npos);
    const RobotModel back = read_urdf(text, "written", robot.hand);
    REQUIRE(back.n() == robot.n());
    for (int k = 0; k < robot.n(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      CHECK(back.joints[i].name == robot.joints[i].name);
      CHECK(back.joints[i].type == robot.joints[i].type);
      CHECK(back.joints[i].lower == robot.joints[i].lower);
      CHECK(back.joints[i].upper == robot.joints[i].upper);
      CHECK(back.joints[i].max_velocity == robot.joints[i].max_velocity);
      CHECK(back.joints[i].max_effort == robot.joints[i].max_effort);
      CHECK(back.joints[i].viscous_friction == robot.joints[i].viscous_friction);
    }
    check_same_frames(robot, back);
    Random random(7, static_cast<std::uint64_t>(robots));
    for (int trial = 0; trial < 5; ++trial) {
      JointVectord phi(robot.n());
      for (double& x : phi) x = random.uniform(-2, 2);
      check_same_matrices(robot, back, phi);
    }
    ++robots;
  }
  CHECK(robots >= 8);
}

TEST_CASE("axes and origins in any direction, also at a pitch of 90 deg, read back to rounding") {
  const std::string head =
      "<robot name='r &amp; \"s\"'><link name='base'><inertial><origin xyz='0.1 -0.2 0.3'/><mass "
      "value='10'/><inertia ixx='2' ixy='0.1' ixz='-0.2' iyy='3' iyz='0.3' izz='4'/></inertial>"
      "</link><link name='panel'><inertial><origin xyz='1 0 0' rpy='0.3 0.4 0.5'/><mass value='1'/>"
      "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
      "<joint name='weld' type='fixed'><origin xyz='0 1 0' rpy='1 1 1'/><parent link='base'/>"
      "<child link='panel'/></joint><link name='arm'><inertial><origin xyz='0 0.1 0.5' rpy='1 2 "
      "3'/>"
      "<mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' izz='1.5'/></inertial>"
      "<collision><origin xyz='0 0 0.2' rpy='0.1 1.5707963267948966 0'/><geometry><cylinder "
      "radius='0.1' length='0.4'/></geometry></collision>"
      "<collision name='x_capsule'><geometry><cylinder radius='0.2' length='0.1'/></geometry>"
      "</collision></link><link name='tool'/>";
  const std::string tail =
      "<joint name='tool_fixed' type='fixed'><origin xyz='0 0 1' rpy='0 -1.5707963267948966 2'/>"
      "<parent link='arm'/><child link='tool'/></joint></robot>";
  const char* origins[] = {"0 0 0", "0.7 1.5707963267948966 0.3", "2 -1.5707963267948966 -1",
                           "3.1 0.2 -2.9", "0.1 1.5707963 0.2"};
  const char* axes[] = {"0 0 1", "0 0 -1", "1 0 0", "0 -1 0", "1 2 -3", "1e-9 0 -1"};
  Random random(3, 0);
  for (const char* origin : origins) {
    for (const char* axis : axes) {
      INFO(origin << ", " << axis);
      const std::string joint =
          std::string("<joint name='j' type='continuous'><origin xyz='0.4 0.5 0.6' rpy='") +
          origin + "'/><parent link='panel'/><child link='arm'/><axis xyz='" + axis + "'/></joint>";
      const RobotModel robot = read_urdf(head + joint + tail, "source", "tool");
      const RobotModel back = read_urdf(robot_urdf(robot), "written", "tool");
      CHECK(back.name == robot.name);
      check_same_frames(robot, back);
      const JointVectord phi = JointVectord::Constant(1, random.uniform(-3, 3));
      check_same_matrices(robot, back, phi);
    }
  }
}

TEST_CASE("a body that no link stands for is a link of its own") {
  const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/planar_three_link.urdf";
  RobotModel robot = read_urdf(read_text_file(path), path, "");
  robot.base.name = "assembled";
  const RobotModel back = read_urdf(robot_urdf(robot), "written", robot.hand);
  CHECK(back.base.name == "assembled");
  check_same_matrices(robot, back, JointVectord::Constant(3, 0.7));
}

TEST_CASE("a joint that follows another one is written as such") {
  const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/planar_three_link.urdf";
  std::string text = read_text_file(path);
  const std::size_t at = text.find("</joint>", text.find("name=\"joint_3\""));
  text.insert(at, "<mimic joint=\"joint_2\" multiplier=\"-0.5\" offset=\"0.25\"/>");
  const RobotModel robot = read_urdf(text, "source", "hand");
  REQUIRE(robot.is_coupled());
  const RobotModel back = read_urdf(robot_urdf(robot), "written", "hand");
  REQUIRE(back.n() == 2);
  check_same_frames(robot, back);
  check_same_matrices(robot, back, JointVectord::Constant(2, 0.7));
}

TEST_CASE("a joint without limits is written with numbers that a reader takes") {
  const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/planar_three_link.urdf";
  RobotModel robot = read_urdf(read_text_file(path), path, "");
  Joint& free = robot.joints[1];
  free.type = JointType::Revolute;
  free.lower = -kInfinity;
  free.upper = kInfinity;
  free.max_velocity = kInfinity;
  free.max_effort = kInfinity;
  robot.joints[2].type = JointType::Continuous;
  robot.joints[2].max_velocity = kInfinity;
  robot.joints[2].max_effort = 5;
  const RobotModel back = read_urdf(robot_urdf(robot), "written", robot.hand);
  REQUIRE(back.n() == 3);
  CHECK(back.joints[1].lower <= -1e50);
  CHECK(back.joints[1].upper >= 1e50);
  CHECK(back.joints[1].max_velocity >= 1e50);
  CHECK(back.joints[1].max_effort >= 1e50);
  CHECK(back.joints[2].max_velocity >= 1e50);
  CHECK(back.joints[2].max_effort == 5);
  CHECK(back.remarks.empty());
  check_same_matrices(robot, back, JointVectord::Constant(3, 0.7));
}

TEST_CASE("a mesh has no place in one URDF file") {
  RobotModel robot = read_urdf(
      read_text_file(STILLBASE_SOURCE_DIR "/problems/robots/planar_two_link_a.urdf"), "a", "");
  robot.shapes.push_back({kBase, robot.base.name, {}, ConvexMesh{}});
  CHECK_THROWS_AS(robot_urdf(robot), InputError);
}
