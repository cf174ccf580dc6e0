// Shipped problems that no posture solves: which limit, by how much, and the exit code.
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;

TEST_CASE("captures that break a limit after the grasp in every posture name it", "[.slow]") {
  const Workshop shop;
  const auto plan = [&](const std::string& name, const std::string& limit,
                        const std::string& words) {
    INFO(name);
    const Outcome run =
        shop.run("plan '" + source_path("problems/" + name + ".yaml") + "' -o " + name + ".json");
    INFO(run.err);
    CHECK(run.code == 4);
    CHECK(run.says("no configuration was found that keeps the limits after the impact: " + words));
    const auto file = nlohmann::json::parse(shop.text(name + ".json"));
    const auto& tightest = file.at("managed_momentum").at("limits").at(0);
    CHECK(tightest.at("limit") == limit);
    CHECK(tightest.at("margin").get<double>() < -0.3 * tightest.at("most").get<double>());
    CHECK(run.says("what may help: "));
  };
  plan("detumble_wheels_too_small", "wheel_momentum", "wheel momentum of ");
  plan("detumble_grip_too_weak", "grip_moment", "grip moment of hand: ");
}

TEST_CASE("what may help where a grip is too weak was tried") {
  const Workshop shop;
  const auto plan = [&](const std::string& moment) {
    shop.write_changed("problem.yaml", "problems/detumble_grip_too_weak.yaml", "moment: 0.02 N m",
                       "moment: " + moment + " N m");
    return shop.run("plan problem.yaml --starts 16 -o plan.json --force");
  };
  const auto advised = [](const Outcome& outcome) {
    const std::string key = "what may help: post_impact.grip.moment of ";
    const std::size_t at = outcome.err.find(key);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = at + key.size();
    return outcome.err.substr(begin, outcome.err.find(' ', begin) - begin);
  };
  const Outcome weak = plan("0.02");
  INFO(weak.err);
  REQUIRE(weak.code == 4);
  CHECK(plan(advised(weak)).code == 0);
  // A little more than the load keeps the grip, and lets the controller brake too late.
  const std::size_t next = weak.err.find("(with ");
  REQUIRE(next != std::string::npos);
  const std::string slight = weak.err.substr(next + 6, weak.err.find(' ', next + 6) - next - 6);
  const Outcome stronger = plan(slight);
  INFO(stronger.err);
  REQUIRE(stronger.code == 4);
  CHECK(stronger.says("before the horizon of 60 s"));
  CHECK(plan(advised(stronger)).code == 0);
}

TEST_CASE("what may help where nothing leads away from a target that closes in helps") {
  const Workshop shop;
  const auto plan = [&](const std::string& velocity) {
    shop.write_changed("problem.yaml", "problems/matched_light.yaml", "hand_velocity: match_all",
                       "hand_velocity: " + velocity);
    return shop.run("plan problem.yaml -o plan.json --force");
  };
  const Outcome open = plan("{angular: [0.2 deg/s, 0, 0]}");
  INFO(open.err);
  REQUIRE(open.code == 9);
  CHECK(open.says("contact.hand_velocity.linear of zero along the normal, approach.abort: false"));
  CHECK(open.says("hand and target close in at"));
  // They close in slowly here, and between two samples of such a path.
  CHECK(plan("{angular: [0, 0, 0.01]}").code == 9);
  CHECK(plan("{angular: [0.2 deg/s, 0, 0], linear: [0, 0, 0]}").code == 0);
  shop.write_changed("problem.yaml", "problems/matched_light.yaml", "hand_velocity: match_all",
                     "hand_velocity: {angular: [0.2 deg/s, 0, 0]}");
  const std::string text = shop.text("problem.yaml") + "\n";
  const std::size_t at = text.find("approach:\n") + 10;
  shop.write("problem.yaml", text.substr(0, at) + "  abort: false\n" + text.substr(at));
  CHECK(shop.run("plan problem.yaml -o plan.json --force").code == 0);
}

