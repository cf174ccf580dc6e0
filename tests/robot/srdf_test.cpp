#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>

#include "robot/srdf_reader.hpp"

using namespace stillbase;

TEST_CASE("an SRDF gives disabled collisions and the ends of its chains") {
  const Srdf srdf = read_srdf(R"(<?xml version="1.0"?>
<!-- from an assistant -->
<robot name="arm">
  <group name="arm"><chain base_link="base" tip_link="flange"/></group>
  <group name="gripper"><link name="left"/><joint name="finger"/></group>
  <group_state name="home" group="arm"><joint name="j" value="0"/></group_state>
  <end_effector name="hand" parent_link="flange" group="gripper"/>
  <virtual_joint name="v" type="floating" parent_frame="world" child_link="base"/>
  <disable_collisions link1="base" link2="link_1" reason="Adjacent"/>
  <disable_collisions link1="base" link2="link_2" reason="Never"/>
</robot>)",
                              "arm.srdf");
  REQUIRE(srdf.disabled_collisions.size() == 2);
  CHECK(srdf.disabled_collisions[1].second == "link_2");
  CHECK(srdf.chain_tips == std::vector<std::string>{"flange"});
}

TEST_CASE("an SRDF that names no links is refused at its line") {
  for (const char* text :
       {"<robot name=\"r\">\n<disable_collisions link1=\"a\"/></robot>",
        "<robot name=\"r\">\n<group name=\"g\"><chain base_link=\"a\"/></group></robot>"}) {
    try {
      read_srdf(text, "r.srdf");
      FAIL("accepted");
    } catch (const InputError& error) {
      CHECK(error.findings().front().line == 2);
      CHECK(error.findings().front().rule == "missing-attribute");
    }
  }
  CHECK_THROWS_AS(read_srdf("<model/>", "r.srdf"), InputError);
  CHECK_THROWS_AS(read_srdf("", "r.srdf"), InputError);
}
