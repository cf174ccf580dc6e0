#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/export/export.hpp>

#include "report/escape.hpp"

namespace stillbase {

namespace {

/// Roll, pitch and yaw about fixed axes with R = Rz(yaw) Ry(pitch) Rx(roll). Each angle is that of
/// what the ones before leave, so the product is R to rounding also where pitch is +-90 deg.
Vector3d rpy_of(const Matrix3d& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const Matrix3d A = Eigen::AngleAxisd(-yaw, Vector3d::UnitZ()) * R;
  const double pitch = std::atan2(-A(2, 0), A(0, 0));
  const Matrix3d C = Eigen::AngleAxisd(-pitch, Vector3d::UnitY()) * A;
  return {std::atan2(C(2, 1), C(1, 1)), pitch, yaw};
}

std::string attribute(const std::string& text) { return "\"" + escape_markup(text) + "\""; }

std::string vector_text(const Vector3d& v) { return fmt::format("\"{} {} {}\"", v[0], v[1], v[2]); }

std::string origin_text(const Pose& pose) {
  return fmt::format("<origin xyz={} rpy={}/>", vector_text(pose.position),
                     vector_text(rpy_of(pose.orientation.toRotationMatrix())));
}

/// @throws InputError for a mesh
std::string geometry_text(const CollisionShape& shape) {
  struct Writer {
    const CollisionShape& shape;
    std::string operator()(const Sphere& s) const {
      return fmt::format("<sphere radius=\"{}\"/>", s.radius);
    }
    std::string operator()(const Capsule& c) const { return cylinder(c.radius, c.length); }
    std::string operator()(const Cylinder& c) const { return cylinder(c.radius, c.length); }
    std::string operator()(const Box& b) const {
      return fmt::format("<box size={}/>", vector_text(b.size));
    }
    std::string operator()(const ConvexMesh&) const {
      throw InputError({{"", 0, "mesh",
                         "a collision shape of the link '" + shape.link +
                             "' is a mesh, which URDF keeps in a file of its own"}});
    }
    static std::string cylinder(double radius, double length) {
      return fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>", radius, length);
    }
  };
  return std::visit(Writer{shape}, shape.geometry);
}

class UrdfWriter {
 public:
  explicit UrdfWriter(const RobotModel& robot) : robot_(robot) {
    for (const Joint& joint : robot.tree()) joint_names_.insert(joint.name);
    // A body that no link of a file stands for, of a robot put together in a program.
    for (int body = robot.num_bodies() - 1; body >= kBase; --body) {
      const std::string& name = body_of(body).name;
      if (find_link(robot_, name) != nullptr) continue;
      robot_.links.insert(robot_.links.begin(), {name, body, {}, ""});
    }
  }

  std::string text() {
    text_ =
        "<?xml version=\"1.0\"?>\n"
        "<!-- Units: m, rad, kg, kg m^2, N m (N), rad/s (m/s). Origins: from the frame of the\n"
        "     parent link (of the link itself inside a link), rpy about fixed axes. -->\n"
        "<robot name=" +
        attribute(robot_.name) + ">\n";
    for (const LinkFrame& link : robot_.links) write_link(link);
    for (int k = 0; k < robot_.num_bodies(); ++k) write_joint(k);
    for (const LinkFrame& link : robot_.links) {
      if (link.name != body_of(link.body).name) write_fixed_joint(link);
    }
    return text_ + "</robot>\n";
  }

 private:
  const Body& body_of(int body) const {
    return body == kBase ? robot_.base : robot_.bodies[static_cast<std::size_t>(body)];
  }
  /// Frame of the link that carries the mass, in the body frame.
  const Pose& main_frame(int body) const { return find_link(robot_, body_of(body).name)->pose; }

