#include "robot/urdf_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

namespace stillbase::urdf {

namespace {

// Plans carry the robot's text inside JSON.
void check_text(std::string_view text, Findings& findings) {
  if (text.size() > kMaxUrdfBytes) {
    findings.add(0, "too-large", fmt::format("{} bytes, at most {}", text.size(), kMaxUrdfBytes));
    return;
  }
  const std::size_t bad = first_bad_byte(text);
  if (bad == std::string_view::npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(bad), '\n');
  findings.add(static_cast<int>(line), "not-text",
               fmt::format("byte 0x{:02x} is not allowed; the text must be UTF-8",
                           static_cast<unsigned char>(text[bad])));
}

bool climbs_out(std::string_view path) {
  while (!path.empty()) {
    const std::size_t end = std::min(path.find_first_of("/\\"), path.size());
    if (path.substr(0, end) == "..") return true;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return false;
}

// What is dangerous anywhere, also in elements that are ignored.
void check_everywhere(const tinyxml2::XMLNode& node, int depth, Findings& findings) {
  if (depth > kMaxUrdfDepth) {
    findings.add(node.GetLineNum(), "too-deep",
                 fmt::format("elements are nested more than {} deep", kMaxUrdfDepth));
    return;
  }
  for (const auto* n = node.FirstChild(); n != nullptr; n = n->NextSibling()) {
    if (n->ToUnknown() != nullptr) {
      findings.add(n->GetLineNum(), "doctype",
                   "document types and entity definitions are not allowed");
    }
    const auto* element = n->ToElement();
    if (element == nullptr) continue;
    const char* filename = element->Attribute("filename");
    if (filename != nullptr && climbs_out(filename)) {
      findings.add(n->GetLineNum(), "mesh-path",
                   fmt::format("the path {} leaves the robot's folder", quoted(filename)));
    }
    check_everywhere(*element, depth + 1, findings);
  }
}

/// The pose of <origin>: fixed axes roll, pitch, yaw.
Pose read_origin(Element& parent) {
  Pose pose;
  parent.each("origin", 0, 1, [&](Element& origin) {
    pose.position = origin.vector("xyz", Sign::Any, Vector3d::Zero());
    const Vector3d rpy = origin.vector("rpy", Sign::Any, Vector3d::Zero());
    Vector3d c, s;
    for (int i = 0; i < 3; ++i) {
      c[i] = std::cos(rpy[i] / 2);
      s[i] = std::sin(rpy[i] / 2);
    }
    const double x = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
    const double y = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
    const double z = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
    const double w = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
    const double norm = std::sqrt(x * x + y * y + z * z + w * w);
    pose.orientation = Eigen::Quaterniond(w / norm, x / norm, y / norm, z / norm).normalized();
  });
  return pose;
}

Inertial read_inertial(Element& element) {
  Inertial inertial;
  inertial.origin = read_origin(element);
  element.each("mass", 1, 1,
               [&](Element& mass) { inertial.mass = mass.number("value", Sign::NonNegative); });
  element.each("inertia", 1, 1, [&](Element& inertia) {
    const auto entry = [&](const char* name) { return inertia.number(name, Sign::Any); };
    const double xx = entry("ixx"), yy = entry("iyy"), zz = entry("izz");
    const double xy = entry("ixy"), xz = entry("ixz"), yz = entry("iyz");
    inertial.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  });
  return inertial;
}

/// A cylinder whose <collision> has a name that ends in "_capsule" is a capsule.
Geometry read_geometry(Element& element, bool is_capsule) {
  Geometry geometry;
  element.each("sphere", 0, 1, [&](Element& sphere) {
    geometry = Sphere{sphere.number("radius", Sign::Positive)};
  });
  element.each("box", 0, 1,
               [&](Element& box) { geometry = Box{box.vector("size", Sign::Positive)}; });
  element.each("cylinder", 0, 1, [&](Element& cylinder) {
    const double radius = cylinder.number("radius", Sign::Positive);
    const double length = cylinder.number("length", Sign::Positive);
    geometry = is_capsule ? Geometry(Capsule{radius, length}) : Geometry(Cylinder{radius, length});
  });
  if (element.size() != 1) {
    element.find("geometry",
                 fmt::format("<geometry> holds {} shapes, must be one", element.size()));
  }
  return geometry;
}

TreeLink read_link(Element& element) {
  TreeLink link;
  link.line = element.line();
  link.name = element.text("name", true);
  element.text("type", false);
  element.each("inertial", 0, 1,
               [&](Element& inertial) { link.inertial = read_inertial(inertial); });
  element.each("collision", 0, kAny, [&](Element& collision) {
    const bool is_capsule = std::string_view(collision.text("name", false)).ends_with("_capsule");
    collision.text("group", false);
    const Pose origin = read_origin(collision);
    collision.each("geometry", 1, 1, [&](Element& geometry) {
      link.shapes.emplace_back(origin, read_geometry(geometry, is_capsule));
    });
    collision.ignore({"material", "verbose"});
  });
  element.ignore({"visual", "contact", "sensor", "gazebo"});
  return link;
}

TreeJoint read_joint(Element& element) {
  TreeJoint out;
  Joint& joint = out.joint;
  out.line = element.line();
  joint.name = element.text("name", true);
  const std::string type = element.text("type", true);
  const bool is_limited = type == "revolute" || type == "prismatic";
  out.is_fixed = type == "fixed";
  joint.type = type == "prismatic"    ? JointType::Prismatic
               : type == "continuous" ? JointType::Continuous
                                      : JointType::Revolute;
  if (!is_limited && !out.is_fixed && type != "continuous" && !type.empty()) {
    const bool several = type == "floating" || type == "planar";
    element.find("joint-type",
                 fmt::format("joint {} is {}: {}; allowed: revolute continuous prismatic fixed",
                             quoted(joint.name), quoted(type),
                             several ? "joints of several degrees of freedom are not supported"
                                     : "no such type"));
  }
  out.origin = read_origin(element);
  element.each("parent", 1, 1, [&](Element& e) { out.parent_name = e.text("link", true); });
  element.each("child", 1, 1, [&](Element& e) { out.child_name = e.text("link", true); });
  element.each("axis", 0, 1, [&](Element& axis) {
    out.axis = axis.vector("xyz", Sign::Any);
    if (out.axis.isZero(0)) axis.find("joint-axis", "<axis> xyz has no direction");
  });
  const auto need_limits = [&](Element& where) {
    where.find("joint-limits", fmt::format("joint {} is {} and needs <limit> with lower and upper",
                                           quoted(joint.name), type));
  };
  bool has_limit = false;
  element.each("limit", 0, 1, [&](Element& limit) {
    has_limit = true;
    const double lower = limit.number("lower", Sign::Any, 0);
    const double upper = limit.number("upper", Sign::Any, 0);
    joint.max_velocity = limit.number("velocity", Sign::NonNegative);
    joint.max_effort = limit.number("effort", Sign::NonNegative);
    if (!is_limited) return;
    joint.lower = lower;
    joint.upper = upper;
    if (!limit.has("lower") || !limit.has("upper")) {
      need_limits(limit);
    } else if (lower > upper) {
      limit.find("joint-limits", fmt::format("joint {}: lower {} is above upper {}",
                                             quoted(joint.name), lower, upper));
    }
  });
  if (is_limited && !has_limit) need_limits(element);
  element.each("dynamics", 0, 1, [&](Element& dynamics) {
    joint.viscous_friction = dynamics.number("damping", Sign::NonNegative, 0);
    joint.coulomb_friction = dynamics.number("friction", Sign::NonNegative, 0);
  });
  element.ignore({"calibration", "safety_controller"});
  return out;
}

/// The links and joints of a text, or every finding about its form.
Tree read_document(std::string_view text, Findings& findings) {
  tinyxml2::XMLDocument document;
  check_text(text, findings);
  findings.raise();
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    findings.add(document.ErrorLineNum(), deep ? "too-deep" : "xml",
                 deep ? fmt::format("elements are nested more than {} deep", kMaxUrdfDepth)
                      : fmt::format("not well-formed XML ({})", document.ErrorName()));
    findings.raise();
  }
  check_everywhere(document, 0, findings);
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot") {
    findings.add(root != nullptr ? root->GetLineNum() : 0, "xml",
                 "the outermost element must be <robot>");
  } else if (root->NextSiblingElement() != nullptr) {
    findings.add(root->NextSiblingElement()->GetLineNum(), "xml",
                 "there is an element after </robot>");
  }
  findings.raise();
  Tree tree;
  Element robot(*root, findings);
  tree.name = robot.text("name", true);
  if (robot.text("version", false) != "1.0" && robot.has("version")) {
    robot.find("version", "<robot> version: must be 1.0");
  }
  int movable = 0;
  robot.each("link", 1, kAny, [&](Element& link) {
    tree.links.push_back(read_link(link));
    if (tree.links.size() == kMaxUrdfLinks + 1) {
      link.find("too-many-links", fmt::format("at most {}", kMaxUrdfLinks));
    }
  });
  robot.each("joint", 0, kAny, [&](Element& joint) {
    tree.joints.push_back(read_joint(joint));
    if (!tree.joints.back().is_fixed) ++movable;
  });
  robot.ignore({"material", "transmission", "gazebo", "sensor"});
  robot.finish();
  if (movable > kMaxJoints) {
    robot.find("too-many-joints",
               fmt::format("{} movable joints, at most {}", movable, kMaxJoints));
  }
  findings.raise();
  return tree;
}

/// Finds how links and joints hang together; every name once, every link with one parent.
void connect(Tree& tree, Findings& findings) {
  std::map<std::string, int> index, joint_names;
  const auto add_name = [&](std::map<std::string, int>& names, const char* kind,
                            const std::string& name, int line, int i) {
    if (names.emplace(name, i).second) return;
    findings.add(line, "duplicate-name",
                 fmt::format("there is already a {} {}", kind, quoted(name)));
  };
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    add_name(index, "link", tree.links[i].name, tree.links[i].line, static_cast<int>(i));
  }
  for (int j = 0; j < static_cast<int>(tree.joints.size()); ++j) {
    TreeJoint& joint = tree.joints[j];
    add_name(joint_names, "joint", joint.joint.name, joint.line, j);
    const auto link_of = [&](const std::string& link) {
      const auto found = index.find(link);
      if (found != index.end()) return found->second;
      findings.add(
          joint.line, "unknown-link",
          fmt::format("joint {}: there is no link {}", quoted(joint.joint.name), quoted(link)));
      return -1;
    };
    joint.parent = link_of(joint.parent_name);
    joint.child = link_of(joint.child_name);
    if (joint.parent < 0 || joint.child < 0) continue;
    tree.links[joint.parent].child_joints.push_back(j);
    int& parent_joint = tree.links[joint.child].parent_joint;
    if (parent_joint >= 0) {
      findings.add(joint.line, "two-parents",
                   fmt::format("link {} is already the child of joint {}", quoted(joint.child_name),
                               quoted(tree.joints[parent_joint].joint.name)));
    }
    parent_joint = j;
  }
  findings.raise();
}

