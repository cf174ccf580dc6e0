// Numbers that cannot be meant: refused with their range, or remarked on.
#include <catch2/catch.hpp>

#include <chrono>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const char* const kEts7 = "problems/ets7_client.yaml";
const char* const kWedge = "problems/planar_two_link_c2_a.yaml";

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

bool shows(const Outcome& outcome, const std::string& part) {
  return outcome.out.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("extreme numbers of a problem are refused with their range") {
  const Workshop shop;
  struct Extreme {
    const char *from, *to, *key, *range;
  };
  const Extreme cases[] = {
      {"wait: 5 s", "wait: 2e9 s", "approach.wait", "in [0, 86400] s"},
      {"wait: 5 s", "max_duration: 1e300", "approach.max_duration", "in [0.001, 86400] s"},
      {"wait: 5 s", "max_duration: 1e-300", "approach.max_duration", "in [0.001, 86400] s"},
      {"acceleration_limit: 0.05", "acceleration_limit: 1e-300", "approach.acceleration_limit",
       "in [1e-09, 1e+12] rad/s^2"},
      {"acceleration_limit: 0.05", "velocity_scale: 1e-300", "approach.velocity_scale",
       "in [1e-06, 1]"},
      {"rate: 5 deg/s", "rate: 1e3", "angular_velocity.rate", "in [-100, 100] rad/s"},
      {"rate: 5 deg/s", "rate: 1e9", "angular_velocity.rate", "in [-100, 100] rad/s"},
      {"rate: 5 deg/s", "rate: 50", "angular_velocity", "must be <= 10000 rad"},
      {"[-0.46, 0.18, 6.3]", "[1e300, 0, 0]", "target.state.position", "in [-100000, 100000] m"},
      {"time: 0 s", "time: -1e300", "target.state.time", "in [-1e+06, 1e+06] s"},
      {"  hand: hand", "  base: {position: [0, 1e300, 0]}\n  hand: hand", "robot.base.position",
       "in [-100000, 100000] m"},
      {"post_impact:", "post_impact:\n  base_rate_gain: 1e308", "post_impact.base_rate_gain",
       "in [0, 10000] 1/s"},
      {"post_impact:", "obstacles: [{name: a, geometry: {sphere: {radius: 1e6}}}]\npost_impact:",
       "sphere.radius", "in (0, 10000] m"},
      {"post_impact:",
       "obstacles: [{name: a, position: [1e8, 0, 0], geometry: {sphere: {radius: 1}}}]\n"
       "post_impact:",
       "obstacles[0].position", "in [-100000, 100000] m"},
      {"joint_limit_margin: 2 deg", "joint_limit_margin: 400 deg", "constraints.joint_limit_margin",
       "must be <="}};
  for (const Extreme& extreme : cases) {
    shop.write_changed("extreme.yaml", kEts7, extreme.from, extreme.to);
    for (const char* command : {"check extreme.yaml", "plan extreme.yaml --time-limit 1"}) {
      const Outcome outcome = shop.run(command);
      INFO(command << " with " << extreme.to << ": " << outcome.err.substr(0, 300));
      CHECK(outcome.code == 3);
      CHECK(outcome.says(extreme.key));
      CHECK(outcome.says(extreme.range));
    }
  }
}

TEST_CASE("angles that look like degrees without their unit are named") {
  const Workshop shop;
  shop.write_changed("angle.yaml", kEts7, "angle: 90 deg", "angle: 90");
  const Outcome angle = shop.run("check angle.yaml");
  CHECK(angle.code == 0);
  CHECK(shows(angle, "suspicious"));
  CHECK(shows(angle, "is 5156.62 deg; did you mean '90 deg'?"));
  CHECK_FALSE(shows(shop.run("check '" + source_path(kEts7) + "'"), "did you mean"));
  shop.write_changed("start.yaml", kEts7, "30 deg, 90 deg", "30, 90 deg");
  CHECK(shop.run("check start.yaml").says("did you mean '30 deg'?"));
  shop.write_changed("most.yaml", kEts7, "max: 30 deg", "max: 30");
  CHECK(shop.run("check most.yaml").says("did you mean '30 deg'?"));
}

TEST_CASE("angles that look like degrees are named where something else is refused") {
  const Workshop shop;
  const std::string name = "planar.yaml", planar = "problems/planar_three_link_client.yaml";
  // Folded into the base: refused for its place. With a wait that is none while it is read.
  shop.write_changed(name, planar, "start: [-0.72, 1.2, 0.72]", "start: [-41, 68.75, 41]");
  const std::string text = shop.text(name);
  for (const std::string rule : {"start-too-close", "out-of-range"}) {
    if (rule == "out-of-range") {
      shop.write(name, std::string(text).replace(text.find("wait: 5 s"), 9, "wait: -5 s"));
    }
    for (const std::string& command : {"check " + name, "plan " + name + " -o plan.json"}) {
      const Outcome outcome = shop.run(command);
      INFO(command << outcome.err);
      CHECK(outcome.code == 3);
      const std::size_t remark = outcome.err.find("did you mean '68.75 deg'?");
      const std::size_t reason = outcome.err.find(": " + rule + ": ");
      CHECK(outcome.err.rfind("suspicious:\n", 0) == 0);
      CHECK(remark < reason);
      CHECK(reason != std::string::npos);
      CHECK(count_of(outcome.err, "'68.75 deg'") == 1);
    }
  }
  CHECK_FALSE(shop.has("plan.json"));
}

TEST_CASE("check and plan refuse a start that is nearer than the approach's clearance") {
  const Workshop shop;
  const int line = shop.write_changed("near.yaml", kEts7, "start: [0,", "start: [0.001,");
  shop.write("near.yaml",
             shop.text("near.yaml")
                 .replace(shop.text("near.yaml").find("clearance: 0.02 m"), 17, "clearance: 2 m"));
  for (const std::string command : {"check near.yaml", "plan near.yaml -o plan.json"}) {
    const Outcome outcome = shop.run(command);
    INFO(command << outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.says("near.yaml:" + std::to_string(line) + ": start-too-close: robot.start"));
    CHECK(outcome.says("approach.clearance asks for 2 m"));
  }
  CHECK_FALSE(shop.has("plan.json"));
}

TEST_CASE("check tells a planar problem with a cone of the key cone_plane") {
  const Workshop shop;
  shop.write_changed("cone.yaml", kWedge, "  cone_plane: xy\n", "");
  const Outcome outcome = shop.run("check cone.yaml");
  CHECK(outcome.code == 0);
  CHECK(shows(outcome, "uncertainty.cone_plane"));
  CHECK(shows(outcome, "normal [0, 0, 1]"));
  CHECK_FALSE(shows(shop.run("check '" + source_path(kWedge) + "'"), "uncertainty.cone_plane"));
}

TEST_CASE("check shows the impulse direction and centroids as the robot file states them") {
  const Workshop shop;
  const Outcome stated = shop.run("check '" + source_path(kWedge) + "'");
  CHECK(shows(stated, "impulse: along (-0.866, -0.5, 0) in the base frame, as stated"));
  CHECK(shows(shop.run("check '" + source_path(kEts7) + "'"), "against the normal of plus_x"));
  // A latch has no direction of its impulse before the posture is known.
  const Outcome latch = shop.run("check '" + source_path("problems/deos_latch.yaml") + "'");
  CHECK(shows(latch, "latch: contact direction ("));
  CHECK_FALSE(shows(latch, "impulse: along"));
  CHECK_FALSE(shows(latch, "direction within"));
  // About another axis the frame of the joint is not that of the link, up to rounding errors.
  shop.write_changed("turned.urdf", "problems/robots/planar_two_link_a.urdf",
                     "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"1 2 0\"/>");
  const Outcome turned = shop.run("check turned.urdf");
  CHECK(shows(turned, "link_1: 100 kg, centroid (1, 0, 0) m in its frame"));
}

TEST_CASE("a key that is wrong is listed once") {
  const Workshop shop;
  for (const char* value : {"3", "[]", "{}"}) {
    shop.write_changed("twice.yaml", kEts7, "file: targets/client_50.yaml",
                       "file: " + std::string(value));
    const Outcome outcome = shop.run("check twice.yaml");
    CHECK(outcome.code == 3);
    CHECK(count_of(outcome.err, "target.file") == 1);
  }
}

TEST_CASE("verify keeps its time limit") {
  const Workshop shop;
  REQUIRE(shop.run("plan '" + source_path(kWedge) + "' -o plan.json").code == 0);
  const auto begin = std::chrono::steady_clock::now();
  const Outcome trials = shop.run("verify plan.json --trials 1000000 --time-limit 2 -o v.json");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
  INFO(trials.err);
  CHECK(trials.code == 6);
  CHECK(shop.has("v.json"));
  const Outcome checks = shop.run("verify plan.json --time-limit 0.001");
  CHECK(checks.code == 6);
  CHECK(checks.says("verdict: none"));
}
