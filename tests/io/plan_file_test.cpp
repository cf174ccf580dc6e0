#include <cmath>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/state_file.hpp>

#include "io/io_support.hpp"
#include "io/plan_samples.hpp"
#include "io/problem_text.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

const ToolVersions kTool{{"stillbase", "0.1.0"}, {"eigen", "3.4.0"}};

/// Rule of the only finding.
std::string refusal(const std::string& text) {
  const auto findings = findings_of([&] { read_plan(text, "plan.json"); });
  INFO(text_of(findings));
  CHECK(findings.size() == 1);
  if (findings.empty()) return {};
  CHECK(findings[0].file == "plan.json");
  CHECK(findings[0].line > 0);
  return findings[0].rule;
}

}  // namespace

TEST_CASE("a plan reads back bit for bit") {
  const Plan plan = random_plan();
  const std::string text = plan_to_json(plan, kTool);
  const PlanFile file = read_plan(text, "plan.json");
  CHECK(plan_to_json(file.plan, file.tool) == text);
  CHECK(file.stated_sha256 == file.computed_sha256);
  CHECK(file.stated_robot_sha256 == file.computed_robot_sha256);
  CHECK(file.plan.configuration.phi == plan.configuration.phi);
  CHECK(file.plan.impact.coupling == plan.impact.coupling);
  CHECK(std::signbit(file.plan.impact.coupling.y()));
  CHECK(file.plan.constraints[0].upper == kInfinity);
  CHECK(file.plan.constraints[2].lower == -kInfinity);
  CHECK(file.plan.approach.detail == plan.approach.detail);
  CHECK(file.plan.approach.base_poses[2].orientation.coeffs() ==
        plan.approach.base_poses[2].orientation.coeffs());
  CHECK(file.plan.approach.base_velocities[1] == plan.approach.base_velocities[1]);
  CHECK(file.plan.solver_calls == plan.solver_calls);
  CHECK(file.plan.timing == plan.timing);
  CHECK(file.plan.problem.urdf == plan.problem.urdf);
  CHECK(file.plan.impact.resistance.stiffness == plan.impact.resistance.stiffness);
}

TEST_CASE("a certificate without a direction left says null and reads back") {
  Plan plan = random_plan();
  plan.certificate.reduced_hessian_min_eigenvalue.reset();
  const std::string text = plan_to_json(plan, kTool);
  const auto json = nlohmann::json::parse(text);
  CHECK(json["certificate"]["reduced_hessian_min_eigenvalue"].is_null());
  CHECK(plan_to_json(read_plan(text, "plan.json").plan, kTool) == text);
}

TEST_CASE("where there is a choice of features a plan says which one each configuration meets") {
  Random random(8);
  Plan plan;
  plan.problem = read_problem(source_path("problems/deos_features.yaml"));
  const int n = plan.problem.robot.n();
  const auto at = [&](const std::string& feature) {
    return Configuration{random_joints(random, n), random_pose(random), 59, feature};
  };
  plan.configuration = at("lower_edge");
  plan.impact.Delta_phidot = plan.impact.Delta_phidot_rns = plan.impact.Delta_phidot_orthogonal =
      random_joints(random, n);
  plan.impact.resistance = plan.problem.resistance;
  plan.objective.terms = {{"base_angular_momentum", 0.3}};
  plan.nominal_optimum = NominalOptimum{at("upper_edge"), 0.1, 0.2, 0.2};
  plan.candidates.resize(2);
  plan.candidates[0].configuration = at("upper_edge");
  plan.candidates[1].configuration = plan.configuration;
  const std::string text = plan_to_json(plan, kTool);
  const Plan again = read_plan(text, "plan.json").plan;
  CHECK(plan_to_json(again, kTool) == text);
  CHECK(again.configuration.feature == "lower_edge");
  CHECK(again.problem.variables.feature == "lower_edge");
  CHECK(again.problem.variables.features == plan.problem.variables.features);
  CHECK(again.candidates[0].configuration.feature == "upper_edge");
  CHECK(again.nominal_optimum->configuration.feature == "upper_edge");
  auto json = nlohmann::json::parse(text);
  json["candidates"][0]["feature"] = "side_edge";
  CHECK(refusal(json.dump()) == "unknown-name");
  json["candidates"][0].erase("feature");
  CHECK(refusal(json.dump()) == "missing-key");
}

