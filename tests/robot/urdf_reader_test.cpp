#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "support/random_robot.hpp"

using namespace stillbase;

namespace {

// A robot in the terms of URDF: links, not bodies.
struct SourceLink {
  int parent = -1;
  std::string type;
  Vector3d xyz, rpy, axis;  // of the joint to the parent
  double mass = 0;          // 0: no <inertial>
  Vector3d inertial_xyz, inertial_rpy;
  Matrix3d inertia;
};

std::vector<SourceLink> random_source(Random& random, int count) {
  std::vector<SourceLink> links(count);
  for (int i = 0; i < count; ++i) {
    SourceLink& link = links[i];
    const double kind = random.uniform();
    link.type = kind < 0.4   ? "fixed"
                : kind < 0.6 ? "continuous"
                : kind < 0.8 ? "revolute"
                             : "prismatic";
    link.parent = i == 0 ? -1 : random.index(i);
    link.xyz = random_vector(random, 0, 1);
    link.rpy = random_vector(random, 0, 3);
    link.axis = random.index(4) == 0 ? Vector3d(0, 0, -1) : random_vector(random, 0.1, 5);
    const bool is_frame = i > 0 && link.type == "fixed" && random.index(2) == 0;
    link.mass = is_frame ? 0 : random.uniform(1, 5);
    link.inertial_xyz = random_vector(random, 0, 0.5);
    link.inertial_rpy = random_vector(random, 0, 3);
    link.inertia = random_inertia(random, link.mass, 0.5);
  }
  return links;
}

std::string text_of(const Vector3d& v) {
  std::ostringstream out;
  out.precision(17);
  out << '"' << v.x() << ' ' << v.y() << ' ' << v.z() << '"';
  return out.str();
}

std::string urdf_of(const std::vector<SourceLink>& links) {
  std::ostringstream out;
  out.precision(17);
  out << "<robot name=\"random\">\n";
  for (std::size_t i = 0; i < links.size(); ++i) {
    const SourceLink& link = links[i];
    out << "<link name=\"l" << i << "\">";
    if (link.mass > 0) {
      const Matrix3d& I = link.inertia;
      out << "<inertial><origin xyz=" << text_of(link.inertial_xyz)
          << " rpy=" << text_of(link.inertial_rpy) << "/><mass value=\"" << link.mass
          << "\"/><inertia ixx=\"" << I(0, 0) << "\" iyy=\"" << I(1, 1) << "\" izz=\"" << I(2, 2)
          << "\" ixy=\"" << I(0, 1) << "\" ixz=\"" << I(0, 2) << "\" iyz=\"" << I(1, 2)
          << "\"/></inertial>";
    }
    out << "</link>\n";
    if (i == 0) continue;
    // Names that sort against the file order: a map of joints by name would reorder them.
    out << "<joint name=\"j" << 900 - i << "\" type=\"" << link.type << "\"><parent link=\"l"
        << link.parent << "\"/><child link=\"l" << i << "\"/><origin xyz=" << text_of(link.xyz)
        << " rpy=" << text_of(link.rpy) << "/><axis xyz=" << text_of(link.axis)
        << "/><limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"1\"/></joint>\n";
  }
  out << "</robot>\n";
  return out.str();
}

Pose rpy_pose(const Vector3d& xyz, const Vector3d& rpy) {
  return {xyz, rotation_rpy(rpy.x(), rpy.y(), rpy.z())};
}

// Poses of all links by URDF's own rule, without merging or alignment of axes.
std::vector<Pose> source_poses(const std::vector<SourceLink>& links, const std::vector<double>& q) {
  std::vector<Pose> poses(links.size());
  for (std::size_t i = 1; i < links.size(); ++i) {
    const SourceLink& link = links[i];
    Pose motion;
    const Vector3d axis = link.axis.normalized();
    if (link.type == "prismatic") motion.position = q[i] * axis;
    if (link.type == "revolute" || link.type == "continuous") {
      motion.orientation = Eigen::AngleAxisd(q[i], axis);
    }
    poses[i] = poses[link.parent] * rpy_pose(link.xyz, link.rpy) * motion;
  }
  return poses;
}

// Poses of the bodies in B.
std::vector<Pose> body_poses(const RobotModel& robot, const std::vector<double>& phi) {
  std::vector<Pose> poses;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    Pose motion;
    if (joint.is_prismatic()) {
      motion.position.z() = phi[k];
    } else {
      motion.orientation = Eigen::AngleAxisd(phi[k], Vector3d::UnitZ());
    }
    const Pose parent = joint.parent == kBase ? Pose{} : poses[joint.parent];
    poses.push_back(parent * Pose{joint.p, Eigen::Quaterniond(joint.R.matrix())} * motion);
  }
  return poses;
}

