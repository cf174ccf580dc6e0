// stillbase export from the shell.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const std::string kPlanned = "'" + source_path("problems/planar_three_link_client.yaml") + "'";

}  // namespace

TEST_CASE("export writes by the ending, or by --format to any file or to stdout") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kPlanned + " -o plan.json").code == 0);
  const std::pair<const char*, const char*> begins[] = {
      {"a.csv", "time_s,joint_1_position_rad"},
      {"a.yaml", "# trajectory_msgs"},
      {"a.yml", "# trajectory_msgs"},
      {"a.aem", "CCSDS_AEM_VERS       = 2.0\n"},
      {"a.oem", "CCSDS_OEM_VERS       = 2.0\n"},
      {"a.mat", "MATLAB 5.0 MAT-file"},
      {"a.urdf", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"}};
  for (const auto& [name, begin] : begins) {
    INFO(name);
    const Outcome outcome = shop.run(std::string("export plan.json -o ") + name);
    CHECK(outcome.code == 0);
    CHECK(outcome.out.empty());
    CHECK(shop.text(name).rfind(begin, 0) == 0);
    CHECK(shop.run(std::string("export plan.json -o ") + name).code == 7);
  }
  CHECK(shop.run("export plan.json --format csv").out == shop.text("a.csv"));
  CHECK(shop.run("export plan.json --format csv -o a.txt").code == 0);
  CHECK(shop.text("a.txt") == shop.text("a.csv"));
  const Outcome robot = shop.run("check a.urdf --hand hand");
  CHECK(robot.code == 0);
}

TEST_CASE("the same plan exports the same bytes when the date is stated") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kPlanned + " -o plan.json").code == 0);
  const std::string dated =
      "SOURCE_DATE_EPOCH=1772366400 '" STILLBASE_TOOL "' export plan.json --object target ";
  REQUIRE(shop.run_script(dated + "-o a.aem && sleep 1 && " + dated + "-o b.aem").code == 0);
  CHECK(shop.text("a.aem") == shop.text("b.aem"));
  CHECK(shop.text("a.aem").find("CREATION_DATE        = 2026-03-01T12:00:00\n") !=
        std::string::npos);
  CHECK(
      shop.run_script("SOURCE_DATE_EPOCH=x '" STILLBASE_TOOL "' export plan.json -o c.aem").code ==
      2);
}

TEST_CASE("what cannot be exported is refused with its reason") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kPlanned + " -o plan.json").code == 0);
  const auto refuses = [&shop](const std::string& arguments, int code, const std::string& reason) {
    const Outcome outcome = shop.run("export " + arguments);
    INFO(arguments << "\n" << outcome.err);
    CHECK(outcome.code == code);
    CHECK(outcome.says(reason));
    CHECK_FALSE(shop.has("out.aem"));
  };
  refuses("plan.json", 2, "-o FILE, or --format");
  refuses("plan.json -o out.txt", 2, "this command writes .csv, .yaml, .yml, .aem, .oem, .mat");
  refuses("plan.json -o out.aem --format eam", 2, "did you mean 'aem'?");
  refuses("plan.json -o out.aem --object taget", 2, "did you mean 'target'?");
  refuses("plan.json -o out.aem --epoch tomorrow", 2, "'tomorrow' is no date");
  refuses("plan.json -o out.aem --ref-frame 'a\nb'", 2, "printable characters");
  refuses("missing.json -o out.aem", 3, "missing.json");

  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  plan.at("approach").at("times").at(0) = 1.0;
  shop.write("changed.json", plan.dump());
  refuses("changed.json -o out.aem", 3, "changed.json");

  shop.write_changed("problem.yaml", "problems/planar_three_link_client.yaml", "  base: held\n",
                     "  enabled: false\n  base: held\n");
  REQUIRE(shop.run("plan problem.yaml -o still.json").code == 0);
  refuses("still.json -o out.aem", 3, "still.json: no-approach: the plan has no approach path");
  CHECK(shop.run("export still.json -o still.mat").code == 0);
  CHECK(shop.run("export still.json -o still.urdf").code == 0);
}
