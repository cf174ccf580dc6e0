// <link> of a URDF file: inertia and collision shapes.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/robot/physical_checks.hpp>

#include "robot/urdf_element.hpp"

namespace stillbase::urdf {

namespace {

Inertial read_inertial(Element& element) {
  Inertial inertial;
  inertial.origin = read_origin(element);
  bool has_mass = false, has_inertia = false;
  element.each("mass", 0, 1, [&](Element& mass) {
    has_mass = true;
    inertial.mass = mass.number("value", Sign::NonNegative);
  });
  element.each("inertia", 0, 1, [&](Element& inertia) {
    has_inertia = true;
    const auto entry = [&](const char* name) {
      if (!inertia.has(name)) {
        inertia.remark("inertia", fmt::format("<inertia> without {}: it is 0", name));
      }
      inertial.rounding += inertia.rounding(name);
      return inertia.number(name, Sign::Any, 0);
    };
    const double xx = entry("ixx"), yy = entry("iyy"), zz = entry("izz");
    const double xy = entry("ixy"), xz = entry("ixz"), yz = entry("iyz");
    inertial.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  });
  for (const char* name : {"mass", "inertia"}) {
    if (std::string_view(name) == "mass" ? has_mass : has_inertia) continue;
    element.remark("missing-element", fmt::format("<inertial> without <{}>: it is 0", name));
  }
  if (inertial.mass == 0 && !inertial.inertia.isZero(0)) {
    element.remark("massless", "<inertial> of mass 0 has an inertia tensor, which counts");
  }
  return inertial;
}

/// A shape of which a size is not above zero, or not known, is left out.
bool has_sizes(Element& shape, std::initializer_list<double> sizes) {
  const double least = std::min(sizes);
  if (least < 0) {
    shape.find("out-of-range", shape.tag() + ": a size is negative");
  } else if (least == 0) {
    shape.find("no-shape", shape.tag() + " of size zero");
  }
  return std::all_of(sizes.begin(), sizes.end(), [](double size) { return size > 0; });
}

/// A hull that a written file gives beside a mesh, one or several: 3 coordinates per vertex, 3
/// corners per face.
ConvexMesh read_hull(Element& element) {
  ConvexMesh hull;
  const std::vector<double> coordinates = element.numbers("vertices");
  const std::vector<double> corners = element.numbers("faces");
  for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3) {
    hull.vertices.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
  }
  const auto is_vertex = [&](double x) {
    return x >= 0 && x < static_cast<double>(hull.vertices.size()) && x == std::floor(x);
  };
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    std::vector<int> face;
    for (std::size_t c = i; c < i + 3; ++c) {
      face.push_back(is_vertex(corners[c]) ? static_cast<int>(corners[c]) : -1);
    }
    hull.faces.push_back(std::move(face));
  }
  std::string fault = convex_mesh_fault(hull);
  if (coordinates.size() % 3 != 0 || corners.size() % 3 != 0) {
    fault = "vertices and faces must be lists of three numbers each";
  }
  if (!fault.empty()) element.find("not-convex", "<hull>: " + fault);
  return hull;
}