// Mass, first moment and inertia about a fixed point: the same however the robot is cut up.
struct Moments {
  double mass = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  void add(double m, const Vector3d& c, const Matrix3d& R, const Matrix3d& I) {
    mass += m;
    first += m * c;
    second += R * I * R.transpose() - m * skew<double>(c) * skew<double>(c);
  }
};

const std::string kInertial =
    "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" "
    "iyz=\"0\"/></inertial>";

std::string link(const std::string& name, const std::string& more = "") {
  return "<link name=\"" + name + "\">" + kInertial + more + "</link>";
}

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& more = "", const std::string& type = "continuous") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>";
}

RobotModel read(const std::string& inside, const std::string& hand = "") {
  return read_urdf("<robot name=\"r\">" + inside + "</robot>", "r.urdf", hand);
}

}  // namespace

TEST_CASE("merged bodies have the motion and mass of the links of the file, on random trees") {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const std::vector<SourceLink> links = random_source(random, 2 + random.index(12));
    const std::string hand = fmt::format("l{}", links.size() - 1);
    const RobotModel robot = read_urdf(urdf_of(links), "random.urdf", hand);

    std::vector<double> q(links.size()), phi(robot.joints.size());
    for (std::size_t i = 1; i < links.size(); ++i) {
      q[i] = random.uniform(-2, 2);
      const int k = find_joint(robot, fmt::format("j{}", 900 - i));
      CHECK((k >= 0) == (links[i].type != "fixed"));
      if (k >= 0) phi[k] = q[i];
    }
    const std::vector<Pose> expected = source_poses(links, q);
    const std::vector<Pose> bodies = body_poses(robot, phi);
    const auto pose_in_B = [&](const LinkFrame& l) {
      return l.body == kBase ? l.pose : bodies[l.body] * l.pose;
    };
    // B is the root link's frame shifted to the base centroid.
    const Vector3d shift = robot.links[0].pose.position;
    CHECK(robot.links[0].pose.orientation.isApprox(Eigen::Quaterniond::Identity(), 0));
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Pose pose = pose_in_B(robot.links[i]);
      CHECK(robot.links[i].name == fmt::format("l{}", i));
      CHECK((pose.position - expected[i].position - shift).norm() < 1e-12);
      CHECK(pose.orientation.angularDistance(expected[i].orientation) < 1e-7);
      CHECK((pose.orientation.toRotationMatrix() - expected[i].orientation.toRotationMatrix())
                .norm() < 1e-12);
    }
    Moments of_links, of_bodies;
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (links[i].mass == 0) continue;
      const Pose pose = expected[i] * rpy_pose(links[i].inertial_xyz, links[i].inertial_rpy);
      of_links.add(links[i].mass, pose.position + shift, pose.orientation.toRotationMatrix(),
                   links[i].inertia);
    }
    of_bodies.add(robot.base.mass, robot.base.centroid, Matrix3d::Identity(), robot.base.inertia);
    for (int k = 0; k < robot.n(); ++k) {
      const Body& body = robot.bodies[k];
      of_bodies.add(body.mass, bodies[k] * body.centroid, bodies[k].orientation.toRotationMatrix(),
                    body.inertia);
    }
    CHECK(of_bodies.mass == Approx(of_links.mass).epsilon(1e-14));
    CHECK(robot.total_mass() == Approx(of_links.mass).epsilon(1e-14));
    CHECK((of_bodies.first - of_links.first).norm() < 1e-11 * of_links.mass);
    CHECK((of_bodies.second - of_links.second).norm() < 1e-11 * of_links.second.norm());
    CHECK(robot.base.centroid == Vector3d::Zero());

    for (int k = 0; k < robot.n(); ++k) {
      CHECK(robot.joints[k].parent < k);
      const Matrix3d& R = robot.joints[k].R.matrix();
      CHECK((R * R.transpose() - Matrix3d::Identity()).norm() < 1e-14);
      CHECK(R.determinant() > 0);
    }
  }
}

