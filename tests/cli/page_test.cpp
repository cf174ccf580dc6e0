// What the page of a plan draws.
#include <catch2/catch.hpp>
#include <cmath>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

TEST_CASE("a page moves a target on that was met without slip as the hand moves") {
  const Workshop shop;
  const std::string problem = source_path("problems/spart_sticking.yaml");
  REQUIRE(shop.run("plan '" + problem + "' --starts 8 -o plan.json").code == 0);
  REQUIRE(shop.run("report plan.json -o plan.html").code == 0);
  const std::string page = shop.text("plan.html");
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  const json data = json::parse(page.substr(from, page.find("</script", from) - from));
  for (const json& after : data.at("documents")[0].at("scene").at("after")) {
    CAPTURE(after.at("controller"));
    // Along the normal both move alike; the impulse has a part across it.
    CHECK(std::abs(after.at("closing_speeds")[0].get<double>()) < 1e-9);
  }
}