/// Reads one <geometry>; a cylinder whose <collision> has a name that ends in "_capsule" is a
/// capsule.
void read_geometry(Element& element, const Pose& pose, bool is_capsule, TreeLink& link) {
  int count = 0;
  const auto each = [&](const char* kind, auto read) {
    element.each(kind, 0, kAny, [&](Element& shape) {
      ++count;
      shape.only_remark();
      read(shape);
    });
  };
  const auto add = [&](const Geometry& geometry) { link.shapes.emplace_back(pose, geometry); };
  each("sphere", [&](Element& sphere) {
    const double radius = sphere.number("radius", Sign::Any);
    if (has_sizes(sphere, {radius})) add(Sphere{radius});
  });
  each("box", [&](Element& box) {
    const Vector3d size = box.vector("size", Sign::Any);
    if (has_sizes(box, {size.x(), size.y(), size.z()})) add(Box{size});
  });
  for (const char* kind : {"cylinder", "capsule"}) {
    each(kind, [&](Element& shape) {
      const double radius = shape.number("radius", Sign::Any);
      const double length = shape.number("length", Sign::Any);
      if (std::string_view(kind) == "capsule" && length == 0 && radius > 0) {
        add(Sphere{radius});
        return;
      }
      if (!has_sizes(shape, {radius, length})) return;
      if (is_capsule || std::string_view(kind) == "capsule") {
        add(Capsule{radius, length});
      } else {
        add(Cylinder{radius, length});
      }
    });
  }
  each("mesh", [&](Element& mesh) {
    const std::string file = mesh.path("filename");
    const Vector3d scale = mesh.scale("scale");
    if (file.empty()) mesh.find("no-shape", "<mesh> of no file");
    if (file.empty() || !scale.allFinite()) return;
    link.meshes.push_back({mesh.line(), pose, file, scale, {}});
  });
  element.each("hull", 0, kAny, [&](Element& hull) {
    ConvexMesh mesh = read_hull(hull);
    if (count == 1 && !link.meshes.empty()) {
      link.meshes.back().hulls.push_back(std::move(mesh));
    } else {
      hull.find("geometry", "<hull> stands beside the <mesh> that it encloses");
    }
  });
  if (count == 0)
    element.remark("no-shape", "<collision> without a shape that is known", link.name);
  if (count > 1) element.remark("geometry", "<geometry> with several shapes: all are read");
}

/// quat_xyzw, an orientation that newer files state in place of rpy.
Eigen::Quaterniond read_quaternion(Element& origin) {
  const std::vector<double> q = origin.numbers("quat_xyzw");
  if (origin.has("rpy")) origin.find("orientation", "<origin> states both rpy and quat_xyzw");
  const double norm = q.size() == 4 ? Eigen::Map<const Eigen::Vector4d>(q.data()).norm() : 0;
  if (!(std::abs(norm - 1) <= 1e-3)) {
    origin.find("orientation", "<origin> quat_xyzw must be four numbers x y z w of norm 1");
    return Eigen::Quaterniond::Identity();
  }
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
}

}  // namespace

Pose read_origin(Element& parent) {
  Pose pose;
  parent.each("origin", 0, 1, [&](Element& origin) {
    pose.position = origin.vector("xyz", Sign::Any, Vector3d::Zero());
    if (origin.has("quat_xyzw")) {
      pose.orientation = read_quaternion(origin);
      return;
    }
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
    bool has_geometry = false;
    collision.each("geometry", 0, kAny, [&](Element& geometry) {
      if (has_geometry)
        geometry.remark("geometry", "<collision> with several <geometry>: all are read");
      has_geometry = true;
      read_geometry(geometry, origin, is_capsule, link);
    });
    if (!has_geometry) {
      collision.remark("no-shape", "<collision> without a shape that is known", link.name);
    }
    collision.ignore({"material", "verbose"});
  });
  element.ignore({"visual"});
  return link;
}

std::optional<Vector3d> read_color(Element& material) {
  std::optional<Vector3d> color;
  material.each("color", 0, 1, [&](Element& element) {
    const std::vector<double> rgba = element.numbers("rgba");
    if (rgba.size() < 3) return;
    color = Vector3d(rgba[0], rgba[1], rgba[2]).cwiseMax(0).cwiseMin(1);
  });
  return color;
}

std::vector<VisualPart> read_visuals(Element& link, MaterialColors& colors) {
  std::vector<VisualPart> parts;
  link.each("visual", 0, kAny, [&](Element& visual) {
    TreeLink drawn;
    const Pose origin = read_origin(visual);
    visual.each("geometry", 0, 1,
                [&](Element& geometry) { read_geometry(geometry, origin, false, drawn); });
    std::optional<Vector3d> color;
    visual.each("material", 0, 1, [&](Element& material) {
      const std::string name = material.text("name", false);
      color = read_color(material);
      if (color) {
        colors.try_emplace(name, *color);
      } else if (const auto known = colors.find(name); known != colors.end()) {
        color = known->second;
      }
    });
    for (auto& shape : drawn.shapes) parts.push_back({std::move(shape), std::nullopt, color});
    for (MeshUse& mesh : drawn.meshes) parts.push_back({std::nullopt, std::move(mesh), color});
  });
  return parts;
}

}  // namespace stillbase::urdf
