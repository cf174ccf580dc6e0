// Shipped problems that no posture solves: which limit, by how much, and the exit code.
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
    const auto& binding = file.at("managed_momentum").at("limits").at(0);
    CHECK(binding.at("limit") == limit);
    CHECK(binding.at("margin").get<double>() < -0.3 * binding.at("most").get<double>());
  };
  plan("detumble_wheels_too_small", "wheel_momentum", "wheel momentum of ");
  plan("detumble_grip_too_weak", "grip_moment", "grip moment of hand: ");
}
