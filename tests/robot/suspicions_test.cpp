#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/suspicions.hpp>
#include <stillbase/robot/urdf_reader.hpp>

using namespace stillbase;

namespace {

// A careful robot: uniform rods of 1 m and 0.05 m radius on a cube of 1 m.
const std::string kGood = R"(<robot name="r">
<link name="base"><inertial><mass value="100"/>
<inertia ixx="16.7" iyy="16.7" izz="16.7" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link>
<link name="upper"><inertial><origin xyz="0 0 0.5"/><mass value="6"/>
<inertia ixx="0.504" iyy="0.504" izz="0.0075" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision></link>
<link name="lower"><inertial><origin xyz="0 0 0.5"/><mass value="4"/>
<inertia ixx="0.336" iyy="0.336" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="50"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="30"/></joint>
</robot>
)";

std::vector<std::string> remarks_on(const std::string& text) {
  return robot_suspicions(read_urdf(text, "r.urdf", ""));
}

/// The good robot with one change gives a remark that starts with the name and has the part.
void remarked(const std::string& from, const std::string& to, const std::string& name,
              const std::string& part) {
  std::string text = kGood;
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  REQUIRE(text != kGood);
  std::string all;
  bool found = false;
  for (const std::string& remark : remarks_on(text)) {
    all += remark + '\n';
    found = found || (remark.rfind(name, 0) == 0 && remark.find(part) != std::string::npos);
  }
  INFO(from << " -> " << to << "\n" << all);
  CHECK(found);
}

}  // namespace

TEST_CASE("a robot without placeholders has no remarks") {
  const std::vector<std::string> remarks = remarks_on(kGood);
  INFO((remarks.empty() ? "" : remarks.front()));
  CHECK(remarks.empty());
}

TEST_CASE("what is possible and most likely a mistake is remarked on") {
  remarked("<origin xyz=\"0 0 0.5\"/><mass value=\"6\"/>", "<mass value=\"6\"/>", "upper",
           "centroid is at its joint");
  remarked("ixx=\"0.504\" iyy=\"0.504\" izz=\"0.0075\"", "ixx=\"1\" iyy=\"1\" izz=\"1\"", "upper",
           "1 kg m^2 about every axis");
  remarked("ixx=\"0.504\" iyy=\"0.504\" izz=\"0.0075\"", "ixx=\"0.3\" iyy=\"0.3\" izz=\"0.3\"",
           "upper", "like a sphere's");
  remarked("ixx=\"0.504\" iyy=\"0.504\" izz=\"0.0075\"", "ixx=\"50\" iyy=\"50\" izz=\"0.7\"",
           "upper", "but the body ends");
  remarked("ixx=\"0.504\" iyy=\"0.504\" izz=\"0.0075\"", "ixx=\"2e-4\" iyy=\"2e-4\" izz=\"1e-4\"",
           "upper", "but it reaches");
  remarked("ixx=\"0.504\" iyy=\"0.504\" izz=\"0.0075\"",
           "ixx=\"0.336\" iyy=\"0.336\" izz=\"0.005\"", "upper, lower", "the same inertia tensor");
  remarked("velocity=\"1\" effort=\"50\"", "velocity=\"1\" effort=\"0\"", "shoulder",
           "effort is limited to zero");
  remarked("velocity=\"1\" effort=\"50\"", "velocity=\"1e5\" effort=\"50\"", "shoulder",
           "limits nothing");
  remarked("lower=\"-3\" upper=\"3\"", "lower=\"-100\" upper=\"100\"", "shoulder", "turns");
  remarked("lower=\"-3\" upper=\"3\"", "lower=\"0\" upper=\"0\"", "shoulder", "no motion");
  remarked("<mass value=\"100\"/>", "<mass value=\"8\"/>", "the joints move 10 kg", "base");
  remarked("<mass value=\"4\"/>", "<mass value=\"0.0005\"/>", "lower", "kg in all");
  remarked("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 -1\"/>", "all joints turn", "parallel");
  remarked("<collision><geometry><box size=\"1 1 1\"/></geometry></collision>", "", "base",
           "no collision geometry");
}

TEST_CASE("a joint without bounds on rate and effort is remarked on") {
  std::string text = kGood;
  const std::string limit = "<limit lower=\"-3\" upper=\"3\" velocity=\"1\" effort=\"50\"/>";
  text.erase(text.find(limit), limit.size());
  text.replace(text.find("\"revolute\""), 10, "\"continuous\"");
  CHECK(remarks_on(text) == std::vector<std::string>{"shoulder: no limit on its rate",
                                                     "shoulder: no limit on its effort"});
}

TEST_CASE("shipped robots are remarked on where their sources have placeholders") {
  const auto remarks = [](const std::string& name) {
    const std::string path =
        std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name + ".urdf";
    std::string all;
    for (const std::string& remark :
         robot_suspicions(read_urdf(read_text_file(path), path, "hand"))) {
      all += remark + '\n';
    }
    return all;
  };
  // Seven links of one tensor in the sample that the numbers come from.
  CHECK_THAT(remarks("deos"), Catch::Contains("the same inertia tensor on bodies of different"));
  CHECK_THAT(remarks("planar_two_link_a"), Catch::Contains("parallel axes"));
  CHECK_THAT(remarks("iiwa_on_cube"), !Catch::Contains("no collision geometry: nothing"));
}
