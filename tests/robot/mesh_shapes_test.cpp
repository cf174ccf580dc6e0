// Collision meshes of files: formats, places, hulls, and what is refused.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/assembly.hpp"
#include "robot/mesh_file.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
namespace fs = std::filesystem;

namespace {

/// Corners of the triangles of a box from (0, 0, 0) to `size`.
std::vector<Vector3d> box_triangles(const Vector3d& size) {
  const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<Vector3d> corners;
  for (const auto& face : faces) {
    for (const int i : face) {
      corners.push_back(size.cwiseProduct(Vector3d(i & 1, (i >> 1) & 1, (i >> 2) & 1)));
    }
  }
  return corners;
}

std::string ascii_stl(const std::vector<Vector3d>& corners) {
  std::string text = "solid box\n";
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (std::size_t c = i; c < i + 3; ++c) {
      text += fmt::format("vertex {} {} {}\n", corners[c][0], corners[c][1], corners[c][2]);
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string binary_stl(const std::vector<Vector3d>& corners) {
  const auto count = static_cast<std::uint32_t>(corners.size() / 3);
  std::string text(80, 'b');
  text.append(reinterpret_cast<const char*>(&count), 4);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    float values[12] = {0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) values[3 + 3 * c + k] = static_cast<float>(corners[i + c][k]);
    }
    text.append(reinterpret_cast<const char*>(values), sizeof(values));
    text.append(2, '\0');
  }
  return text;
}

std::string obj(const std::vector<Vector3d>& corners) {
  std::string text;
  for (const Vector3d& v : corners) text += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
  for (std::size_t i = 1; i <= corners.size(); i += 3) {
    text += fmt::format("f {} {} {}\n", i, i + 1, i + 2);
  }
  return text;
}

/// In millimetres with y up.
std::string collada(const std::vector<Vector3d>& corners) {
  std::string numbers, indices;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    numbers +=
        fmt::format("{} {} {} ", 1e3 * corners[i][0], 1e3 * corners[i][1], 1e3 * corners[i][2]);
    indices += fmt::format("{} ", i);
  }
  return fmt::format(R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="{0}">{2}</float_array><technique_common>
<accessor source="#a" count="{1}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{3}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
                     3 * corners.size(), corners.size(), numbers, indices);
}

std::string urdf_with(const std::string& mesh) {
  return R"(<robot name="r">
<link name="base"><inertial><mass value="10"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry>
)" + mesh +
         R"(
</geometry></collision></link></robot>)";
}

Finding mesh_refusal(const std::string& robot) {
  try {
    read_robot(robot);
  } catch (const InputError& error) {
    return error.findings().front();
  }
  return {};
}

/// Edges of the box around the only shape, which is a hull.
Vector3d size_of(const RobotModel& robot) {
  REQUIRE(robot.shapes.size() == 1);
  const auto& mesh = std::get<ConvexMesh>(robot.shapes[0].geometry);
  Vector3d lower = mesh.vertices[0], upper = lower;
  for (const Vector3d& v : mesh.vertices) {
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
  }
  CHECK(mesh.vertices.size() == 8);
  return upper - lower;
}

}  // namespace

TEST_CASE("meshes of every format become the same hull") {
  const TemporaryFolder scratch;
  const Vector3d size(0.25, 0.5, 1);
  const std::vector<Vector3d> box = box_triangles(size);
  scratch.write("a.stl", ascii_stl(box));
  scratch.write("b.STL", binary_stl(box));
  scratch.write("c.obj", obj(box));
  scratch.write("d.dae", collada(box));
  for (const char* name : {"a.stl", "b.STL", "c.obj", "d.dae"}) {
    INFO(name);
    const std::string robot =
        scratch.write("r.urdf", urdf_with(fmt::format("<mesh filename=\"{}\"/>", name)));
    CHECK(size_of(read_robot(robot)).isApprox(size, 1e-6));
  }
  const std::string scaled =
      scratch.write("s.urdf", urdf_with("<mesh filename=\"a.stl\" scale=\"0.001 2 -1\"/>"));
  CHECK(size_of(read_robot(scaled)).isApprox(Vector3d(0.25e-3, 1, 1), 1e-6));
}

