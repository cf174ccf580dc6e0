#include "io/target_reader.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Dense>

#include <stillbase/robot/physical_checks.hpp>

namespace stillbase::io {

namespace {

/// Every vertex lies on or below the plane of every face, and every face is a polygon of the mesh.
void check_mesh(ReadContext& context, int line, const std::string& path, const ConvexMesh& mesh) {
  const auto refuse = [&](const std::string& what) {
    context.add(line, "not-convex", fmt::format("{}: {}", path, what));
  };
  const int vertices = static_cast<int>(mesh.vertices.size());
  if (vertices < 4 || mesh.faces.size() < 4) {
    return refuse("a convex mesh needs at least 4 vertices and 4 faces");
  }
  double size = 0;
  for (const Vector3d& v : mesh.vertices) size = std::max(size, (v - mesh.vertices[0]).norm());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::vector<int>& face = mesh.faces[f];
    if (face.size() < 3) return refuse(fmt::format("face {} has fewer than 3 corners", f));
    for (const int corner : face) {
      if (corner < 0 || corner >= vertices) {
        return refuse(fmt::format("face {} names vertex {}; there are {}", f, corner, vertices));
      }
    }
    const Vector3d& origin = mesh.vertices[face[0]];
    const Vector3d normal =
        (mesh.vertices[face[1]] - origin).cross(mesh.vertices[face[2]] - origin).normalized();
    for (const Vector3d& v : mesh.vertices) {
      if (!(normal.dot(v - origin) <= 1e-6 * size)) {
        return refuse(
            fmt::format("a vertex lies outside of face {} (corners counter-clockwise "
                        "seen from outside?)",
                        f));
      }
    }
  }
}

std::optional<ConvexMesh> read_mesh(ReadContext& context, const Node& node,
                                    const std::string& path) {
  const std::size_t before = context.findings.size();
  ConvexMesh mesh;
  MapReader map(context, node, path);
  const Node* vertices = map.child("vertices", Need::Required);
  const Node* faces = map.child("faces", Need::Required);
  map.finish();
  for (const Node* list : {vertices, faces}) {
    if (list != nullptr && list->kind != Node::Kind::Sequence) {
      context.add(list->line, "wrong-type", fmt::format("{}: must be a list of lists", path));
    }
  }
  if (context.findings.size() != before) return std::nullopt;
  for (std::size_t i = 0; i < vertices->items.size(); ++i) {
    const auto point = read_vector3(context, vertices->items[i],
                                    fmt::format("{}.vertices[{}]", path, i), Dimension::Length);
    if (point) mesh.vertices.push_back(*point);
  }
  for (std::size_t i = 0; i < faces->items.size(); ++i) {
    const std::string face_path = fmt::format("{}.faces[{}]", path, i);
    const auto corners =
        read_numbers(context, faces->items[i], face_path, Dimension::None, -1, Range{0, 1e6});
    if (!corners) continue;
    std::vector<int> face;
    for (const double corner : *corners) {
      if (corner != std::floor(corner)) {
        context.add(faces->items[i].line, "wrong-type",
                    fmt::format("{}: {} is not an integer", face_path, corner));
      }
      face.push_back(static_cast<int>(corner));
    }
    mesh.faces.push_back(std::move(face));
  }
  if (context.findings.size() == before) check_mesh(context, node.line, path, mesh);
  if (context.findings.size() != before) return std::nullopt;
  return mesh;
}

Matrix3d read_inertia(ReadContext& context, const Node& node, const std::string& path) {
  MapReader map(context, node, path);
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  const std::size_t before = context.findings.size();
  map.number("ixx", xx, Dimension::Inertia, kAny, Need::Required);
  map.number("iyy", yy, Dimension::Inertia, kAny, Need::Required);
  map.number("izz", zz, Dimension::Inertia, kAny, Need::Required);
  map.number("ixy", xy, Dimension::Inertia);
  map.number("ixz", xz, Dimension::Inertia);
  map.number("iyz", yz, Dimension::Inertia);
  map.finish();
  Matrix3d inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  if (context.findings.size() == before) {
    const std::string fault = inertia_fault(inertia);
    if (!fault.empty()) {
      context.add(node.line, "impossible-inertia", fmt::format("{}: {}", path, fault));
    }
  }
  return inertia;
}

TargetShape read_shape(ReadContext& context, const Node& node, const std::string& path) {
  MapReader map(context, node, path);
  TargetShape shape{{}, Sphere{0}};
  map.pose(shape.pose);
  if (const Node* geometry = map.child("geometry", Need::Required)) {
    if (auto value = read_geometry(context, *geometry, map.path_of("geometry"))) {
      shape.geometry = std::move(*value);
    }
  }
  map.finish();
  return shape;
}

ContactFeature read_feature(ReadContext& context, const Node& node, const std::string& path) {
  MapReader map(context, node, path);
  ContactFeature feature;
  map.text("name", feature.name, Need::Required);
  map.vector3("point", feature.point, Dimension::Length, Need::Required);
  map.unit_vector("normal", feature.normal, Need::Required);
  map.finish();
  return feature;
}

/// The elements of an optional list.
template <class Read>
void read_list(MapReader& map, const std::string& key, const Read& read) {
  const Node* list = map.child(key);
  if (list == nullptr) return;
  if (list->kind != Node::Kind::Sequence) {
    map.context().add(list->line, "wrong-type",
                      fmt::format("{}: must be a list", map.path_of(key)));
    return;
  }
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    read(list->items[i], fmt::format("{}[{}]", map.path_of(key), i));
  }
}