TEST_CASE("the boxes of a proof name base angle and contact time where those are variables") {
  Plan plan = random_plan();
  plan.problem = read(kProblem);  // of the same robot
  Proof& proof = plan.certificate.proof;
  double end = -0.1 / 3;
  for (auto* boxes : {&proof.solutions, &proof.undecided}) {
    for (JointBox& box : *boxes) {
      box.base_angle = Ends{end, end + 1e-17};
      box.contact_time = Ends{60 + end, 61 + end};
      end += 0.1;
    }
  }
  const std::string text = plan_to_json(plan, kTool);
  const Plan again = read_plan(text, "plan.json").plan;
  CHECK(plan_to_json(again, kTool) == text);
  const JointBox& last = again.certificate.proof.undecided.back();
  CHECK(last.base_angle->lower == proof.undecided.back().base_angle->lower);
  CHECK(last.contact_time->upper == proof.undecided.back().contact_time->upper);
  for (const char* key : {"base_angle", "contact_time"}) {
    auto json = nlohmann::json::parse(text);
    auto& box = json["certificate"]["proof"]["solutions"][0];
    box[key] = {1};
    CHECK_FALSE(refusal(json.dump()).empty());
    box.erase(key);
    CHECK(refusal(json.dump()) == "missing-key");
    // Where it is no variable nobody asks for it.
    auto fixed = nlohmann::json::parse(plan_to_json(random_plan(), kTool));
    fixed["certificate"]["proof"]["solutions"][0][key] = {0, 1};
    CHECK(refusal(fixed.dump()) == "unknown-key");
  }
}

TEST_CASE("a proof that contradicts itself is refused") {
  auto json = nlohmann::json::parse(plan_to_json(random_plan(), kTool));
  auto spoiled = json;
  spoiled["certificate"]["proof"]["candidates"] = {1};
  CHECK(refusal(spoiled.dump()) == "wrong-length");
  spoiled = json;
  spoiled["certificate"]["proof"]["candidates"] = {1.5, -1};
  CHECK(refusal(spoiled.dump()) == "wrong-type");
  spoiled["certificate"]["proof"]["candidates"] = {1, -2};
  CHECK(refusal(spoiled.dump()) == "out-of-range");
  spoiled = json;
  spoiled["certificate"]["proof"]["status"] = "certain";
  CHECK_FALSE(refusal(spoiled.dump()).empty());
}

TEST_CASE("the keys of a plan file stand in their documented order") {
  const auto json = nlohmann::ordered_json::parse(plan_to_json(random_plan(), kTool, "{}"));
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  CHECK(keys == std::vector<std::string>{
                    "format",        "version",        "tool",          "inputs",
                    "problem",       "robot",          "status",        "optimizer",
                    "configuration", "impact",         "objective",     "constraints",
                    "certificate",   "candidates",     "choice",        "binding",
                    "families",      "approach",       "after_horizon", "managed_momentum",
                    "solver_calls",  "content_sha256", "verification",  "timing"});
}

TEST_CASE("a limit's margin is what its value leaves") {
  auto json = nlohmann::json::parse(plan_to_json(random_plan(), kTool));
  const Plan plan = read_plan(json.dump(), "plan.json").plan;
  REQUIRE(plan.managed_momentum);
  REQUIRE(plan.managed_momentum->limits.size() == 2);
  CHECK(plan.managed_momentum->limits[1].place == "hand");
  CHECK_FALSE(plan.managed_momentum->rest_time.has_value());
  json["managed_momentum"]["limits"][1]["margin"] = 0.5;
  CHECK(refusal(json.dump()) == "inconsistent");
}

TEST_CASE("a plan without choice, binding limits and time after the horizon is read as before") {
  auto json = nlohmann::json::parse(plan_to_json(random_plan(), kTool));
  for (const char* key : {"choice", "binding", "after_horizon", "managed_momentum"})
    json.erase(key);
  json["candidates"][0].erase("excluded");
  const Plan old = read_plan(json.dump(), "plan.json").plan;
  CHECK(old.choice.better == -1);  // not stated
  CHECK(old.binding.empty());
  CHECK_FALSE(old.after_horizon.has_value());
  CHECK_FALSE(old.managed_momentum.has_value());
  const auto again = nlohmann::json::parse(plan_to_json(old, kTool));
  CHECK_FALSE(again.contains("choice"));
  CHECK_FALSE(again["candidates"][0].contains("excluded"));
}