TEST_CASE("equal vertices of meshes of many triangles are joined, and no others") {
  constexpr int kAround = 400, kAlong = 150;  // of a tube without ends
  const auto at = [](int i, int j) {
    const double angle = 2 * kPi * (i % kAround) / kAround;
    // Opposite the seam y is -0 in one triangle and 0 in the next.
    const double y = i % kAround == kAround / 2 ? (j % 2 == 0 ? 0.0 : -0.0) : std::sin(angle);
    return Vector3d(std::cos(angle), y, 0.01 * j);
  };
  std::vector<Vector3d> corners;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAlong; ++j) {
      for (const auto& [a, b] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        corners.push_back(at(i + a, j + b));
      }
    }
  }
  const TemporaryFolder scratch;
  for (const auto& [name, text] :
       {std::pair("a.stl", ascii_stl(corners)), {"b.stl", binary_stl(corners)}}) {
    const Mesh mesh = read_mesh(scratch.write(name, text));
    INFO(name);
    REQUIRE(mesh.triangles.size() == 2 * kAround * kAlong);
    CHECK(mesh.vertices.size() == kAround * (kAlong + 1));
    double farthest = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto v = static_cast<std::size_t>(mesh.triangles[i][c]);
        farthest = std::max(farthest, (mesh.vertices[v] - corners[3 * i + c]).norm());
      }
    }
    CHECK(farthest < 1e-6);
  }
}

TEST_CASE("packages are found upwards from the file and where the user says") {
  const TemporaryFolder scratch;
  const std::string stl = ascii_stl(box_triangles(Vector3d::Ones()));
  scratch.write("ws/arm_description/meshes/link.stl", stl);
  scratch.write("elsewhere/tool_description/link.stl", stl);
  scratch.write("ws/arm_description/package.xml", "<package/>");
  const std::string own = "<mesh filename=\"package://arm_description/meshes/link.stl\"/>";
  CHECK(read_robot(scratch.write("ws/arm_description/urdf/r.urdf", urdf_with(own))).shapes.size() ==
        1);
  CHECK(read_robot(scratch.write("ws/other/urdf/r.urdf", urdf_with(own))).shapes.size() == 1);
  const std::string up = urdf_with("<mesh filename=\"../meshes/link.stl\"/>");
  CHECK(read_robot(scratch.write("ws/arm_description/urdf/u.urdf", up)).shapes.size() == 1);
  const std::string file = urdf_with(fmt::format(
      "<mesh filename=\"file://{}\"/>", scratch.path("elsewhere/tool_description/link.stl")));
  CHECK(read_robot(scratch.write("f.urdf", file)).shapes.size() == 1);

  const std::string tool = scratch.write(
      "t.urdf", urdf_with("<mesh filename=\"package://tool_description/link.stl\"/>"));
  const RobotModel without = read_robot(tool);
  CHECK(without.shapes.empty());
  REQUIRE(without.remarks.size() == 1);
  CHECK(without.remarks[0].rule == "mesh");
  CHECK(without.remarks[0].line == 5);
  CHECK(without.remarks[0].message.find("base (package://tool_description/link.stl)") !=
        std::string::npos);
  CHECK(read_robot(tool, "", {.package_path = {scratch.path("elsewhere")}}).shapes.size() == 1);
}

namespace {

/// An L.
std::vector<Vector3d> two_plates() {
  std::vector<Vector3d> corners = box_triangles(Vector3d(1, 1, 0.1));
  for (Vector3d v : box_triangles(Vector3d(1, 0.1, 1))) {
    v.z() += 0.1;
    corners.push_back(v);
  }
  return corners;
}

}  // namespace

TEST_CASE("a mesh that is much smaller than its hull is remarked upon") {
  const TemporaryFolder scratch;
  const std::vector<Vector3d> corners = two_plates();
  scratch.write("l.stl", ascii_stl(corners));
  const RobotModel robot =
      read_robot(scratch.write("r.urdf", urdf_with("<mesh filename=\"l.stl\"/>")));
  REQUIRE(robot.remarks.size() == 1);
  CHECK(robot.remarks[0].rule == "hull");
  CHECK(robot.remarks[0].message.find("times)") != std::string::npos);
  CHECK(robot.remarks[0].message.find("robot.collision: decompose") != std::string::npos);
}