/// A list of three numbers, or one number for all three.
void read_three(MapReader& map, const std::string& key, Dimension dimension, const Range& range,
                Vector3d& out) {
  const Node* node = map.child(key);
  if (node == nullptr) return;
  if (node->kind == Node::Kind::Plain || node->kind == Node::Kind::Quoted) {
    double value = 0;
    if (map.number(key, value, dimension, range)) out.setConstant(value);
    return;
  }
  const auto values = read_numbers(map.context(), *node, map.path_of(key), dimension, 3, range);
  if (values) out = Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

EstimateDeviations read_deviations(ReadContext& context, const Node& node,
                                   const std::string& path) {
  // Beyond these a Gaussian of the error means nothing.
  const Range angle{.lower = 0, .upper = 1}, relative{.lower = 0, .upper = 0.5};
  MapReader map(context, node, path);
  EstimateDeviations deviations;
  read_three(map, "position", Dimension::Length, kNonNegative, deviations.position);
  read_three(map, "orientation", Dimension::Angle, angle, deviations.orientation);
  read_three(map, "linear_velocity", Dimension::Velocity, kNonNegative, deviations.linear_velocity);
  read_three(map, "angular_velocity", Dimension::AngularVelocity, kNonNegative,
             deviations.angular_velocity);
  map.number("mass", deviations.mass, Dimension::None, relative);
  read_three(map, "moments", Dimension::None, relative, deviations.moments);
  map.finish();
  return deviations;
}

}  // namespace

std::optional<Geometry> read_geometry(ReadContext& context, const Node& node,
                                      const std::string& path) {
  const std::size_t before = context.findings.size();
  MapReader map(context, node, path);
  std::optional<Geometry> geometry;
  double radius = 0, length = 0;
  int stated = 0;
  const auto begin = [&](const char* kind) {
    const Node* inner = map.child(kind);
    if (inner != nullptr) ++stated;
    return inner;
  };
  if (const Node* inner = begin("sphere")) {
    MapReader fields(context, *inner, map.path_of("sphere"));
    fields.number("radius", radius, Dimension::Length, kPositive, Need::Required);
    fields.finish();
    geometry = Sphere{radius};
  }
  for (const char* kind : {"capsule", "cylinder"}) {
    const Node* inner = begin(kind);
    if (inner == nullptr) continue;
    MapReader fields(context, *inner, map.path_of(kind));
    fields.number("radius", radius, Dimension::Length, kPositive, Need::Required);
    fields.number("length", length, Dimension::Length, kPositive, Need::Required);
    fields.finish();
    if (kind == std::string_view("capsule")) {
      geometry = Capsule{radius, length};
    } else {
      geometry = Cylinder{radius, length};
    }
  }
  if (const Node* inner = begin("box")) {
    MapReader fields(context, *inner, map.path_of("box"));
    Vector3d size = Vector3d::Ones();
    if (fields.vector3("size", size, Dimension::Length, Need::Required) && !(size.minCoeff() > 0)) {
      context.add(fields.line_of("size"), "out-of-range",
                  fmt::format("{}: every edge must be > 0 m", fields.path_of("size")));
    }
    fields.finish();
    geometry = Box{size};
  }
  if (const Node* inner = begin("convex_mesh")) {
    if (auto mesh = read_mesh(context, *inner, map.path_of("convex_mesh"))) {
      geometry = std::move(*mesh);
    }
  }
  map.finish();
  if (stated != 1 && node.kind == Node::Kind::Map) {
    context.add(node.line, "geometry",
                fmt::format("{}: states {} shapes; must state exactly one of sphere, capsule, "
                            "cylinder, box, convex_mesh",
                            path, stated));
  }
  if (context.findings.size() != before) return std::nullopt;
  return geometry;
}

