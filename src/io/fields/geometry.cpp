// Shapes of bodies that are not the robot's.
#include <fmt/format.h>
#include <Eigen/Dense>

#include "io/fields/values.hpp"

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

void mesh_fields(Table& t, ConvexMesh& mesh) {
  t("vertices",
    List(
        mesh.vertices, [](Vector3d& v) { return Vector(v, Dimension::Length, kPlaceOnBody); },
        {.least = 4}, Vector3d(Vector3d::Zero())),
    "", kNeeded);
  t("faces",
    List(mesh.faces,
         [](std::vector<int>& face) {
           return List(face, [](int& corner) { return Integer(corner, 0, 1'000'000); },
                       {.least = 3});
         },
         {.least = 4}),
    "numbers of vertices, counter-clockwise seen from outside", kNeeded);
}

/// The shape of this kind that the geometry holds, or one of size zero.
template <class T>
T held(const Geometry& geometry) {
  const T* shape = std::get_if<T>(&geometry);
  return shape == nullptr ? T{} : *shape;
}

/// {radius, length} of a capsule or a cylinder.
template <class T>
void round_fields(Table& t, const char* kind, const char* text, Geometry& geometry) {
  T shape = held<T>(geometry);
  t(kind, Map([&shape](Table& m) {
      m("radius", Number(shape.radius, Dimension::Length, kSize), "", kNeeded);
      m("length", Number(shape.length, Dimension::Length, kSize), "", kNeeded);
    }),
    text, kNeeded);
  geometry = shape;
}

void geometry_fields(Table& t, Geometry& geometry) {
  const int kind = t.one_of({"sphere", "capsule", "cylinder", "box", "convex_mesh"},
                            static_cast<int>(geometry.index()), "geometry");
  if (kind == 0) {
    Sphere sphere = held<Sphere>(geometry);
    t("sphere", Map([&sphere](Table& m) {
        m("radius", Number(sphere.radius, Dimension::Length, kSize), "", kNeeded);
      }),
      "", kNeeded);
    geometry = sphere;
  } else if (kind == 1) {
    round_fields<Capsule>(t, "capsule", "along z, centred; the length without caps", geometry);
  } else if (kind == 2) {
    round_fields<Cylinder>(t, "cylinder", "along z, centred", geometry);
  } else if (kind == 3) {
    Box box = held<Box>(geometry);
    t("box", Map([&box](Table& m) {
        m("size", Vector(box.size, Dimension::Length, kSize), "edges", needed("m", "the shape"));
      }),
      "", kNeeded);
    geometry = box;
  } else if (kind == 4) {
    ConvexMesh mesh = held<ConvexMesh>(geometry);
    t("convex_mesh", Map([&mesh](Table& m) { mesh_fields(m, mesh); }), "", kNeeded);
    MapReader* map = t.reader();
    if (map != nullptr && !map->was_refused("convex_mesh")) {
      check_mesh(map->context(), map->line_of("convex_mesh"), map->path_of("convex_mesh"), mesh);
    }
    geometry = mesh;
  }
}

}  // namespace

Map geometry_of(Geometry& geometry) {
  return Map([&geometry](Table& t) { geometry_fields(t, geometry); }, {.name = "geometry"});
}

}  // namespace stillbase::io