TEST_CASE("a plan keeps the files that it was made from") {
  const std::vector<InputFile> inputs{{"problem", "a/b.yaml", "00ff"}, {"robot", "c.urdf", "11"}};
  const std::string text = plan_to_json(random_plan(), kTool, {}, inputs);
  const PlanFile file = read_plan(text, "plan.json");
  REQUIRE(file.inputs.size() == 2);
  CHECK(file.inputs[0].role == "problem");
  CHECK(file.inputs[0].path == "a/b.yaml");
  CHECK(file.inputs[0].sha256 == "00ff");
  CHECK(file.inputs[1].role == "robot");
  CHECK(file.is_as_written());
  CHECK(refusal(replaced(text, "\"role\": \"robot\"", "\"role\": \"engine\"")) == "unknown-name");
}

TEST_CASE("the fingerprint covers the content and nothing else") {
  const std::string text = plan_to_json(random_plan(), kTool);
  auto json = nlohmann::json::parse(text);
  const std::string stated = json["content_sha256"];

  auto content = json;
  for (const char* key : {"tool", "timing", "verification", "content_sha256"}) content.erase(key);
  CHECK(sha256_hex(content.dump()) == stated);

  auto unchanged = json;
  unchanged["tool"]["stillbase"] = "9.9";
  unchanged["timing"]["search"] = 99;
  unchanged["verification"] = {{"verdict", "pass"}, {"anything", {1, 2}}};
  CHECK(read_plan(unchanged.dump(), "plan.json").computed_sha256 == stated);

  const std::vector<std::string> pointers{
      "/problem/robot/start/joint_1", "/configuration/joint_positions/0",
      "/impact/momentum/base/0",      "/objective/worst_case",
      "/candidates/1/objective",      "/approach/times/1",
      "/certificate/kkt_residual",    "/certificate/reduced_hessian_min_eigenvalue"};
  for (const std::string& pointer : pointers) {
    auto changed = json;
    auto& value = changed[nlohmann::json::json_pointer(pointer)];
    value = value.get<double>() * (1 + 1e-12) + 1e-305;
    INFO(pointer);
    const PlanFile file = read_plan(changed.dump(), "plan.json");
    CHECK(file.stated_sha256 == stated);
    CHECK(file.computed_sha256 != stated);
  }
}

TEST_CASE("a spoiled plan file is refused with rule and line") {
  const std::string text = plan_to_json(random_plan(), kTool);
  CHECK(refusal(replaced(text, "\"optimizer\"", "\"optimiser\": \"x\", \"optimizer\"")) ==
        "unknown-key");
  CHECK(refusal(replaced(text, "\"status\": \"feasible\"", "\"status\": \"good\"")) ==
        "unknown-name");
  CHECK(refusal(replaced(text, "\"status\": \"feasible\",", "")) == "missing-key");
  CHECK(refusal(replaced(text, "\"distinct_solutions\": 8", "\"distinct_solutions\": 2.5")) ==
        "wrong-type");
  CHECK(refusal(replaced(text, "\"closing_speed\": 0.7", "\"closing_speed\": NaN")) ==
        "not-finite");
  CHECK(refusal(replaced(text, "\"closing_speed\": 0.7", "\"closing_speed\": null")) ==
        "wrong-type");
  CHECK(refusal(replaced(text, "\"closing_speed\": 0.7", "\"closing_speed\": 0.7 m")) ==
        "wrong-unit");
  CHECK(refusal(replaced(text, "\"version\": 1", "\"version\": 1, \"version\": 1")) ==
        "duplicate-key");
  CHECK(refusal(replaced(text, "\"joint_names\": [\"joint_1\", ", "\"joint_names\": [")) ==
        "inconsistent");
  CHECK(refusal(replaced(text, "\"nominal\": 0.3", "\"nominal\": 0.2")) == "inconsistent");
  CHECK(refusal(replaced(text, "\"times\": [0.0, ", "\"times\": [")) == "wrong-length");
  CHECK(refusal(text.substr(0, text.size() / 2)) == "syntax");
  CHECK(refusal(text + "x: 1\n") == "several-documents");
  CHECK(refusal(text + "# YAML, not JSON\n") == "syntax");
}

