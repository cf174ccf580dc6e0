// Shapes of bodies that are not the robot's.
#include <stillbase/robot/physical_checks.hpp>

#include "io/fields/values.hpp"

namespace stillbase::io {

namespace {

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
      const std::string fault = convex_mesh_fault(mesh);
      if (!fault.empty()) map->refuse("convex_mesh", "not-convex", fault);
    }
    geometry = mesh;
  }
}

}  // namespace

Map geometry_of(Geometry& geometry) {
  return Map([&geometry](Table& t) { geometry_fields(t, geometry); }, {.name = "geometry"});
}

}  // namespace stillbase::io
