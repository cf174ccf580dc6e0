// Files that are not what they were, and commands that would write over what they read.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include <stillbase/core/sha256.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

namespace {

const char* const kProblem = "planar_two_link_c2_a.yaml";

/// The text with its fingerprint made to fit again.
std::string with_fingerprint(json document) {
  json content = document;
  for (const char* key : {"tool", "timing", "verification", "content_sha256"}) content.erase(key);
  document["content_sha256"] = stillbase::sha256_hex(content.dump());
  return document.dump();
}

const json& claim_of(const json& verification, std::string_view name) {
  for (const json& claim : verification.at("claims")) {
    if (claim.at("name").get<std::string>() == name) return claim;
  }
  throw std::logic_error("no claim " + std::string(name));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

/// A folder with the problem and its plan.
class Planned : public Workshop {
 public:
  Planned() {
    write(kProblem, file_text(source_path(std::string("problems/") + kProblem)));
    if (run(std::string("plan ") + kProblem + " -o plan.json").code != 0) {
      throw std::runtime_error("no plan");
    }
    plan = json::parse(text("plan.json"));
  }
  json verify(const std::string& arguments) const {
    return json::parse(run("verify " + arguments).out);
  }
  json plan;
};

}  // namespace

TEST_CASE("a plan names its files, and a problem weakened inside it is found out") {
  const Planned shop;
  const json& inputs = shop.plan.at("inputs");
  REQUIRE(inputs.size() == 3);
  CHECK(inputs[0].at("role") == "problem");
  CHECK(inputs[0].at("path") == kProblem);
  CHECK(inputs[0].at("sha256") == stillbase::sha256_hex(shop.text(kProblem)));
  CHECK(inputs[1].at("sha256") ==
        stillbase::sha256_hex(shop.text(inputs[1].at("path").get<std::string>())));
  CHECK(claim_of(shop.verify("plan.json"), "inputs_unchanged").at("pass") == true);

  json weaker = shop.plan;
  weaker["problem"]["constraints"]["case"] = "none";
  shop.write("weaker.json", with_fingerprint(weaker));
  const json verdict = shop.verify("weaker.json");
  CHECK(claim_of(verdict, "content_fingerprint").at("pass") == true);
  const json& claim = claim_of(verdict, "inputs_unchanged");
  CHECK(claim.at("pass") == false);
  CHECK(claim.at("detail").get<std::string>().find("'constraints'") != std::string::npos);

  // Optimizer, seed and starts belong to the command line.
  REQUIRE(shop.run(std::string("plan ") + kProblem + " --seed 3 --starts 200 -o other.json").code ==
          0);
  CHECK(claim_of(shop.verify("other.json"), "inputs_unchanged").at("pass") == true);
}

TEST_CASE("files that changed after the plan are found, absent ones are said not to be compared") {
  const Planned shop;
  shop.write("moved.yaml", shop.text(kProblem));
  shop.write(kProblem, shop.text(kProblem) + "# a remark\n");
  const json remarked = shop.verify("plan.json");
  CHECK(claim_of(remarked, "inputs_unchanged").at("pass") == false);
  CHECK(claim_of(shop.verify("plan.json --problem moved.yaml"), "inputs_unchanged").at("pass") ==
        true);
  std::filesystem::remove(shop.path(kProblem));
  const json absent = shop.verify("plan.json");
  const json& claim = claim_of(absent, "inputs_unchanged");
  CHECK(claim.at("pass").is_null());
  CHECK(claim.at("detail").get<std::string>().find("not compared") == 0);
  CHECK(absent.at("verdict") == "pass");
}

TEST_CASE("every file of the problem is named once, with its path") {
  const Planned shop;
  const auto detail_of = [&](const json& altered) {
    shop.write("altered.json", with_fingerprint(altered));
    const json verdict = shop.verify("altered.json");
    CHECK(claim_of(verdict, "content_fingerprint").at("pass") == true);
    const json& claim = claim_of(verdict, "inputs_unchanged");
    CHECK(claim.at("pass") == false);
    return claim.at("detail").get<std::string>();
  };
  json other_path = shop.plan;
  other_path["inputs"][1]["path"] = "robots/another.urdf";
  CHECK(detail_of(other_path).find("robots/another.urdf") != std::string::npos);

  json twice = shop.plan;
  twice["inputs"][2] = twice["inputs"][1];
  const std::string target = shop.plan["inputs"][2]["path"];
  CHECK(detail_of(twice).find("the target file " + target + " is not among") != std::string::npos);

  json one_more = shop.plan;
  one_more["inputs"].push_back(one_more["inputs"][1]);
  CHECK(detail_of(one_more).find("no robot file") != std::string::npos);

  // The paths are those in the problem's text, wherever the plan is verified.
  std::filesystem::create_directory(shop.path("elsewhere"));
  const Outcome elsewhere =
      shop.run_script("cd elsewhere && '" STILLBASE_TOOL "' verify ../plan.json");
  CHECK(claim_of(json::parse(elsewhere.out), "inputs_unchanged").at("pass") == true);
}

TEST_CASE("a changed plan is neither simulated nor checked nor tried") {
  const Planned shop;
  json changed = shop.plan;
  changed["configuration"]["joint_positions"][0] = 0.5;
  shop.write("changed.json", changed.dump());
  shop.write("spec.yaml", "format: stillbase.campaign\nversion: 1\nplans: [changed.json]\n");
  for (const char* command : {"simulate changed.json --controller rns", "check changed.json",
                              "campaign make spec.yaml -o cases.jsonl"}) {
    const Outcome outcome = shop.run(command);
    INFO(command << outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.out.empty());
    CHECK(outcome.says("changed.json:1: fingerprint: content_sha256"));
  }
  CHECK(shop.run("simulate plan.json --controller rns").code == 0);
  CHECK(shop.run("check plan.json").code == 0);
}

TEST_CASE("nothing is written over what is read, or twice") {
  const Planned shop;
  for (const std::string& command :
       {std::string("plan ") + kProblem + " -o ./" + kProblem + " --force",
        std::string("simulate plan.json --controller rns --trace plan.json --force"),
        std::string("simulate plan.json --controller rns --trace x.out --plot ./x.out")}) {
    const Outcome outcome = shop.run(command);
    INFO(command << outcome.err);
    CHECK(outcome.code == 2);
  }
  CHECK(json::parse(shop.text("plan.json")) == shop.plan);
  CHECK(shop.text(kProblem).rfind("#", 0) == 0);
}

TEST_CASE("a campaign that names a file or seed twice is refused at its line") {
  const Planned shop;
  const std::string head = "format: stillbase.campaign\nversion: 1\n";
  shop.write("twice.yaml", head + "plans:\n  - plan.json\n  - plan.json\n");
  CHECK(shop.run("campaign make twice.yaml").says("twice.yaml:5: duplicate-name: plans"));
  shop.write("seeds.yaml", head + "plans: [plan.json]\nseeds: [1, 2, 1]\n");
  CHECK(shop.run("campaign make seeds.yaml").says("seeds.yaml:4: duplicate-name: seeds"));
  shop.write("names.yaml", head + "plans: [plan.json, ./plan.json]\n");
  const Outcome two_names = shop.run("campaign make names.yaml");
  CHECK(two_names.code == 3);
  CHECK(two_names.says("names.yaml: duplicate-case: plans"));
}

TEST_CASE("trials that a signal ends are marked in the verdict") {
  const Planned shop;
  const Outcome outcome =
      shop.run_script("'" STILLBASE_TOOL
                      "' verify plan.json --trials 1000000 -o verdict.json & p=$!; sleep 6; "
                      "kill -TERM $p; wait $p");
  INFO(outcome.err);
  CHECK(outcome.code == 143);
  REQUIRE(shop.has("verdict.json"));
  const json verdict = json::parse(shop.text("verdict.json"));
  if (verdict.contains("trials")) {
    CHECK(verdict.at("trials").at("interrupted") == true);
    CHECK(verdict.at("trials").at("wanted") == 1000000);
    CHECK(verdict.at("trials").at("count").get<int>() < 1000000);
  } else {
    CHECK(verdict.at("interrupted") == true);  // stopped before the trials began
  }
}

TEST_CASE("how good the instantaneous impact is, as a table") {
  const Workshop shop;
  shop.write("hard.yaml", file_text(source_path("problems/servicer_6dof_held.yaml")));
  const Outcome outcome = shop.run("simulate hard.yaml --contact-table --json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json table = json::parse(outcome.out);
  CHECK(table.at("format") == "stillbase.contact_table");
  const json& rows = table.at("rows");
  REQUIRE(rows.size() == 7);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    REQUIRE(rows[i].at("ended") == true);
    const double before = rows[i - 1].at("velocity_error"), now = rows[i].at("velocity_error");
    CHECK(now < 0.5 * before);  // of order 1/sqrt(stiffness)
  }
  CHECK(rows.back().at("velocity_error").get<double>() < 1e-3);
  CHECK(rows.back().at("momentum_error").get<double>() < 1e-9);

  // A servo holds the joints in part; its formula is better the shorter the contact.
  shop.write("iiwa.yaml", file_text(source_path("problems/iiwa_client_50.yaml")));
  const Outcome servo = shop.run("simulate iiwa.yaml --contact-table --servo 200 5 --json");
  REQUIRE(servo.code == 0);
  const json held = json::parse(servo.out);
  CHECK(held.at("joint_resistance") == "servo");
  CHECK(held.at("rows").back().at("ended") == true);
  for (const json& row : held.at("rows")) {
    if (row.at("ended") == false) continue;  // the servo presses on
    CHECK(row.at("velocity_error").get<double>() <
          row.at("velocity_error_free_joints").get<double>());
  }
  shop.write("locked.yaml", replaced(shop.text("hard.yaml"), "rotor_inertia, rotor_inertia: 5",
                                     "locked, locked: all"));
  CHECK(shop.run("simulate locked.yaml --contact-table").code == 2);
  const Outcome latch =
      shop.run("simulate " + source_path("problems/servicer_latch.yaml") + " --contact-table");
  CHECK(latch.code == 2);
  CHECK(latch.err.find("impact.contact 'normal' alone") != std::string::npos);
}