TEST_CASE("joints are numbered depth-first in file order") {
  const RobotModel robot =
      read(link("base") + link("a") + link("b") + link("a1") + link("a2") + link("fixed") +
               link("c") + joint("z_first", "base", "a") + joint("to_a2", "a", "a2") +
               joint("to_a1", "a", "a1") + joint("weld", "base", "fixed", "", "fixed") +
               joint("on_weld", "fixed", "c") + joint("a_last", "base", "b"),
           "a1");
  std::vector<std::string> names;
  for (const Joint& j : robot.joints) names.push_back(j.name);
  CHECK(names == std::vector<std::string>{"z_first", "to_a2", "to_a1", "on_weld", "a_last"});
  CHECK(robot.joints[2].parent == 0);
  CHECK(robot.joints[3].parent == kBase);
  CHECK(robot.base.merged_links == std::vector<std::string>{"fixed"});
  CHECK(robot.moves_hand == std::vector<bool>{true, false, true, false, false});
  CHECK(leaf_links(robot) == std::vector<std::string>{"b", "a1", "a2", "c"});
  CHECK(robot.hand == "a1");
  CHECK(robot.hand_body == 2);
}

TEST_CASE("limits, rates, efforts and friction come from the file") {
  const std::string tail = "<dynamics damping=\"0.3\" friction=\"0.2\"/>";
  const RobotModel robot = read(
      link("base") + link("a") + link("b") + link("c") +
      joint("r", "base", "a",
            "<limit lower=\"-1\" upper=\"2\" velocity=\"3\" effort=\"4\"/>" + tail, "revolute") +
      joint("p", "a", "b", "<limit lower=\"0\" upper=\"0.5\" velocity=\"0.1\" effort=\"9\"/>",
            "prismatic") +
      joint("c", "b", "c", "<limit velocity=\"7\" effort=\"8\"/>"));
  const Joint& r = robot.joints[0];
  CHECK(r.type == JointType::Revolute);
  CHECK((r.lower == -1 && r.upper == 2 && r.max_velocity == 3 && r.max_effort == 4));
  CHECK((r.viscous_friction == 0.3 && r.coulomb_friction == 0.2));
  const Joint& p = robot.joints[1];
  CHECK(p.is_prismatic());
  CHECK((p.lower == 0 && p.upper == 0.5));
  const Joint& c = robot.joints[2];
  CHECK(c.type == JointType::Continuous);
  CHECK(
      (c.lower == -kInfinity && c.upper == kInfinity && c.max_velocity == 7 && c.max_effort == 8));
  // URDF's default axis is x.
  CHECK((r.R.matrix().col(2) - Vector3d::UnitX()).norm() < 1e-15);
}