TEST_CASE("a concave mesh becomes parts where that is asked for, and its text carries them") {
  const TemporaryFolder scratch;
  const std::vector<Vector3d> corners = two_plates();
  scratch.write("l.stl", ascii_stl(corners));
  const std::string file =
      scratch.write("r.urdf", urdf_with("<mesh filename=\"l.stl\" scale=\"1 -2 1\"/>"));
  const RobotModel robot = read_robot(file, "", {.collision = CollisionMeshes::Decompose});
  CHECK(robot.shapes.size() == 2);
  REQUIRE(robot.remarks.size() == 1);
  CHECK(robot.remarks[0].rule == "parts");
  CHECK(robot.remarks[0].line == 5);
  CHECK(robot.remarks[0].message.find("base (2 parts, 1 times its volume)") != std::string::npos);

  RobotAssembly assembly(CollisionMeshes::Decompose);
  assembly.add_robot(read_text_file(file), {file, {}}, "r.urdf");
  const RobotModel again = read_urdf(assembly.text(), "merged", "");
  REQUIRE(again.shapes.size() == robot.shapes.size());
  for (std::size_t i = 0; i < again.shapes.size(); ++i) {
    const auto& one = std::get<ConvexMesh>(robot.shapes[i].geometry);
    const auto& other = std::get<ConvexMesh>(again.shapes[i].geometry);
    CHECK(one.vertices == other.vertices);
    CHECK(one.faces == other.faces);
  }
}

TEST_CASE("a mesh is read through a symbolic link, as workspaces have them") {
  const TemporaryFolder scratch;
  scratch.write("source/box.stl", ascii_stl(box_triangles(Vector3d::Ones())));
  fs::create_directories(scratch.path("install/meshes"));
  fs::create_symlink(scratch.path("source/box.stl"), scratch.path("install/meshes/box.stl"));
  const std::string robot =
      scratch.write("install/urdf/r.urdf", urdf_with("<mesh filename=\"../meshes/box.stl\"/>"));
  CHECK(read_robot(robot).shapes.size() == 1);
}

