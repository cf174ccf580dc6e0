// The same robot file read by MuJoCo: mass matrix, centroid and hand agree to rounding.
//
// MuJoCo fixes the root link to the world, so a floating joint is put above it; shapes are left
// out, since it would look for their meshes. Its joints know no <mimic>: its matrices are those of
// the whole tree, and ours their congruence G' H G.
#include <catch2/catch.hpp>

#ifndef STILLBASE_TEST_MUJOCO

TEST_CASE("MuJoCo reads the same robots") {
  WARN("skipped: MuJoCo (Debian: libmujoco-dev) is not installed");
}

#else

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "support/coupled_robot.hpp"
#include "support/shipped_problem.hpp"

using namespace stillbase;

namespace {

constexpr double kRounding = 1e-12;
/// MuJoCo 2.2 keeps principal moments and axes, and ends their iteration at angles of about 1e-6.
constexpr double kPrincipalAxes = 1e-6;

bool has_products_of_inertia(const std::string& urdf) {
  return std::regex_search(urdf, std::regex("i(xy|xz|yz)=\"[-+0.]*[1-9]"));
}

/// Without elements of this name.
std::string without(std::string text, const std::string& name) {
  const std::string begin = "<" + name, end = "</" + name + ">";
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos;) {
    const char next = text[at + begin.size()];
    if (next != '>' && next != ' ' && next != '\n') {
      ++at;
      continue;
    }
    text.erase(at, text.find(end, at) + end.size() - at);
  }
  return text;
}

/// The text as MuJoCo has to read it: the root floats, links keep their frames.
std::string for_mujoco(const std::string& urdf, const std::string& root) {
  std::string text = without(without(urdf, "collision"), "visual");
  const std::size_t robot = text.find("<robot");
  REQUIRE(robot != std::string::npos);
  text.insert(text.find('>', robot) + 1,
              "<mujoco><compiler fusestatic=\"false\" balanceinertia=\"false\"/></mujoco>"
              "<link name=\"world\"/><joint name=\"of the base\" type=\"floating\">"
              "<parent link=\"world\"/><child link=\"" +
                  root + "\"/></joint>");
  return text;
}

/// A robot in MuJoCo, its root link's frame at the origin.
class MuJoCoRobot {
 public:
  explicit MuJoCoRobot(const std::string& urdf) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    REQUIRE(mj_makeEmptyFileVFS(files.get(), "robot.urdf", static_cast<int>(urdf.size())) == 0);
    std::memcpy(files->filedata[0], urdf.data(), urdf.size());
    char error[1000] = "";
    model_ = mj_loadXML("robot.urdf", files.get(), error, sizeof(error));
    mj_deleteVFS(files.get());
    INFO(error);
    REQUIRE(model_ != nullptr);
    data_ = mj_makeData(model_);
  }
  MuJoCoRobot(const MuJoCoRobot&) = delete;
  MuJoCoRobot& operator=(const MuJoCoRobot&) = delete;
  ~MuJoCoRobot() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void set_position(const std::string& joint, double position) {
    data_->qpos[model_->jnt_qposadr[id(mjOBJ_JOINT, joint)]] = position;
  }
  void compute() {
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_crb(model_, data_);
  }
  /// Of the base and these joints: linear and angular velocity of the root link's frame first.
  Eigen::MatrixXd mass_matrix(const std::vector<std::string>& joints) const {
    Eigen::MatrixXd full(model_->nv, model_->nv);
    mj_fullM(model_, full.data(), data_->qM);
    std::vector<int> order;
    for (int k = 0; k < 6; ++k) order.push_back(model_->jnt_dofadr[0] + k);
    for (const std::string& joint : joints) {
      order.push_back(model_->jnt_dofadr[id(mjOBJ_JOINT, joint)]);
    }
    return full(order, order);
  }
  Vector3d centroid() const { return Eigen::Map<const Vector3d>(data_->subtree_com); }
  Vector3d place(const std::string& link) const {
    return Eigen::Map<const Vector3d>(data_->xpos + 3 * id(mjOBJ_BODY, link));
  }
  Matrix3d axes(const std::string& link) const {
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(data_->xmat + 9 * id(mjOBJ_BODY, link));
  }

 private:
  int id(mjtObj kind, const std::string& name) const {
    const int found = mj_name2id(model_, kind, name.c_str());
    INFO(name);
    REQUIRE(found >= 0);
    return found;
  }
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

