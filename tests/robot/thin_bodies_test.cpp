// Bodies of public files whose tensor has a moment of zero: point masses and rods without
// thickness. They are read where every joint has an inertia to move.
#include <string>

#include <Eigen/Eigenvalues>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/found_robot.hpp"

namespace stillbase {
namespace {

/// The base and the arm, and behind it a link of 2 kg at `centroid` on a joint about or along y.
std::string thin_arm(const std::string& tensor, const std::string& centroid,
                     const std::string& type = "continuous", const std::string& more = "") {
  const std::string text =
      "<link name=\"x\"><inertial><origin xyz=\"" + centroid + "\"/><mass value=\"2\"/>" + tensor +
      "</inertial></link><joint name=\"k\" type=\"" + type +
      "\"><parent link=\"arm\"/><child link=\"x\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" "
      "upper=\"1\" effort=\"5\" velocity=\"1\"/></joint>" +
      more;
  return test::robot_of({"", "", text.c_str(), "", 0});
}

std::string moments(const std::string& xx, const std::string& yy, const std::string& zz) {
  return "<inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" +
         zz + "\"/>";
}

const std::string kPoint = moments("0", "0.0", "0");

/// The only remark of a robot that is read.
std::string remark_on(const std::string& text) {
  const RobotModel robot = read_urdf(text, "found.urdf", "x");
  REQUIRE(robot.remarks.size() == 1);
  CHECK(robot.remarks[0].rule == "inertia");
  return robot.remarks[0].message;
}

}  // namespace

TEST_CASE("point masses and rods without thickness are read with a remark") {
  for (const std::string& text :
       {thin_arm(kPoint, "0 0 -.5"), thin_arm(kPoint, "0 0 0", "prismatic"),
        thin_arm(moments("0.1", "0.1", "0"), "0 0 0.5"),
        thin_arm(moments("0", "0.12000", "0.12000"), "0 0 0")}) {
    INFO(text);
    const std::string message = remark_on(text);
    CHECK(message.find("a point mass or a rod without thickness: x") != std::string::npos);
  }
  // Pendulums of which the mass alone is stated.
  const RobotModel robot = read_urdf(thin_arm("", "0 0 -.5"), "found.urdf", "x");
  CHECK(robot.bodies[1].inertia.isZero(0));
  CHECK(robot.remarks.size() == 2);
}

TEST_CASE("a joint that moves no inertia is refused by its name") {
  const std::string what = "body 'x': no inertia about its joint 'k'";
  for (const std::string& text : {thin_arm(kPoint, "0 0 0"), thin_arm(kPoint, "0 0.7 0"),
                                  thin_arm(moments("0.1", "0", "0.1"), "0 0.7 0")}) {
    INFO(text);
    CHECK_THROWS_WITH(read_urdf(text, "found.urdf", "x"), Catch::Contains(what));
  }
  // The rotor of a drive is an inertia.
  CHECK_NOTHROW(read_urdf(
      thin_arm(kPoint, "0 0.7 0", "continuous",
               "<transmission name=\"t\"><joint name=\"k\"/><actuator "
               "name=\"m\"><drake:rotor_inertia value=\"0.01\"/></actuator></transmission>"),
      "found.urdf", "x"));
}

TEST_CASE("thin tensors of no body are refused") {
  CHECK_THROWS_WITH(read_urdf(thin_arm(moments("0", "0", "0.1"), "0 0 1"), "found.urdf", "x"),
                    Catch::Contains("not positive definite"));
  CHECK_THROWS_WITH(read_urdf(thin_arm(moments("0", "0.1", "0.2"), "0 0 1"), "found.urdf", "x"),
                    Catch::Contains("not positive definite"));
  CHECK_THROWS_WITH(read_urdf(thin_arm(moments("-1e-6", "0.1", "0.1"), "0 0 1"), "found.urdf", "x"),
                    Catch::Contains("not positive definite"));
}

TEST_CASE("a base without thickness has yet to be filled") {
  std::string text = test::robot_of({"", "", "", "", 0});
  const std::string whole = "iyy=\"0.1\" iyz=\"0\" izz=\"1.0E-1\"";
  text.replace(text.find(whole), whole.size(), "iyy=\"0\" iyz=\"0\" izz=\".1\"");
  CHECK_THROWS_WITH(read_urdf(text, "found.urdf", "arm"),
                    Catch::Contains("body 'base': the inertia tensor is not positive definite"));
  const RobotModel robot = read_urdf(text, "found.urdf", "arm", {.may_lack_base = true});
  REQUIRE(robot.remarks.size() == 1);
  CHECK(robot.remarks[0].message.find("a rod without thickness: base") != std::string::npos);
}

TEST_CASE("a merged link with a tensor that no body can have is remarked upon") {
  const auto with_fixed = [](const std::string& tensor) {
    return thin_arm(moments("0.1", "0.1", "0.1"), "0 0 0", "continuous",
                    "<link name=\"tip\"><inertial><mass value=\"0.1\"/>" + tensor +
                        "</inertial></link><joint name=\"t\" type=\"fixed\"><parent "
                        "link=\"x\"/><child link=\"tip\"/></joint>");
  };
  for (const std::string& tensor :
       {moments("-0.01", "0.01", "0.05"), moments("0.01", "0.01", "0.05")}) {
    const std::string message = remark_on(with_fixed(tensor));
    CHECK(message.find("no body can have: tip (merged into x): the inertia tensor") !=
          std::string::npos);
  }
  for (const std::string& tensor : {kPoint, moments("0.01", "0.01", "0.01")}) {
    CHECK(read_urdf(with_fixed(tensor), "found.urdf", "x").remarks.empty());
  }
}

TEST_CASE("the matrices of a robot of point masses are positive definite at every posture") {
  std::string links, joints;
  for (int k = 1; k <= 6; ++k) {
    const std::string name = "p" + std::to_string(k);
    const std::string parent = k == 1 ? "arm" : "p" + std::to_string(k - 1);
    links += "<link name=\"" + name +
             "\"><inertial><origin xyz=\"0.1 0 0.4\"/><mass value=\"1\"/>" + kPoint +
             "</inertial></link>";
    joints += "<joint name=\"q" + std::to_string(k) + "\" type=\"continuous\"><parent link=\"" +
              parent + "\"/><child link=\"" + name + "\"/><origin xyz=\"0 0 0.4\" rpy=\"0 0 1\"/>" +
              "<axis xyz=\"" + (k % 2 == 0 ? "1 0 0" : "0 1 0") + "\"/></joint>";
  }
  const std::string text = test::robot_of({"", "", (links + joints).c_str(), "", 0});
  const RobotModel robot = read_urdf(text, "found.urdf", "p6");
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    JointVectord phi(robot.n());
    for (int k = 0; k < robot.n(); ++k) phi[k] = random.uniform(-3, 3);
    const auto inertia = compute_inertia<double>(robot, compute_kinematics<double>(robot, phi));
    Eigen::MatrixXd H(6 + robot.n(), 6 + robot.n());
    H << inertia.H_b, inertia.H_bphi, inertia.H_bphi.transpose(), inertia.H_phi;
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(H).eigenvalues();
    CHECK(values.minCoeff() > 1e-6 * values.maxCoeff());
  }
}

}  // namespace stillbase
