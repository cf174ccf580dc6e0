// COLLADA and glTF files, which a child reads: what becomes of one that crashes, hangs or grows.
#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "core/sanitized.hpp"
#include "robot/refusal.hpp"
#include "robot/scene_file.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;

namespace {

/// A triangle whose corners are stated as a text.
std::string collada_with(const std::string& corners, const std::string& nodes = "<node/>") {
  return R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3</vcount><p>)" +
         corners + R"(</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         nodes + R"(<node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string refusal_of_bytes(const std::string& bytes) {
  return test::refusal_of([&] { mesh_of_bytes(bytes); });
}

}  // namespace

TEST_CASE("COLLADA files that Assimp reads without end or crashes at are refused") {
  const TemporaryFolder scratch;
  CHECK(read_scene(scratch.write("good.dae", collada_with("0 1 2"))).triangles.size() == 1);
  const std::string letters = scratch.write("letters.dae", collada_with("a b c"));
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(read_scene(letters), MeshLimitError);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  CHECK(seconds.count() < kSceneSlowness * (kSceneSeconds + kSceneSecondsPerMiB) + 1);

  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "<node>";
  for (int i = 0; i < 200'000; ++i) deep += "</node>";
  CHECK_THROWS_AS(read_scene(scratch.write("deep.dae", collada_with("0 1 2", deep))),
                  std::runtime_error);
}

TEST_CASE("a robot names each mesh that is refused, and reads none behind one without end") {
  const TemporaryFolder scratch;
  scratch.write("a.dae", collada_with("a b c"));
  scratch.write("b.dae", collada_with("d e f"));
  std::string links, joints;
  for (const char* file : {"a.dae", "b.dae", "a.dae"}) {
    links += std::string("<collision><geometry><mesh filename=\"") + file +
             "\"/></geometry></collision>\n";
  }
  const std::string robot = scratch.write(
      "r.urdf",
      "<robot name=\"r\"><link name=\"base\"><inertial><mass value=\"1\"/>"
      "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n" +
          links + "</link></robot>");
  try {
    read_robot(robot);
    FAIL("accepted");
  } catch (const InputError& error) {
    REQUIRE(error.findings().size() == 3);
    const auto says = [&](std::size_t i, const std::string& text) {
      INFO(error.findings()[i].message);
      CHECK(error.findings()[i].line == static_cast<int>(i) + 2);
      CHECK(error.findings()[i].message.find(text) != std::string::npos);
    };
    says(0, "'a.dae': cannot be read (Assimp ");
    says(1, "'b.dae': is not read, since an earlier one");
    says(2, "'a.dae': cannot be read (Assimp ");
  }
}

TEST_CASE(
    "threads read COLLADA files beside each other and beside others that allocate and throw") {
  if (STILLBASE_SANITIZED) {
    WARN("skipped: a sanitizer's allocator keeps locks held in the child of a threaded process");
    return;
  }
  const TemporaryFolder scratch;
  const std::string good = scratch.write("good.dae", collada_with("0 1 2"));
  const std::string bad = scratch.write("bad.dae", collada_with("0 1 9"));
  std::atomic<bool> is_done{false};
  std::atomic<int> read{0}, refused{0};
  std::vector<std::thread> busy, readers;
  for (int i = 0; i < 2; ++i) {
    busy.emplace_back([&] {
      while (!is_done) {
        try {
          const std::ifstream file(good);
          throw std::runtime_error(std::string(1000, 'x'));
        } catch (const std::runtime_error&) {
          std::this_thread::yield();
        }
      }
    });
    readers.emplace_back([&] {
      for (int k = 0; k < 50; ++k) {
        read += read_scene(good).triangles.size() == 1 ? 1 : 0;
        try {
          read_scene(bad);
        } catch (const MeshLimitError&) {
        } catch (const std::runtime_error&) {
          ++refused;
        }
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  is_done = true;
  for (std::thread& thread : busy) thread.join();
  CHECK(read == 100);
  CHECK(refused == 100);
}

TEST_CASE("what a child returns is looked at before it is a mesh") {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}};
  mesh.triangles = {{0, 1, 2}};
  const std::string bytes = mesh_to_bytes(mesh);
  const Mesh copy = mesh_of_bytes(bytes);
  CHECK(copy.vertices == mesh.vertices);
  CHECK(copy.triangles == mesh.triangles);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    CHECK(refusal_of_bytes(bytes.substr(0, length)) == "cannot be read (its end is missing)");
  }
  std::string many = bytes, far = bytes, index = bytes;
  many[12] = 1;
  CHECK(refusal_of_bytes(many) == "more than 4000000 triangles");
  far[19] = 0x7f;
  CHECK(refusal_of_bytes(far).find("of a vertex is beyond 1e+09") != std::string::npos);
  index[16 + 36] = 3;
  CHECK(refusal_of_bytes(index) == "a face names a vertex that is not there");
}