TEST_CASE("hostile meshes are refused within a second, at their line") {
  const TemporaryFolder scratch;
  std::string huge(80, 'h');
  const std::uint32_t count = 0xffffffff;
  huge.append(reinterpret_cast<const char*>(&count), 4);
  std::vector<Vector3d> bad = box_triangles(Vector3d::Ones());
  bad[4].x() = std::nan("");
  scratch.write("huge.stl", huge + std::string(500, '\0'));
  scratch.write("nan.stl", binary_stl(bad));
  scratch.write("nan_text.stl", ascii_stl(bad));
  scratch.write("empty.stl", "");
  scratch.write("faceless.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  scratch.write("faces.obj", "v 0 0 0\nf 1 2 3\n");
  scratch.write("text.stl", "solid " + std::string(8u << 20, 'x'));
  scratch.write("text.dae", "<COLLADA>" + std::string(8u << 20, 'x'));
  scratch.write("text.obj", std::string(8u << 20, 'v'));
  // 4 GB and 3.6 GB, as their headers say.
  scratch.write("length.glb",
                std::string("glTF\2\0\0\0\xff\xff\xff\xff\xf0\xff\xff\xffJSON{}", 22));
  scratch.write("count.ply",
                "ply\nformat ascii 1.0\nelement vertex 300000000\nproperty float x\n"
                "property float y\nproperty float z\nend_header\n0 0 0\n");
  scratch.write("point.stl", ascii_stl({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
  scratch.write("far.obj", "v 0 0 0\nv 1e38 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
  scratch.write("mesh.xyz", "1 2 3");
  for (const char* name :
       {"huge.stl", "nan.stl", "nan_text.stl", "empty.stl", "faceless.obj", "faces.obj", "text.stl",
        "text.dae", "text.obj", "length.glb", "count.ply", "point.stl", "far.obj", "mesh.xyz"}) {
    const std::string robot =
        scratch.write("r.urdf", urdf_with(fmt::format("<mesh filename=\"{}\"/>", name)));
    const auto start = std::chrono::steady_clock::now();
    const Finding finding = mesh_refusal(robot);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    INFO(name << ": " << finding.message);
    CHECK(finding.rule == "mesh");
    CHECK(finding.line == 5);
    CHECK(seconds.count() < 1);
  }
}

TEST_CASE("meshes that no unit of length makes a robot's are refused with what their size is") {
  const TemporaryFolder scratch;
  scratch.write("box.stl", binary_stl(box_triangles(Vector3d(1, 2, 3))));
  const auto refusal_with = [&](const std::string& scale) {
    return mesh_refusal(
        scratch.write("r.urdf", urdf_with("<mesh filename=\"box.stl\" scale=\"" + scale + "\"/>")));
  };
  CHECK(refusal_with("3e3 3e3 3e3").message.empty());
  CHECK(refusal_with("1e-6 1e-6 1e-6").message.empty());
  const Finding far = refusal_with("1 -1 4e3");
  CHECK(far.rule == "mesh");
  CHECK(far.line == 5);
  CHECK(far.message.find("reaches 1.2e+04 m from its own origin, with its scale; 10000 m are") !=
        std::string::npos);
  const Finding small = refusal_with("1e-7 1e-7 1e-7");
  CHECK(small.line == 5);
  CHECK(small.message.find("is 3e-07 m large, with its scale; 1e-06 m is the smallest") !=
        std::string::npos);
}

TEST_CASE("paths that leave the robot's package or go in circles are refused") {
  const TemporaryFolder scratch;
  scratch.write("secret.stl", ascii_stl(box_triangles(Vector3d::Ones())));
  scratch.write("arm/package.xml", "<package/>");
  fs::create_directories(scratch.path("arm/meshes"));
  fs::create_symlink("b.stl", scratch.path("arm/meshes/a.stl"));
  fs::create_symlink("a.stl", scratch.path("arm/meshes/b.stl"));
  for (const char* name : {"../../secret.stl", "package://arm/../secret.stl", "../meshes/a.stl"}) {
    const Finding finding = mesh_refusal(
        scratch.write("arm/urdf/r.urdf", urdf_with(fmt::format("<mesh filename=\"{}\"/>", name))));
    INFO(name << ": " << finding.message);
    CHECK(finding.rule == "mesh-path");
    CHECK(finding.line == 5);
  }
}

TEST_CASE("meshes that no reader could find or knows leave their links without a shape") {
  const TemporaryFolder scratch;
  scratch.write("arm/package.xml", "<package/>");
  scratch.write("arm/meshes/a.blend", "BLENDER");
  scratch.write("arm/meshes/a.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n");
  for (const char* name :
       {"../../not_there.stl", "package://arm/../not_there.stl", "http://host/a.stl",
        "package://arm", "../meshes/a.blend", "../meshes/a.stl"}) {
    INFO(name);
    const RobotModel robot = read_robot(
        scratch.write("arm/urdf/r.urdf", urdf_with(fmt::format("<mesh filename=\"{}\"/>", name))));
    CHECK(robot.shapes.empty());
    REQUIRE(robot.remarks.size() == 1);
    CHECK(robot.remarks[0].rule == "mesh");
    CHECK(robot.remarks[0].line == 5);
  }
}

TEST_CASE("a COLLADA or glTF file names no file outside of its own folder") {
  const TemporaryFolder scratch;
  const std::vector<Vector3d> box = box_triangles(Vector3d::Ones());
  std::string buffer;
  for (const Vector3d& v : box) {
    for (int k = 0; k < 3; ++k) {
      const auto x = static_cast<float>(v[k]);
      buffer.append(reinterpret_cast<const char*>(&x), 4);
    }
  }
  const auto gltf = [&](const std::string& uri) {
    return fmt::format(R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"buffers":[{{"uri":"{}","byteLength":{}}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":36,"type":"VEC3","min":[0,0,0],
"max":[1,1,1]}}]}})",
                       uri, buffer.size(), buffer.size());
  };
  scratch.write("meshes/box.bin", buffer);
  scratch.write("box.bin", buffer);
  const Mesh mesh = read_mesh(scratch.write("meshes/box.gltf", gltf("box.bin")));
  CHECK(mesh.triangles.size() == 12);
  CHECK_THROWS(read_mesh(scratch.write("meshes/out.gltf", gltf("../box.bin"))));
}