TEST_CASE("what may help where no posture keeps a constraint names its key") {
  const Workshop shop;
  shop.write_changed("problem.yaml", "problems/servicer_latch.yaml", "closing_speed_min: 0.005",
                     "closing_speed_min: 0.05");
  const Outcome run = shop.run("plan problem.yaml --starts 4 -o plan.json");
  INFO(run.err);
  CHECK(run.code == 4);
  CHECK(run.says("what may help: a smaller constraints.closing_speed_min, "));
  const std::string shipped = "problems/iiwa_fixed_start.yaml";
  const auto advice = [&](const std::string& limit) {
    shop.write_changed("problem.yaml", shipped, "constraints:\n",
                       "constraints:\n  " + limit + "\n");
    const Outcome tight = shop.run("plan problem.yaml --starts 2 -o plan.json --force");
    CHECK(tight.code == 4);
    return tight.err;
  };
  CHECK_THAT(advice("joint_rate_max: 0.0001"),
             Catch::Contains("a larger constraints.joint_rate_max"));
  CHECK_THAT(advice("coupling_singular_value_min: 1000"),
             Catch::Contains("a smaller constraints.coupling_singular_value_min"));
  CHECK_THAT(advice("jacobian_singular_value_min: 1000"),
             Catch::Contains("a smaller constraints.jacobian_singular_value_min"));
}

TEST_CASE("what may help where wheels are too small helps") {
  const Workshop shop;
  const std::string shipped = "problems/detumble_wheels_too_small.yaml";
  const std::string stated = "capacity: [1, 1, 1.2]";
  const auto plan = [&](const std::string& wheels, const std::string& base) {
    shop.write_changed("problem.yaml", shipped, stated, wheels);
    std::string text = shop.text("problem.yaml");
    const std::string floating = "  base: floating\n";
    text.replace(text.find(floating), floating.size(), "  base: " + base + "\n");
    shop.write("problem.yaml", text);
    return shop.run("plan problem.yaml --starts 16 -o plan.json --force");
  };
  const Outcome small = plan("capacity: [2.3, 2.3, 2.3]", "held");
  INFO(small.err);
  REQUIRE(small.code == 4);
  CHECK(small.says("the status 'optimal' is that of the search alone; what may help: "));
  const auto numbers_after = [&](const std::string& key) {
    const std::size_t at = small.err.find(key);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = small.err.find('(', at) + 1;
    return small.err.substr(begin, small.err.find(')', begin) - begin);
  };
  // A tenth more than it has to be: a wheel that is nearly full rests late.
  std::string capacity = "capacity: [";
  std::istringstream each(numbers_after("post_impact.wheels.capacity above"));
  for (std::string number; std::getline(each, number, ',');) {
    capacity += std::to_string(1.1 * std::stod(number)) + ", ";
  }
  capacity.replace(capacity.size() - 2, 2, "]");
  CHECK(plan(capacity, "held").code == 0);
  const std::string preset = numbers_after("post_impact.wheels.preset of");
  CHECK(plan("capacity: [2.35, 2.35, 2.35], preset: [" + preset + "]", "held").code == 0);

  const Outcome smallest = plan(stated, "held");
  CHECK(smallest.code == 4);
  CHECK(smallest.says("a preset is not enough"));
  // No preset goes with a base that floats.
  const Outcome floating = plan("capacity: [2.3, 2.3, 2.3]", "floating");
  CHECK(floating.code == 4);
  CHECK(floating.says("post_impact.wheels.capacity above"));
  CHECK_FALSE(floating.says("preset"));
}

TEST_CASE("momentum about an axis without a wheel asks for that wheel alone") {
  const Workshop shop;
  shop.write_changed("problem.yaml", "problems/detumble_client_1000.yaml",
                     "torque: [0.15, 0.15, 0.2]", "torque: [0.15, 0.15, 0]");
  const Outcome run = shop.run("plan problem.yaml --starts 16 -o plan.json");
  INFO(run.err);
  REQUIRE(run.code == 4);
  CHECK(run.says(" N m s, and there is no wheel about z (detumble)"));
  CHECK(run.says("post_impact.wheels.torque of (0.15, 0.15, 0.15) N m"));
  CHECK_FALSE(run.says("post_impact.wheels.capacity above"));
  CHECK_FALSE(run.says(" of 0 N m s"));
}