/// Finds the root. Every link has at most one parent here, so a link that no root reaches hangs on
/// a cycle.
void find_root(Tree& tree, Findings& findings) {
  std::vector<int> open;
  std::vector<bool> reached(tree.links.size(), false);
  for (int i = 0; i < static_cast<int>(tree.links.size()); ++i) {
    const TreeLink& link = tree.links[i];
    if (link.parent_joint >= 0) continue;
    open.push_back(i);
    if (tree.root < 0) {
      tree.root = i;
    } else {
      findings.add(link.line, "two-roots",
                   fmt::format("links {} and {} both have no parent: one robot has one base",
                               quoted(tree.links[tree.root].name), quoted(link.name)));
    }
  }
  while (!open.empty()) {
    const int i = open.back();
    open.pop_back();
    reached[i] = true;
    for (const int joint : tree.links[i].child_joints) open.push_back(tree.joints[joint].child);
  }
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (reached[i]) continue;
    findings.add(tree.links[i].line, "cycle",
                 fmt::format("link {} is not connected to the base: its joints form a cycle",
                             quoted(tree.links[i].name)));
  }
  findings.raise();
}

}  // namespace

Tree read_tree(std::string_view text, Findings& findings) {
  Tree tree = read_document(text, findings);
  connect(tree, findings);
  find_root(tree, findings);
  return tree;
}

}  // namespace stillbase::urdf
