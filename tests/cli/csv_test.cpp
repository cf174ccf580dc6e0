// Names with commas and quotes in comma-separated values.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

/// The records of RFC 4180.
std::vector<std::vector<std::string>> records_of(const std::string& text) {
  std::vector<std::vector<std::string>> records(1, {""});
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      if (is_quoted && i + 1 < text.size() && text[i + 1] == '"') {
        records.back().back() += text[++i];
      } else {
        is_quoted = !is_quoted;
      }
    } else if (!is_quoted && c == ',') {
      records.back().emplace_back();
    } else if (!is_quoted && c == '\n') {
      records.push_back({""});
    } else {
      records.back().back() += c;
    }
  }
  records.pop_back();  // after the last end of line
  return records;
}

/// Runs what writes a CSV file, whose records have to be of one length and to have a field with
/// this name.
void check_csv(const Workshop& shop, const std::string& arguments, const std::string& field) {
  CAPTURE(arguments);
  const Outcome outcome = shop.run(arguments + " -o out.csv --force");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto records = records_of(shop.text("out.csv"));
  REQUIRE(records.size() > 1);
  bool is_there = false;
  for (const auto& record : records) {
    CHECK(record.size() == records.front().size());
    for (const std::string& text : record) is_there = is_there || text.find(field) == 0;
  }
  CHECK(is_there);
}

}  // namespace

TEST_CASE("every CSV quotes names of joints, features and targets that need it") {
  const Workshop shop;
  shop.write_changed("robots/iiwa_on_cube.urdf", "problems/robots/iiwa_on_cube.urdf",
                     "<joint name=\"joint_2\"", "<joint name=\"elbow, &quot;2&quot;\"");
  shop.write_changed("targets/client_50.yaml", "problems/targets/client_50.yaml", "name: plus_x",
                     "name: 'plus, \"x\"'");
  shop.write_changed("without_path.yaml", "problems/iiwa_client_50.yaml", "approach:\n",
                     "approach:\n  enabled: false\n");
  std::string text = shop.text("without_path.yaml");
  const std::string stated = "feature: plus_x";
  text.replace(text.find(stated), stated.size(), "feature: 'plus, \"x\"'");
  shop.write("problem.yaml", text);
  const std::string joint = "elbow, \"2\"_", feature = "plus, \"x\"";

  shop.write_changed("robots/spart_sc_3dof.urdf", "problems/robots/spart_sc_3dof.urdf",
                     "<joint name=\"joint_2\"", "<joint name=\"elbow, &quot;2&quot;\"");
  shop.write_changed("direction.yaml", "problems/spart_sticking.yaml", "joint_2: -100 deg",
                     "'elbow, \"2\"': -100 deg");
  check_csv(shop, "analyze direction.yaml --sweep-direction 8", joint);
  check_csv(shop, "plan problem.yaml --starts 4 --pareto base_angular_momentum,joint_rate_norm",
            joint);
  check_csv(shop, "predict problem.yaml --from 70 --to 71 --step 1", feature);
  REQUIRE(shop.run("plan problem.yaml --starts 8 -o plan.json").code == 0);
  check_csv(
      shop,
      "replan plan.json --estimates '" + source_path("problems/streams/iiwa_client_50.csv") + "'",
      joint);
  check_csv(shop, "check problem.yaml", feature);
}
