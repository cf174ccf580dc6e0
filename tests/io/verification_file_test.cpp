#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/io/verification_file.hpp>

using namespace stillbase;

TEST_CASE("a verdict states every check, and null for what could not be evaluated or checked") {
  Verification verification;
  verification.claims = {
      {"impact", 1e-13, 1e-10, "1", true, "against the second dynamics"},
      {"approach", std::nullopt, 0, "m", false, "no path"},
      {"inputs_unchanged", std::nullopt, 0, "1", false, "no file", ClaimGroup::Inputs, false}};
  verification.claims[1].group = ClaimGroup::AfterContact;
  ControllerReport report;
  report.controller = "rns_damped";
  report.peak_base_rate = std::nan("");
  report.limits_met = {"joint 3 torque at 0.12 s"};
  verification.reports = {report};
  const std::string text = verification_to_json(verification, "abc");
  const auto json = nlohmann::ordered_json::parse(text);
  CHECK(json["format"] == "stillbase.verification");
  CHECK(json["version"] == 1);
  CHECK(json["content_sha256"] == "abc");
  CHECK(json["verdict"] == "fail");
  CHECK(json["claims"][0]["value"] == 1e-13);
  CHECK(json["claims"][0]["pass"] == true);
  CHECK(json["claims"][1]["value"].is_null());
  CHECK(json["claims"][1]["pass"] == false);
  CHECK(json["claims"][1]["detail"] == "no path");
  CHECK(json["claims"][1]["group"] == "after_contact");
  CHECK(json["claims"][2]["group"] == "inputs");
  CHECK(json["claims"][2]["pass"].is_null());
  CHECK(json["post_impact"][0]["peak_base_rate"].is_null());
  CHECK(json["post_impact"][0]["limits_met"].size() == 1);
  verification.pass = true;
  CHECK(nlohmann::json::parse(verification_to_json(verification, "abc"))["verdict"] == "pass");
}

TEST_CASE("a check whose value is not finite is not written") {
  Verification verification;
  verification.claims = {{"impact", std::nan(""), 0, "1", false, ""}};
  CHECK_THROWS_AS(verification_to_json(verification, "abc"), std::invalid_argument);
}

TEST_CASE("outcomes of trials read back, and what is no such list is refused") {
  TrialOutcome outcome;
  outcome.inputs.assign(trial_input_names().size(), 0.1);
  outcome.stop_hits = 3;
  const std::string text = trial_outcomes_to_text({outcome, outcome});
  CHECK(trial_outcomes_to_text(trial_outcomes_from_text(text)) == text);
  CHECK(trial_outcomes_from_text("[]").empty());
  const std::string row = trial_outcomes_to_text({outcome});
  const std::string begin = row.substr(0, row.rfind("3,"));  // without the rest of the row
  REQUIRE(trial_outcomes_from_text(begin + "3,0,0,false]]").size() == 1);
  for (const char* end : {"1e300,0,0,false]]", "4294967299,0,0,false]]", "3.5,0,0,false]]",
                          "\"3\",0,0,false]]", "3,0,0,1]]", "3,0,0]]", "3,0,0,false,4]]"}) {
    INFO(end);
    CHECK_THROWS_AS(trial_outcomes_from_text(begin + end), InputError);
  }
  const std::string map = "{\"row\": " + row.substr(1, row.size() - 2) + "}";
  for (const std::string& other : {std::string("5"), std::string("{}"), map}) {
    INFO(other);
    CHECK_THROWS_AS(trial_outcomes_from_text(other), InputError);
  }
}