TargetBody read_target_body(MapReader& map) {
  ReadContext& context = map.context();
  TargetBody body;
  static const Names<bool> kModels{{"rigid_body", false}, {"point_mass", true}};
  map.text("name", body.name, Need::Required);
  map.choice("model", body.is_point_mass, kModels, Need::Required);
  map.number("mass", body.mass, Dimension::Mass, kSensible, Need::Required);
  const Node* inertia = map.child("inertia", body.is_point_mass ? Need::Optional : Need::Required);
  if (inertia != nullptr && body.is_point_mass) {
    context.add(inertia->line, "not-used",
                fmt::format("{}: a point mass has no inertia tensor", map.path_of("inertia")));
  } else if (inertia != nullptr) {
    body.inertia = read_inertia(context, *inertia, map.path_of("inertia"));
  }
  read_list(map, "shapes", [&](const Node& node, const std::string& path) {
    body.shapes.push_back(read_shape(context, node, path));
  });
  read_list(map, "features", [&](const Node& node, const std::string& path) {
    ContactFeature feature = read_feature(context, node, path);
    for (const ContactFeature& other : body.features) {
      if (other.name != feature.name) continue;
      context.add(node.line, "duplicate-name",
                  fmt::format("{}: there is already a feature '{}'", path, feature.name));
    }
    body.features.push_back(std::move(feature));
  });
  return body;
}

void read_format(MapReader& map, const std::string& format) {
  std::string stated = format;
  int version = 1;
  if (map.text("format", stated, Need::Required) && stated != format) {
    map.context().add(
        map.line_of("format"), "format",
        fmt::format("{}: is '{}'; must be '{}'", map.path_of("format"), stated, format));
  }
  map.integer("version", version, 1, 1, Need::Required);
}

TargetBody read_target_file(const Node& node, ReadContext& context) {
  MapReader map(context, node, "");
  read_format(map, "stillbase.target");
  TargetBody body = read_target_body(map);
  map.finish();
  return body;
}

TargetState read_target_state(ReadContext& context, const Node& node, const std::string& path,
                              std::optional<EstimateDeviations>& deviations) {
  MapReader map(context, node, path);
  if (const Node* covariance = map.child("covariance")) {
    deviations = read_deviations(context, *covariance, map.path_of("covariance"));
  }
  TargetState state;
  map.number("time", state.time, Dimension::Time);
  map.pose(state.pose);
  map.vector3("linear_velocity", state.linear_velocity, Dimension::Velocity);
  const Node* rate = map.child("angular_velocity");
  if (rate != nullptr && rate->kind == Node::Kind::Map) {
    MapReader spin(context, *rate, map.path_of("angular_velocity"));
    Vector3d axis = Vector3d::UnitZ();
    double magnitude = 0;
    spin.direction("axis", axis, Need::Required);
    spin.number("rate", magnitude, Dimension::AngularVelocity, kAny, Need::Required);
    spin.finish();
    state.angular_velocity = axis * magnitude;
  } else if (rate != nullptr) {
    map.vector3("angular_velocity", state.angular_velocity, Dimension::AngularVelocity);
  }
  map.finish();
  return state;
}

}  // namespace stillbase::io