TEST_CASE("joint axes become the z axis of their body, in every direction") {
  Random random(3);
  std::vector<Vector3d> axes = {{0, 0, 1},     {0, 0, -1},     {1e-9, 0, -1},
                                {0, 1, 0},     {0, -3, 0},     {1, 1, 1e-9},
                                {1, 1, -1e-9}, {1e-200, 0, 0}, {1e50, -1e50, 0}};
  for (int i = 0; i < 20; ++i) axes.push_back(random_vector(random, 0.1, 9));
  for (const Vector3d& axis : axes) {
    const RobotModel robot = read(link("base") + link("a") +
                                  joint("j", "base", "a", "<axis xyz=" + text_of(axis) + "/>"));
    const Matrix3d& R = robot.joints[0].R.matrix();
    INFO(axis.transpose());
    CHECK((R.col(2) - axis.stableNormalized()).norm() < 1e-15);
    CHECK((R * R.transpose() - Matrix3d::Identity()).norm() < 1e-14);
    CHECK(R.determinant() == Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("right angles of a file are exact, other angles stay as they are") {
  const auto joint_at = [](const Vector3d& rpy, const Vector3d& axis) {
    return read(link("base") + link("a") +
                joint("j", "base", "a",
                      "<origin rpy=" + text_of(rpy) + "/><axis xyz=" + text_of(axis) + "/>"))
        .joints[0];
  };
  const double right = 1.5707963267948966;
  for (int trial = 0; trial < 64; ++trial) {
    const Vector3d rpy(right * (trial % 4), right * (trial / 4 % 4), right * (trial / 16));
    INFO(rpy.transpose());
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(0, -1, 0), Vector3d(2, 0, 0)}) {
      const Joint j = joint_at(rpy, axis);
      const Matrix3d& R = j.R.matrix();
      CHECK(j.R.are_permuted());
      CHECK((R * R.transpose()) == Matrix3d::Identity());
      const Matrix3d stated = rotation_rpy(rpy.x(), rpy.y(), rpy.z()).toRotationMatrix();
      CHECK((R.col(2) - stated * axis.normalized()).norm() < 1e-15);
    }
    const double off = 1e-14 * (1 + trial);
    const Joint j = joint_at(rpy + Vector3d(off, 0, 0), {0, 0, 1});
    CHECK(!j.R.are_permuted());
    const Matrix3d stated = rotation_rpy(rpy.x() + off, rpy.y(), rpy.z()).toRotationMatrix();
    CHECK((j.R.matrix() - stated).norm() < 3e-15);
  }
}

TEST_CASE("collision shapes are placed on their bodies and capsules are recognised by their name") {
  const auto collision = [](const std::string& name, const std::string& shape) {
    return "<collision" + (name.empty() ? "" : " name=\"" + name + "\"") +
           "><origin xyz=\"0 0 1\"/><geometry>" + shape + "</geometry></collision>";
  };
  const std::string cylinder = "<cylinder radius=\"0.1\" length=\"2\"/>";
  const RobotModel robot =
      read(link("base", collision("", "<box size=\"1 2 3\"/>")) +
           link("arm", collision("arm_capsule", cylinder) + collision("arm_capsule_2", cylinder) +
                           collision("", "<sphere radius=\"0.4\"/>")) +
           link("tool", collision("_capsule", cylinder)) +
           joint("j", "base", "arm", "<axis xyz=\"0 0 1\"/>") +
           joint("f", "arm", "tool", "<origin xyz=\"5 0 0\"/>", "fixed"));
  REQUIRE(robot.shapes.size() == 5);
  CHECK(std::get<Box>(robot.shapes[0].geometry).size == Vector3d(1, 2, 3));
  CHECK(robot.shapes[0].body == kBase);
  CHECK(std::get<Capsule>(robot.shapes[1].geometry).length == 2);
  CHECK(std::get<Capsule>(robot.shapes[1].geometry).radius == 0.1);
  CHECK(std::holds_alternative<Cylinder>(robot.shapes[2].geometry));
  CHECK(std::get<Sphere>(robot.shapes[3].geometry).radius == 0.4);
  CHECK(std::holds_alternative<Capsule>(robot.shapes[4].geometry));
  CHECK(robot.shapes[4].link == "tool");
  CHECK(robot.shapes[4].body == 0);
  CHECK((robot.shapes[4].pose.position - Vector3d(5, 0, 1)).norm() < 1e-15);
}

TEST_CASE("elements without mechanics are accepted and change nothing") {
  const std::string visual =
      "<visual><origin xyz=\"0 0 0\"/><geometry><mesh "
      "filename=\"package://a/b.stl\"/></geometry></visual>";
  const RobotModel robot =
      read("<!-- a comment --><material name=\"grey\"><color rgba=\"1 1 1 1\"/></material>" +
           link("base", visual) + "<gazebo/><transmission name=\"t\"/>");
  CHECK(robot.n() == 0);
  CHECK(robot.total_mass() == 1);
  CHECK(robot.hand == "base");
}

TEST_CASE("another hand can be chosen, and only a link can be the hand") {
  const RobotModel robot = read(link("base") + link("a") + link("b") + joint("j", "base", "a") +
                                joint("k", "a", "b", "<origin xyz=\"0 1 0\"/>"));
  CHECK(robot.hand == "b");
  const RobotModel other = with_hand(robot, "a");
  CHECK(other.hand_body == 0);
  CHECK(other.moves_hand == std::vector<bool>{true, false});
  CHECK(with_hand(robot, "base").moves_hand == std::vector<bool>{false, false});
  CHECK_THROWS_AS(with_hand(robot, "c"), std::invalid_argument);
  CHECK(find_joint(robot, "k") == 1);
  CHECK(find_joint(robot, "m") == -1);
  CHECK(find_link(robot, "a")->body == 0);
  CHECK(find_link(robot, "c") == nullptr);
}
