// A tree of links and joints as URDF text.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/escape.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase::urdf {

namespace {

std::string triple(const Vector3d& v) { return fmt::format("{} {} {}", v[0], v[1], v[2]); }

/// Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll), to rounding also where pitch is a right
/// angle: roll follows from the yaw that was chosen.
Vector3d rpy_of(const Matrix3d& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double pitch = std::atan2(-R(2, 0), c * R(0, 0) + s * R(1, 0));
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

/// <origin>, or nothing where it is the identity.
std::string origin(const Pose& pose) {
  const Matrix3d R = pose.orientation.toRotationMatrix();
  const bool turns = !R.isIdentity(0);
  if (!turns && pose.position.isZero(0)) return "";
  std::string text = fmt::format("<origin xyz=\"{}\"", triple(pose.position));
  if (turns) text += fmt::format(" rpy=\"{}\"", triple(rpy_of(R)));
  return text + "/>";
}

struct GeometryText {
  std::string operator()(const Sphere& s) const {
    return fmt::format("<sphere radius=\"{}\"/>", s.radius);
  }
  std::string operator()(const Capsule& c) const { return cylinder(c.radius, c.length); }
  std::string operator()(const Cylinder& c) const { return cylinder(c.radius, c.length); }
  std::string operator()(const Box& b) const {
    return fmt::format("<box size=\"{}\"/>", triple(b.size));
  }
  std::string operator()(const ConvexMesh& m) const {
    std::string text = "<hull vertices=\"";
    for (std::size_t i = 0; i < m.vertices.size(); ++i) {
      text += (i > 0 ? " " : "") + triple(m.vertices[i]);
    }
    text += "\" faces=\"";
    bool is_first = true;
    for (const std::vector<int>& face : m.faces) {
      for (std::size_t c = 2; c < face.size(); ++c) {  // a fan of triangles
        text += fmt::format("{}{} {} {}", is_first ? "" : " ", face[0], face[c - 1], face[c]);
        is_first = false;
      }
    }
    return text + "\"/>";
  }
  static std::string cylinder(double radius, double length) {
    return fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>", radius, length);
  }
};

/// @param name empty: none
std::string collision(const std::string& name, const Pose& pose, const std::string& geometry) {
  const std::string named = name.empty() ? "" : fmt::format(" name=\"{}\"", escape_markup(name));
  return fmt::format("    <collision{}>{}<geometry>{}</geometry></collision>\n", named,
                     origin(pose), geometry);
}

std::string link_text(const TreeLink& link) {
  std::string inside;
  if (link.inertial) {
    const Matrix3d& I = link.inertial->inertia;
    inside += fmt::format(
        "    <inertial>{}<mass value=\"{}\"/>"
        "<inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/></inertial>\n",
        origin(link.inertial->origin), link.inertial->mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1),
        I(0, 2), I(1, 2));
  }
  for (const auto& [pose, geometry] : link.shapes) {
    // URDF has no capsule: the reader knows one by the name of its <collision>.
    const bool is_capsule = std::holds_alternative<Capsule>(geometry);
    inside += collision(is_capsule ? link.name + "_capsule" : "", pose,
                        std::visit(GeometryText{}, geometry));
  }
  for (const MeshUse& mesh : link.meshes) {
    const std::string scale =
        mesh.scale == Vector3d::Ones() ? "" : fmt::format(" scale=\"{}\"", triple(mesh.scale));
    std::string hulls;
    for (const ConvexMesh& hull : mesh.hulls) hulls += GeometryText{}(hull);
    inside += collision(
        "", mesh.pose,
        fmt::format("<mesh filename=\"{}\"{}/>{}", escape_markup(mesh.file), scale, hulls));
  }
  const std::string name = escape_markup(link.name);
  if (inside.empty()) return fmt::format("  <link name=\"{}\"/>\n", name);
  return fmt::format("  <link name=\"{}\">\n{}  </link>\n", name, inside);
}

std::string joint_text(const TreeJoint& source) {
  const Joint& joint = source.joint;
  const bool has_ends = std::isfinite(joint.lower) || std::isfinite(joint.upper);
  const bool is_continuous =
      joint.type == JointType::Continuous || (!joint.is_prismatic() && !has_ends);
  const char* const type = source.is_fixed        ? "fixed"
                           : joint.is_prismatic() ? "prismatic"
                           : is_continuous        ? "continuous"
                                                  : "revolute";
  std::string inside = fmt::format("    <parent link=\"{}\"/><child link=\"{}\"/>{}\n",
                                   escape_markup(source.parent_name),
                                   escape_markup(source.child_name), origin(source.origin));
  if (!source.is_fixed) {
    inside += fmt::format("    <axis xyz=\"{}\"/>\n", triple(source.axis));
    std::string limit;
    // URDF has no word for a limit that does not exist.
    const auto bound = [](double x) { return std::clamp(x, -kLargestNumber, kLargestNumber); };
    if (!is_continuous) {
      limit += fmt::format(" lower=\"{}\" upper=\"{}\"", bound(joint.lower), bound(joint.upper));
    }
    // Of a continuous joint a bound that is not stated is none only where both are missing.
    if (!is_continuous || std::isfinite(joint.max_velocity) || std::isfinite(joint.max_effort)) {
      limit += fmt::format(" velocity=\"{}\" effort=\"{}\"", bound(joint.max_velocity),
                           bound(joint.max_effort));
    }
    if (!limit.empty()) inside += fmt::format("    <limit{}/>\n", limit);
    if (joint.viscous_friction != 0 || joint.coulomb_friction != 0) {
      inside += fmt::format("    <dynamics damping=\"{}\" friction=\"{}\"/>\n",
                            joint.viscous_friction, joint.coulomb_friction);
    }
    if (source.mimic) {
      inside += fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>\n",
                            escape_markup(source.mimic->master), source.mimic->ratio,
                            source.mimic->offset);
    }
  }
  return fmt::format("  <joint name=\"{}\" type=\"{}\">\n{}  </joint>\n", escape_markup(joint.name),
                     type, inside);
}

bool is_driven(const TreeJoint& source) {
  return !source.is_fixed && source.joint.rotor_inertia != 0;
}

/// URDF has no word for a rotor: it is that of Drake.
std::string transmission_text(const TreeJoint& source) {
  const std::string name = escape_markup(source.joint.name);
  return fmt::format(
      "  <transmission name=\"{0}_drive\">\n"
      "    <type>transmission_interface/SimpleTransmission</type>\n"
      "    <joint name=\"{0}\"/>\n"
      "    <actuator name=\"{0}_motor\"><drake:rotor_inertia value=\"{1}\"/>"
      "<drake:gear_ratio value=\"{2}\"/></actuator>\n"
      "  </transmission>\n",
      name, source.joint.rotor_inertia, source.joint.gear_ratio);
}

}  // namespace

std::string urdf_text(const Tree& tree) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<!-- Units: m, rad, kg, kg m^2, N m (N), rad/s (m/s). Origins: from the frame of the\n"
      "     parent link (of the link itself inside a link), rpy about fixed axes. -->\n"
      "<robot name=\"{}\"{}>\n",
      escape_markup(tree.name),
      std::any_of(tree.joints.begin(), tree.joints.end(), is_driven)
          ? " xmlns:drake=\"http://drake.mit.edu\""
          : "");
  for (const TreeLink& link : tree.links) text += link_text(link);
  for (const TreeJoint& joint : tree.joints) text += joint_text(joint);
  for (const TreeJoint& joint : tree.joints) {
    if (is_driven(joint)) text += transmission_text(joint);
  }
  return text + "</robot>\n";
}

}  // namespace stillbase::urdf