  void write_link(const LinkFrame& link) {
    text_ += "  <link name=" + attribute(link.name) + ">\n";
    const Pose T_link_body = link.pose.inverse();
    const Body& body = body_of(link.body);
    if (link.name == body.name) {
      const Matrix3d R = T_link_body.orientation.toRotationMatrix();
      const Matrix3d I = R * body.inertia * R.transpose();
      text_ += fmt::format(
          "    <inertial>\n      <origin xyz={}/>\n      <mass value=\"{}\"/>\n"
          "      <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n"
          "    </inertial>\n",
          vector_text(T_link_body * body.centroid), body.mass, I(0, 0), I(0, 1), I(0, 2), I(1, 1),
          I(1, 2), I(2, 2));
    }
    for (const CollisionShape& shape : robot_.shapes) {
      if (shape.link != link.name) continue;
      const bool is_capsule = std::holds_alternative<Capsule>(shape.geometry);
      text_ += fmt::format(
          "    <collision{}>\n      {}\n      <geometry>{}</geometry>\n    </collision>\n",
          is_capsule ? " name=" + attribute(link.name + "_capsule") : "",
          origin_text(T_link_body * shape.pose), geometry_text(shape));
    }
    text_ += "  </link>\n";
  }

  void write_joint(int k) {
    const Joint& joint = robot_.tree()[static_cast<std::size_t>(k)];
    // The joint frame has the joint's axis as z; the link frame stands as its file has it.
    const Pose& T_body_link = main_frame(k);
    const Pose T_parent_joint{joint.p, Eigen::Quaterniond(joint.R)};
    const Pose origin = main_frame(joint.parent).inverse() * T_parent_joint * T_body_link;
    const Vector3d axis = T_body_link.orientation.conjugate() * Vector3d::UnitZ();
    const char* type = joint.type == JointType::Prismatic    ? "prismatic"
                       : joint.type == JointType::Continuous ? "continuous"
                                                             : "revolute";
    text_ += fmt::format(
        "  <joint name={} type=\"{}\">\n    {}\n    <parent link={}/>\n    <child link={}/>\n"
        "    <axis xyz={}/>\n",
        attribute(joint.name), type, origin_text(origin), attribute(body_of(joint.parent).name),
        attribute(body_of(k).name), vector_text(axis));
    write_limits(joint);
    if (robot_.is_coupled()) write_coupling(joint, robot_.couplings[static_cast<std::size_t>(k)]);
    if (joint.viscous_friction != 0 || joint.coulomb_friction != 0) {
      text_ += fmt::format("    <dynamics damping=\"{}\" friction=\"{}\"/>\n",
                           joint.viscous_friction, joint.coulomb_friction);
    }
    text_ += "  </joint>\n";
  }

  /// A joint that follows another one.
  void write_coupling(const Joint& joint, const Coupling& coupling) {
    const std::string& leader = robot_.joints[static_cast<std::size_t>(coupling.joint)].name;
    if (leader == joint.name) return;
    text_ += fmt::format("    <mimic joint={} multiplier=\"{}\" offset=\"{}\"/>\n",
                         attribute(leader), coupling.ratio, coupling.offset);
  }

  void write_limits(const Joint& joint) {
    const bool has_ends = joint.type != JointType::Continuous;
    if (!has_ends && std::isinf(joint.max_velocity) && std::isinf(joint.max_effort)) return;
    // A limit that is none is the largest number: URDF has no other word for it.
    const auto finite = [](double x) {
      constexpr double kMost = std::numeric_limits<double>::max();
      return std::clamp(x, -kMost, kMost);
    };
    text_ += "    <limit";
    if (has_ends) {
      text_ += fmt::format(" lower=\"{}\" upper=\"{}\"", finite(joint.lower), finite(joint.upper));
    }
    text_ += fmt::format(" velocity=\"{}\" effort=\"{}\"/>\n", finite(joint.max_velocity),
                         finite(joint.max_effort));
  }

  void write_fixed_joint(const LinkFrame& link) {
    std::string name = link.name + "_fixed";
    while (!joint_names_.insert(name).second) name += '_';
    text_ += fmt::format(
        "  <joint name={} type=\"fixed\">\n    {}\n    <parent link={}/>\n    <child link={}/>\n"
        "  </joint>\n",
        attribute(name), origin_text(main_frame(link.body).inverse() * link.pose),
        attribute(body_of(link.body).name), attribute(link.name));
  }

  RobotModel robot_;
  std::set<std::string> joint_names_;
  std::string text_;
};

}  // namespace

std::string robot_urdf(const RobotModel& robot) { return UrdfWriter(robot).text(); }

}  // namespace stillbase
