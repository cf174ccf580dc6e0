// What a robot file has for drawings: nothing of it is refused.
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "robot/visual_shapes.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::urdf;
namespace fs = std::filesystem;

namespace {

class DrawingFolder : public TemporaryFolder {
 public:
  /// The shapes of a link with these <visual>, and what is said of them.
  std::pair<Visuals, std::string> read(const std::string& inside, std::size_t most = 1000) const {
    Findings findings("robot.urdf");
    const std::string text =
        "<robot name=\"r\">\n<material name=\"red\"><color rgba=\"1 0 0 1\"/>"
        "</material>\n<link name=\"arm\">\n" +
        inside + "</link>\n</robot>\n";
    Visuals visuals = read_visual_shapes(text, {path("robot/urdf/robot.urdf"), {}}, most, findings);
    std::string remarks;
    for (const Finding& finding : findings.remarks()) remarks += to_string(finding) + '\n';
    CHECK_NOTHROW(findings.raise());
    return {visuals, remarks};
  }

 private:
  fs::path folder_;
};

std::string visual(const std::string& geometry, const std::string& more = "") {
  return "<visual><origin xyz=\"0 0 2\"/><geometry>" + geometry + "</geometry>" + more +
         "</visual>\n";
}

/// A tetrahedron of 1 m.
const char* const kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

}  // namespace

TEST_CASE("shapes and meshes for drawings are read with their poses, scales and colours") {
  const DrawingFolder folder;
  folder.write("robot/package.xml", "<package/>");
  folder.write("robot/meshes/part.obj", kObj);
  folder.write("robot/urdf/robot.urdf", "");
  const auto [visuals, remarks] = folder.read(
      visual("<box size=\"1 2 3\"/>", "<material name=\"red\"/>") +
      visual("<mesh filename=\"package://robot/meshes/part.obj\" scale=\"0.5 0.5 -0.5\"/>",
             "<material name=\"\"><color rgba=\"0 0.5 2 1\"/></material>") +
      visual("<mesh filename=\"../meshes/part.obj\"/>"));
  CHECK(remarks.empty());
  REQUIRE(visuals.shapes.size() == 3);
  REQUIRE(visuals.meshes.size() == 1);  // one file, two uses
  CHECK(visuals.meshes.front().triangles.size() == 4);
  CHECK(enclosed_volume(visuals.meshes.front()) == Approx(1.0 / 6));
  for (const VisualShape& shape : visuals.shapes) {
    CHECK(shape.link == "arm");
    CHECK(shape.pose.position == Vector3d(0, 0, 2));
  }
  CHECK(std::get<Box>(*visuals.shapes[0].geometry).size == Vector3d(1, 2, 3));
  CHECK(visuals.shapes[0].color == Vector3d(1, 0, 0));
  CHECK_FALSE(visuals.shapes[1].geometry);
  CHECK(visuals.shapes[1].scale == Vector3d(0.5, 0.5, -0.5));
  CHECK(visuals.shapes[1].color == Vector3d(0, 0.5, 1));
  CHECK_FALSE(visuals.shapes[2].color);
}

TEST_CASE("drawings that are not there or cannot be read are remarks") {
  const DrawingFolder folder;
  folder.write("robot/package.xml", "<package/>");
  folder.write("robot/urdf/robot.urdf", "");
  folder.write("secret.obj", kObj);
  folder.write("robot/urdf/text.obj", "hello\n");
  folder.write("robot/urdf/nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("robot/urdf/flat.obj", "v 1 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n");
  folder.write("robot/urdf/far.obj", "v 1e30 0 0\nv 0 0 0\nv 0 1e30 0\nf 1 2 3\n");
  folder.write("robot/urdf/notes.txt", kObj);
  fs::create_symlink("circle.obj", folder.path("robot/urdf/circle.obj"));
  for (const std::string name :
       {"missing.obj", "package://robot/missing.stl", "../../secret.obj", "text.obj", "nan.obj",
        "flat.obj", "far.obj", "notes.txt", "circle.obj", "http://example.org/part.obj"}) {
    const auto [visuals, remarks] =
        folder.read(visual("<mesh filename=\"" + name + "\"/>") + visual("<sphere radius=\"1\"/>"));
    INFO(name << ": " << remarks);
    CHECK(visuals.shapes.size() == 1);  // the sphere
    CHECK(remarks.find("visual") != std::string::npos);
    CHECK(remarks.find("arm") != std::string::npos);
  }
  for (const std::string wrong : {"<sphere radius=\"nan\"/>", "<sphere radius=\"1e9\"/>",
                                  "<box size=\"1 2\"/>", "<sphere radius=\"0\"/>"}) {
    for (const std::string& text : {visual(wrong), visual(wrong) + visual(wrong)}) {
      const auto [visuals, remarks] = folder.read(text);
      INFO(text << ": " << remarks);
      CHECK(visuals.shapes.empty());
      CHECK(remarks.find("visual") != std::string::npos);
    }
  }
}

TEST_CASE("a mesh for drawings is thinned as it is read") {
  const DrawingFolder folder;
  std::string text;
  const int n = 60;
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= n; ++k) text += fmt::format("v {} {} {}\n", i, k, i * k % 7);
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 1; k <= n; ++k) {
      const int a = i * (n + 1) + k, b = a + n + 1;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, b + 1, a, b + 1, a + 1);
    }
  }
  folder.write("robot/urdf/robot.urdf", "");
  folder.write("robot/urdf/field.obj", text);
  const auto [all, silent] = folder.read(visual("<mesh filename=\"field.obj\"/>"), 10000);
  CHECK(all.meshes.front().triangles.size() == 7200);
  const auto [thin, also_silent] = folder.read(visual("<mesh filename=\"field.obj\"/>"), 1000);
  CHECK(thin.meshes.front().triangles.size() <= 1000);
  CHECK(thin.meshes.front().triangles.size() > 200);
  CHECK((silent + also_silent).empty());
}