/// Compares both readers at random postures. @return the largest relative difference
void compare(const std::string& name, const std::string& urdf, const std::string& hand) {
  const double of_inertia = has_products_of_inertia(urdf) ? kPrincipalAxes : kRounding;
  INFO(name);
  const RobotModel robot = read_urdf(urdf, name, hand);
  MuJoCoRobot other(for_mujoco(urdf, robot.base.name));
  std::vector<std::string> joints;
  for (const Joint& joint : robot.tree()) joints.push_back(joint.name);
  const Vector3d centroid = -find_link(robot, robot.base.name)->pose.position;  // of the base body
  const int n = robot.n(), bodies = robot.num_bodies();
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    JointVectord phi(n);
    for (int k = 0; k < n; ++k) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
      phi[k] = random.uniform(std::max(joint.lower, -3.0), std::min(joint.upper, 3.0));
    }
    const JointVectord all = robot.is_coupled() ? body_positions(robot, phi) : phi;
    for (int k = 0; k < bodies; ++k) {
      other.set_position(joints[static_cast<std::size_t>(k)], all[k]);
    }
    other.compute();
    // Velocities of the root link's frame and of all joints from ours.
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(6 + bodies, 6 + n);
    T.topLeftCorner(6, 6).setIdentity();
    T.block<3, 3>(0, 3) = skew<double>(centroid);  // v_root = v - omega x centroid
    T.bottomRightCorner(bodies, n) =
        robot.is_coupled() ? coupling_matrix(robot) : Eigen::MatrixXd::Identity(n, n).eval();
    const Eigen::MatrixXd theirs = T.transpose() * other.mass_matrix(joints) * T;

    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto inertia = compute_inertia(robot, kinematics);
    Eigen::MatrixXd ours(6 + n, 6 + n);
    ours << inertia.H_b, inertia.H_bphi, inertia.H_bphi.transpose(), inertia.H_phi;
    CHECK((theirs - ours).norm() <= of_inertia * ours.norm());
    const double reach = kinematics.r_bh.norm() + centroid.norm();
    CHECK((other.centroid() - centroid - inertia.r_bg).norm() <= kRounding * reach);
    CHECK((other.place(robot.hand) - centroid - kinematics.r_bh).norm() <= kRounding * reach);
    CHECK((other.axes(robot.hand) - kinematics.R_hand).norm() <= kRounding);
  }
}

/// What public files have: masses on fixed links, turned inertial frames, all kinds of joints,
/// joints that follow others with factor and offset, one of them before its master.
const char* const kMixed = R"(<robot name="mixed">
<link name="body"><inertial><origin xyz="0.1 -0.2 0.05" rpy="0.3 -0.2 0.9"/><mass value="80"/>
<inertia ixx="9" iyy="11" izz="7" ixy="0.4" ixz="-0.3" iyz="0.2"/></inertial></link>
<link name="tank"><inertial><origin xyz="0 0 0.2"/><mass value="15"/>
<inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0 0.02 0.3" rpy="0 0 1"/><mass value="6"/>
<inertia ixx="0.3" iyy="0.28" izz="0.05" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link>
<link name="slider"><inertial><origin xyz="0.2 0 0"/><mass value="4"/>
<inertia ixx="0.02" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="palm"><inertial><mass value="1.5"/>
<inertia ixx="0.01" iyy="0.012" izz="0.009" ixy="0" ixz="0.001" iyz="0"/></inertial></link>
<link name="camera"><inertial><origin rpy="0.4 0.1 0"/><mass value="0.3"/>
<inertia ixx="0.001" iyy="0.002" izz="0.0015" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="left"><inertial><origin xyz="0 0.01 0.03"/><mass value="0.1"/>
<inertia ixx="0.0002" iyy="0.0002" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="right"><inertial><origin xyz="0 -0.01 0.03"/><mass value="0.1"/>
<inertia ixx="0.0002" iyy="0.0002" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="grasp"/>
<joint name="strut" type="fixed"><parent link="body"/><child link="tank"/>
<origin xyz="-0.4 0 0.3" rpy="0 0.7 0"/></joint>
<joint name="shoulder" type="revolute"><parent link="body"/><child link="upper"/>
<origin xyz="0.5 0 0.4" rpy="-1.5707963267948966 0 0.3"/><axis xyz="0 2 1"/>
<limit lower="-2" upper="2" velocity="1" effort="50"/></joint>
<joint name="rail" type="prismatic"><parent link="upper"/><child link="slider"/>
<origin xyz="0 0 0.6" rpy="0 -0.4 0"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.5" velocity="1" effort="50"/></joint>
<joint name="wrist" type="continuous"><parent link="slider"/><child link="palm"/>
<origin xyz="0.4 0 0" rpy="0 1.5707963267948966 0"/><axis xyz="0 0 -1"/></joint>
<joint name="mast" type="fixed"><parent link="palm"/><child link="camera"/>
<origin xyz="0.05 0 0.02" rpy="0.2 0.3 0.4"/></joint>
<joint name="right_finger" type="revolute"><parent link="palm"/><child link="right"/>
<origin xyz="0 -0.04 0.05"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" velocity="1" effort="5"/>
<mimic joint="left_finger" multiplier="-0.7" offset="0.1"/></joint>
<joint name="left_finger" type="revolute"><parent link="palm"/><child link="left"/>
<origin xyz="0 0.04 0.05"/><axis xyz="1 0 0"/>
<limit lower="-0.5" upper="0.8" velocity="1" effort="5"/></joint>
<joint name="tip" type="fixed"><parent link="palm"/><child link="grasp"/>
<origin xyz="0 0 0.12" rpy="0 0 0.5"/></joint>
</robot>)";

}  // namespace

TEST_CASE("MuJoCo reads the same robots from shipped files") {
  int files = 0;
  const std::string folder = std::string(STILLBASE_SOURCE_DIR) + "/problems/robots";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".urdf") continue;
    const std::string text = read_text_file(entry.path().string());
    compare(entry.path().filename().string(), text,
            read_urdf(text, "", "", {.may_lack_hand = true}).hand);
    ++files;
  }
  CHECK(files >= 5);
}

TEST_CASE("MuJoCo reads the same robots from what was put together of parts") {
  for (const char* name : {"mounted_six_joint", "mounted_seven_joint", "mounted_two_arms"}) {
    const CaptureProblem problem = test::shipped(name);
    compare(name, problem.urdf, problem.robot.hand);
  }
}

TEST_CASE("MuJoCo reads the same robot with coupled, sliding and continuous joints") {
  compare("mixed", kMixed, "grasp");
}

#endif