TEST_CASE("limits of the base are named together, with what they have to be") {
  const Workshop shop;
  const auto plan = [&](const std::string& rate, const std::string& attitude) {
    shop.write_changed("problem.yaml", "problems/detumble_client_1000.yaml",
                       "residual_base_rate_max: 0.02 deg/s", "residual_base_rate_max: " + rate);
    std::string text = shop.text("problem.yaml");
    const std::string stated = "attitude_change_max: 10 deg";
    text.replace(text.find(stated), stated.size(), "attitude_change_max: " + attitude);
    shop.write("problem.yaml", text);
    return shop.run("plan problem.yaml --starts 16 -o plan.json --force");
  };
  const Outcome tight = plan("0", "0.2 deg");
  INFO(tight.err);
  REQUIRE(tight.code == 4);
  CHECK(tight.says("keeps the limits after the impact: attitude change of the base "));
  CHECK(tight.says(" deg of 0.2 deg, base rate at the horizon "));
  CHECK(tight.says(" deg/s of 0 deg/s"));
  CHECK_FALSE(tight.says("joint_limit_margin"));
  const auto advised = [&](const std::string& key) {
    const std::string words = "post_impact." + key + " of ";
    const std::size_t at = tight.err.find(words);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = at + words.size();
    return tight.err.substr(begin, tight.err.find(',', begin) - begin);
  };
  const Outcome wide = plan(advised("residual_base_rate_max"), advised("attitude_change_max"));
  INFO(wide.err);
  CHECK(wide.code == 0);
}

TEST_CASE("joint rates beyond a limit name the keys that are made for them") {
  const Workshop shop;
  std::string limits;
  for (int k = 1; k <= 6; ++k) {
    limits += (k > 1 ? ", joint_" : "joint_") + std::to_string(k) + ": {rate: 1.0e-4 deg/s}";
  }
  shop.write_changed("problem.yaml", "problems/servicer_6dof_held.yaml", "  hand: hand\n",
                     "  hand: hand\n  limits: {" + limits + "}\n");
  std::string text = shop.text("problem.yaml");
  const std::size_t at = text.find("approach:\n") + 10;
  text.insert(at, "  enabled: false\n");
  shop.write("problem.yaml", text);
  const Outcome run = shop.run("plan problem.yaml --starts 8 -o plan.json");
  INFO(run.err);
  REQUIRE(run.code == 4);
  CHECK(run.says("keeps the limits after the impact: joint_"));
  CHECK(run.says(" exceeds its rate limit"));
  CHECK(run.says("constraints.joint_rate_scale of 1 or less"));
  CHECK(run.says(", robot.limits.joint_"));
  CHECK_FALSE(run.says("joint_limit_margin"));
}

TEST_CASE("no smaller closing speed is advised where the target recedes from everything") {
  const Workshop shop;
  shop.write_changed("problem.yaml", "problems/servicer_latch.yaml",
                     "linear_velocity: [-0.015, 0, 0]", "linear_velocity: [0.2, 0, 0]");
  const Outcome run = shop.run("plan problem.yaml --starts 4 -o plan.json");
  INFO(run.err);
  REQUIRE(run.code == 4);
  CHECK(run.says("what may help: a target that comes faster, or turns slower"));
  for (const char* useless : {"constraints.closing_speed_min,", "variables.base_attitude",
                              "widen variables.contact_time", "search.starts"}) {
    CHECK_FALSE(run.says(useless));
  }
}

TEST_CASE("what may help where the motion is too slow is what limits it") {
  const Workshop shop;
  const auto plan = [&](const std::string& limits) {
    shop.write_changed("problem.yaml", "problems/servicer_6dof_held.yaml",
                       "  acceleration_limit: 0.05\n  velocity_scale: 0.5\n", limits);
    return shop.run("plan problem.yaml --starts 4 -o plan.json --force");
  };
  const auto advised = [](const Outcome& outcome, const std::string& key) {
    const std::size_t at = outcome.err.find(key);
    REQUIRE(at != std::string::npos);
    return std::stod(outcome.err.substr(at + key.size()));
  };
  const Outcome rates = plan("  acceleration_limit: 100\n  velocity_scale: 1e-3\n");
  INFO(rates.err);
  REQUIRE(rates.code == 9);
  CHECK_FALSE(rates.says("approach.acceleration_limit"));
  CHECK_FALSE(rates.says("later variables.contact_time"));
  const double scale = advised(rates, "an approach.velocity_scale of ");
  CHECK(plan("  acceleration_limit: 100\n  velocity_scale: " + std::to_string(1.2 * scale) + "\n")
            .code == 0);
  const Outcome slow = plan("  acceleration_limit: 1.0e-5\n  velocity_scale: 1\n");
  INFO(slow.err);
  REQUIRE(slow.code == 9);
  CHECK_FALSE(slow.says("approach.velocity_scale"));
  const double factor = advised(slow, "an approach.acceleration_limit ");
  CHECK(plan("  acceleration_limit: " + std::to_string(1.5e-5 * factor) + "\n  velocity_scale: 1\n")
            .code == 0);
}