TEST_CASE("a plan with a number that is not finite is not written") {
  const auto refuses = [](auto change) {
    Plan plan = random_plan();
    change(plan);
    CHECK_THROWS_AS(plan_to_json(plan, kTool), std::invalid_argument);
  };
  refuses([](Plan& p) { p.configuration.phi[0] = std::nan(""); });
  refuses([](Plan& p) { p.objective.worst_case = kInfinity; });
  refuses([](Plan& p) { p.constraints[0].lower = std::nan(""); });
  refuses([](Plan& p) { p.approach.base_velocities[1][3] = -kInfinity; });
  refuses([](Plan& p) { p.impact.Fbar[0] = kInfinity; });
  refuses([](Plan& p) { p.timing["search"] = std::nan(""); });
}

TEST_CASE("a state file fills what it leaves out with zeros") {
  const CaptureProblem problem = read_problem(source_path("problems/planar_two_link_c2_a.yaml"));
  const RobotState state =
      read_state(R"({"joint_positions": ["-80 deg", 1], "impulse": {"force": [1, 2, 3]}})",
                 "s.json", problem.robot);
  CHECK(state.phi[0] == Approx(-80 * M_PI / 180));
  CHECK(state.phidot == Eigen::Vector2d::Zero());
  CHECK(state.Omega.isZero(0));
  REQUIRE(state.Fbar);
  CHECK(state.Fbar->head<3>() == Vector3d(1, 2, 3));
  CHECK(state.Fbar->tail<3>() == Vector3d::Zero());
  CHECK_FALSE(read_state("{}", "s.json", problem.robot).Fbar);
}

TEST_CASE("a spoiled state file is refused with everything that is wrong") {
  const CaptureProblem problem = read_problem(source_path("problems/planar_two_link_c2_a.yaml"));
  const auto findings = findings_of([&] {
    read_state(
        "{\"joint_positions\": [1, 2, 3],\n\"joint_velocity\": [1, 2],\n"
        "\"base_velocity\": {\"linear\": [1, 2, NaN]}}",
        "s.json", problem.robot);
  });
  INFO(text_of(findings));
  REQUIRE(findings.size() == 3);
  CHECK(text_of(findings).find("s.json:2: unknown-key") != std::string::npos);
  CHECK(text_of(findings).find("did you mean 'joint_velocities'") != std::string::npos);
  CHECK(text_of(findings).find("s.json:3: not-finite") != std::string::npos);
  CHECK(text_of(findings).find("s.json:1: wrong-length") != std::string::npos);
}

TEST_CASE("a plan with long curves of solutions reads back") {
  Plan plan = random_plan();
  REQUIRE_FALSE(plan.families.empty());
  SolutionFamily& family = plan.families.front();
  family.points.assign(20000, plan.configuration);
  const PlanFile file = read_plan(plan_to_json(plan, kTool), "plan.json");
  REQUIRE(file.plan.families.size() == plan.families.size());
  CHECK(file.plan.families.front().points.size() == 20000);
}

TEST_CASE("a file that says that it is no plan is refused with that alone") {
  const auto problem = findings_of([&] {
    const std::string path = source_path("problems/iiwa_cone.yaml");
    read_plan(file_text(path), path);
  });
  REQUIRE(problem.size() == 1);
  CHECK(problem[0].rule == "format");
  CHECK(problem[0].line == 4);
  CHECK(problem[0].message.find("problem file") != std::string::npos);
  CHECK(problem[0].message.find("stillbase plan") != std::string::npos);
  const auto verdict = findings_of(
      [&] { read_plan("{\"format\": \"stillbase.verification\", \"version\": 1}", "v.json"); });
  REQUIRE(verdict.size() == 1);
  CHECK(verdict[0].message == "is 'stillbase.verification'; must be 'stillbase.plan'");
  // One that says nothing, or nonsense, is a bad plan.
  CHECK(findings_of([&] { read_plan("{\"format\": \"plan\"}", "v.json"); }).size() > 5);
}
