#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

namespace {

constexpr const char* kProblem = "problems/planar_two_link_c2_a.yaml";

std::string quoted(const std::string& path) { return "'" + path + "'"; }

std::size_t columns_of(const json& matrix) { return matrix.at(0).size(); }

}  // namespace

TEST_CASE("the plan of the C2 problem lists eight configurations, five of them not free") {
  const Workshop shop;
  const std::string command = "plan " + quoted(source_path(kProblem)) + " -o ";
  const Outcome outcome = shop.run(command + "plan.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.says("8 distinct solutions"));
  const json plan = json::parse(shop.text("plan.json"));
  CHECK(plan.at("format") == "stillbase.plan");
  REQUIRE(plan.at("candidates").size() == 8);
  int blocked = 0;
  for (const json& candidate : plan.at("candidates")) {
    if (!candidate.at("collision_free").get<bool>()) ++blocked;
    CHECK(candidate.at("max_violation").get<double>() < 1e-9);
  }
  CHECK(blocked == 5);
  CHECK(plan.at("impact").at("case") == "C2");
  for (const json& residual : plan.at("impact").at("case_residuals")) {
    CHECK(residual.get<double>() < 1e-9);
  }
  CHECK(plan.at("approach").at("status") == "found");

  SECTION("the same command writes the same bytes, but for tool and timing") {
    REQUIRE(shop.run(command + "again.json").code == 0);
    json first = plan, second = json::parse(shop.text("again.json"));
    for (json* p : {&first, &second}) {
      p->erase("tool");
      p->erase("timing");
    }
    CHECK(first.dump() == second.dump());
  }
  SECTION("an existing file is replaced with --force only") {
    const std::string before = shop.text("plan.json");
    const Outcome refused = shop.run(command + "plan.json");
    CHECK(refused.code == 7);
    CHECK(refused.says("--force"));
    CHECK(shop.text("plan.json") == before);
    shop.write("plan.json", "old");
    CHECK(shop.run(command + "plan.json --force").code == 0);
    CHECK(json::parse(shop.text("plan.json")).at("format") == "stillbase.plan");
  }
  SECTION("check reads it and finds it unchanged") {
    const Outcome check = shop.run("check plan.json");
    CHECK(check.code == 0);
    CHECK(check.out.find("fingerprints of the content and of the robot: as stated") !=
          std::string::npos);
  }
  SECTION("simulate runs the plan's own impact") {
    const Outcome run = shop.run("simulate plan.json --controller rns_damped --json");
    REQUIRE(run.code == 0);
    const json result = json::parse(run.out).at("runs").at(0);
    CHECK(result.at("status") == "finished");
    CHECK(result.at("relative_momentum_drift").get<double>() < 1e-9);
  }
}

TEST_CASE("without an output file the plan is one JSON object on stdout, words go to stderr") {
  const Workshop shop;
  const Outcome outcome = shop.run("plan " + quoted(source_path(kProblem)) + " --starts 64");
  CHECK(outcome.code == 0);
  CHECK(json::parse(outcome.out).at("format") == "stillbase.plan");
  CHECK(outcome.says("momentum"));
}

TEST_CASE("an unreachable hand position is exit code 4 and writes the nearest attempt") {
  const Workshop shop;
  shop.write_changed("problem.yaml", kProblem, "constraint: none",
                     "constraint: position\n  position: [50, 0, 0]");
  std::string text = shop.text("problem.yaml");
  text.replace(text.find("  case: C2\n"), 11, "");
  shop.write("problem.yaml", text);
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json --starts 8");
  INFO(outcome.err);
  CHECK(outcome.code == 4);
  CHECK(outcome.says("no configuration satisfies the constraints"));
  CHECK(outcome.says("violates its bounds by"));
  CHECK(outcome.says("what may help: free variables.base_attitude, "));
  const json plan = json::parse(shop.text("plan.json"));
  CHECK(plan.at("status") == "infeasible");
  // The hand is 5.4 m from the base at most: 44.6 m are missing, whatever the posture.
  CHECK(plan.at("certificate").at("max_violation").get<double>() > 1);
  CHECK(plan.at("configuration").at("joint_positions").size() == 2);
}

TEST_CASE("a case that does not exist is said not to, with the nearest residual", "[proofs]") {
  const Workshop shop;
  // A moment about the hand that no lever of this arm (5.4 m) takes up.
  shop.write_changed("problem.yaml", kProblem, "  source: point_mass\n",
                     "  source: given\n  magnitude: 1 N s\n  moment: [0, 0, 50]\n");
  std::string text = shop.text("problem.yaml");
  for (const std::string line : {"  closing_speed: 1 m/s\n", "  restitution: 1\n"}) {
    const auto at = text.find(line);
    REQUIRE(at != std::string::npos);
    text.replace(at, line.size(), "");
  }
  shop.write("problem.yaml", text);
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json --starts 8");
  INFO(outcome.err);
  CHECK(outcome.code == 4);
  CHECK(outcome.says("no C2 here; residuals: total "));
  CHECK(outcome.says("proven: there is no solution"));
}

TEST_CASE("a contact that outlasts the simulation is said to be too soft, with its duration") {
  const Workshop shop;
  // Half a period of some 6 kg on 1 N/m is 7 s.
  shop.write_changed("problem.yaml", "problems/planar_three_link_client.yaml", "  horizon: 10 s\n",
                     "  horizon: 4 s\n  contact: {model: compliant, stiffness: 1 N/m}\n");
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json --starts 16");
  INFO(outcome.err);
  CHECK(outcome.code == 4);
  CHECK(outcome.says("still touch after the horizon of"));
  CHECK(outcome.says("a contact of 1 N/m between an effective"));
  CHECK(outcome.says("post_impact.contact.stiffness is too low"));
}

TEST_CASE("a short contact is not called too soft where the controller holds the hand there") {
  const Workshop shop;
  // Half a period of some 6 kg on 1e5 N/m is 0.02 s.
  const std::string horizon = "  horizon: 4 s\n  contact: {model: compliant, stiffness: 1e5 N/m}\n";
  shop.write_changed("problem.yaml", "problems/planar_three_link_client.yaml", "  horizon: 10 s\n",
                     horizon);
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json --starts 8");
  INFO(outcome.err);
  CHECK(outcome.code == 4);
  CHECK(outcome.says("still touch after the horizon of"));
  CHECK(outcome.says("the controller holds the hand against the target"));
  CHECK_FALSE(outcome.says("stiffness is too low"));
}

TEST_CASE("a time limit ends the search with exit code 6 and the best so far is written") {
  const Workshop shop;
  const Outcome outcome = shop.run("plan " + quoted(source_path(kProblem)) +
                                   " --starts 10000000 --time-limit 0.3 -o plan.json");
  INFO(outcome.err);
  CHECK(outcome.code == 6);
  CHECK(json::parse(shop.text("plan.json")).at("status") == "limit");
}

TEST_CASE("a signal ends the search, and what was finished is saved") {
  const Workshop shop;
  // Two seconds: the handler must be there before the signal, also on a busy machine.
  const Outcome outcome =
      shop.run_script("'" STILLBASE_TOOL "' plan " + quoted(source_path(kProblem)) +
                      " --starts 10000000 -o plan.json & p=$!; sleep 2; kill -TERM $p; wait $p");
  INFO(outcome.err);
  CHECK(outcome.code == 143);
  REQUIRE(shop.has("plan.json"));
  CHECK(json::parse(shop.text("plan.json")).at("status") == "limit");
}

TEST_CASE("a signal ends a long sweep, and the rows so far are saved") {
  const Workshop shop;
  const Outcome outcome = shop.run_script(
      "'" STILLBASE_TOOL "' analyze " +
      quoted(source_path("problems/planar_two_link_sweep_a.yaml")) +
      " --sweep-direction 1000000 -o sweep.csv & p=$!; sleep 2; kill -TERM $p; wait $p");
  INFO(outcome.err);
  CHECK(outcome.code == 143);
  CHECK(shop.has("sweep.csv"));
}

TEST_CASE("inspect prints every promised key with the promised shape") {
  const Workshop shop;
  shop.write("state.json",
             R"({"joint_positions": [0.1, -0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
                 "joint_velocities": [1, 2, 3, 4, 5, 6, 7],
                 "base_velocity": {"linear": [0.1, 0.2, 0.3], "angular": [0.3, 0.2, 0.1]},
                 "impulse": {"force": [1, 2, 3], "moment": [0, 0, 1]}})");
  const Outcome outcome =
      shop.run("inspect robots/iiwa_on_cube.urdf --hand hand --state state.json --json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json all = json::parse(outcome.out);
  const std::size_t n = 7;
  const struct {
    const char* key;
    std::size_t rows, columns;
  } matrices[] = {{"H_b", 6, 6},
                  {"H_bphi", 6, n},
                  {"H_phi", n, n},
                  {"J_phi", 6, n},
                  {"R_bh", 6, 6},
                  {"Htilde_omega", 3, 3},
                  {"Htilde_phi", n, n},
                  {"Htilde_omegaphi", 3, n},
                  {"Hhat_phi", n, n},
                  {"Jhat_phi", 6, n},
                  {"hand_inverse_inertia", 6, 6}};
  for (const auto& matrix : matrices) {
    INFO(matrix.key);
    REQUIRE(all.contains(matrix.key));
    CHECK(all.at(matrix.key).size() == matrix.rows);
    CHECK(columns_of(all.at(matrix.key)) == matrix.columns);
  }
  for (const auto& [key, size] : {std::pair<const char*, std::size_t>{"joint_names", n},
                                  {"centroid", 3},
                                  {"hand_position", 3},
                                  {"c_b", 6},
                                  {"c_phi", n},
                                  {"P", 3},
                                  {"L_g", 3},
                                  {"singular_values", 3}}) {
    INFO(key);
    REQUIRE(all.contains(key));
    CHECK(all.at(key).size() == size);
  }
  CHECK(all.at("rns_rank") == 3);
  CHECK(all.at("total_mass").get<double>() == Approx(all.at("H_b").at(0).at(0).get<double>()));
  const json& impact = all.at("impact");
  for (const char* key :
       {"impulse", "base_velocity_jump", "joint_velocity_jump", "joint_velocity_rns",
        "joint_velocity_orthogonal", "momentum", "case", "case_tolerance", "case_residuals",
        "rank_tolerance", "closing_speed", "joint_resistance", "joint_resistance_values"}) {
    INFO(key);
    CHECK(impact.contains(key));
  }
  // Two routes to the change of the total angular momentum: r_gh x f + t.
  const auto at = [&](const char* key, int i) { return all.at(key).at(i).get<double>(); };
  const double r[3] = {at("hand_position", 0) - at("centroid", 0),
                       at("hand_position", 1) - at("centroid", 1),
                       at("hand_position", 2) - at("centroid", 2)};
  const json& total = impact.at("momentum").at("total");
  CHECK(total.at(0).get<double>() == Approx(r[1] * 3 - r[2] * 2));
  CHECK(total.at(1).get<double>() == Approx(r[2] * 1 - r[0] * 3));
  CHECK(total.at(2).get<double>() == Approx(r[0] * 2 - r[1] * 1 + 1));
}

TEST_CASE("analyze sweeps the direction of the impulse as table, JSON and CSV") {
  const Workshop shop;
  const std::string command = "analyze " +
                              quoted(source_path("problems/planar_two_link_sweep_a.yaml")) +
                              " --sweep-direction 36";
  const Outcome outcome = shop.run(command + " --json");
  REQUIRE(outcome.code == 0);
  const json analysis = json::parse(outcome.out);
  CHECK(analysis.at("format") == "stillbase.analysis");
  const json& rows = analysis.at("rows");
  REQUIRE(rows.size() == 36);
  for (std::size_t i = 0; i < 36; ++i) {
    CHECK(rows[i].at("direction_deg").get<double>() == Approx(10.0 * static_cast<double>(i)));
    // Opposite impulses are of the same size and change the momentum the other way.
    const json &here = rows[i], &opposite = rows[(i + 18) % 36];
    CHECK(here.at("momentum").at("total").at(2).get<double>() ==
          Approx(-opposite.at("momentum").at("total").at(2).get<double>()).epsilon(0).margin(1e-9));
  }
  CHECK(shop.run(command + " -o sweep.csv").code == 0);
  const std::string csv = shop.text("sweep.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 37);
  CHECK(shop.run(command + " -o sweep.json").code == 0);
  CHECK(shop.text("sweep.json") == outcome.out);
  CHECK(shop.run(command + " -o sweep.txt").code == 2);
  const std::string table = shop.run(command).out;
  CHECK(std::count(table.begin(), table.end(), '\n') > 38);
  for (const char* part : {"locked", "rotor_inertia *", "145.48 deg", "63.99 deg", "5.20 deg"}) {
    INFO(part);
    CHECK(table.find(part) != std::string::npos);
  }
  CHECK(shop.run("analyze " + quoted(source_path("problems/iiwa_client_50.yaml")) +
                 " --sweep-direction 4")
            .code == 2);
}

TEST_CASE("analyze shows the impact under every joint resistance and the directions of its cases") {
  const Workshop shop;
  const std::string problem = quoted(source_path("problems/planar_two_link_sweep_a.yaml"));
  const Outcome outcome = shop.run("analyze " + problem + " --json");
  REQUIRE(outcome.code == 0);
  const json analysis = json::parse(outcome.out);
  const json& resistances = analysis.at("joint_resistances");
  REQUIRE(resistances.size() == 4);
  const auto size = [&](std::size_t i) {
    return std::abs(resistances[i].at("impulse").at("force").at(0).get<double>());
  };
  CHECK(resistances[0].at("joint_resistance") == "free");
  CHECK(resistances[3].at("joint_resistance") == "locked");
  CHECK_FALSE(resistances[0].at("illustrative").get<bool>());
  CHECK(resistances[1].at("illustrative").get<bool>());
  CHECK(size(0) == Approx(47.4735).epsilon(1e-5));
  for (const std::size_t i : {1U, 2U}) {
    CHECK(size(i) > size(0));
    CHECK(size(i) < size(3));
  }
  // The problem states free joints: its own row is the first of the comparison.
  CHECK(analysis.at("rows").at(0).at("momentum") == resistances[0].at("momentum"));
  // A push along the zero direction of the base part is a G2 impact.
  const json& zero = analysis.at("posture").at("zero_directions").at("in_xy_plane");
  CHECK(zero.at("base").at("directions").size() == 1);
  CHECK(zero.at("all").at("directions").empty());
  CHECK(analysis.at("posture").at("zero_directions").at("in_space").at("total").at("rank") == 2);
}

TEST_CASE("analyze gives no direction to an impulse that a matched hand makes vanish") {
  const Workshop shop;
  const Outcome matched = shop.run("analyze " + quoted(source_path("problems/matched_light.yaml")));
  REQUIRE(matched.code == 0);
  CHECK(matched.out.find("no impulse: hand and target have no relative velocity") !=
        std::string::npos);
  CHECK(matched.out.find("azimuth") == std::string::npos);
  const Outcome hit = shop.run("analyze " + quoted(source_path("problems/deos_latch.yaml")));
  REQUIRE(hit.code == 0);
  CHECK(hit.out.find("no impulse") == std::string::npos);
}

TEST_CASE("analyze shows the rates after the impact beside the momenta after it") {
  const Workshop shop;
  const std::string command = "analyze " + quoted(source_path("problems/matched_medium.yaml"));
  const Outcome outcome = shop.run(command);
  INFO(outcome.out);
  REQUIRE(outcome.code == 0);
  // The base moves before the impact, and the jump is rounding.
  const json impact = json::parse(shop.run(command + " --json").out).at("rows").at(0);
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double before = impact.at("before").at("base_velocity").at("angular").at(i);
    const double jump = impact.at("base_velocity_jump").at("angular").at(i);
    square += (before + jump) * (before + jump);
  }
  CHECK(square > 1e-8);
  std::ostringstream rate;
  rate << std::setprecision(5) << std::sqrt(square);
  CHECK(outcome.out.find(" " + rate.str() + " ") != std::string::npos);
  CHECK(outcome.out.find("the robot moves before the impact") != std::string::npos);
  CHECK(outcome.out.find(" 0 (below 1e-9)") != std::string::npos);
  CHECK(outcome.out.find("e-1") == std::string::npos);
  CHECK(shop.run(command + " -o one.csv").code == 0);
  std::ostringstream full;
  full << impact.at("before").at("base_velocity").at("angular").at(1);
  CHECK(shop.text("one.csv").find("," + full.str()) != std::string::npos);
}

TEST_CASE("analyze states an impulse that leaves the xy plane as a vector") {
  const Workshop shop;
  const std::string command = "analyze " + quoted(source_path("problems/spart_given_push.yaml"));
  const Outcome outcome = shop.run(command);
  INFO(outcome.out);
  REQUIRE(outcome.code == 0);
  // Along (-2, -1, -2) in B, with a moment.
  CHECK(outcome.out.find("impulse along (-0.6667, -0.3333, -0.6667) in the base frame: azimuth "
                         "206.57 deg (the direction below), elevation -41.81 deg\nwith a moment of "
                         "(0, 0.01, 0.005) N m s\n") == 0);
  CHECK(shop.run(command + " -o one.csv").code == 0);
  const std::string csv = shop.text("one.csv");
  CHECK(csv.find(",elevation_deg\n") != std::string::npos);
  CHECK(csv.find(",-41.81") != std::string::npos);
  const std::string planar = quoted(source_path("problems/planar_two_link_sweep_a.yaml"));
  CHECK(shop.run("analyze " + planar).out.find("elevation") == std::string::npos);
}

TEST_CASE("the summary of a given impulse states no closing speed") {
  const Workshop shop;
  const std::string problem = quoted(source_path("problems/spart_given_push.yaml"));
  const Outcome outcome = shop.run("plan " + problem + " --starts 4 -o plan.json");
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(outcome.says("0.1 N s along (-0.6667, -0.3333, -0.6667) in the base frame, as stated\n"));
  CHECK_FALSE(outcome.says("closing at"));
}

TEST_CASE("analyze draws a sweep and says so when there is none") {
  const Workshop shop;
  const std::string command =
      "analyze " + quoted(source_path("problems/planar_two_link_sweep_a.yaml"));
  CHECK(shop.run(command + " -o one.svg").code == 2);
  CHECK_FALSE(shop.has("one.svg"));
  CHECK(shop.run(command + " --sweep-direction 72 -o sweep.svg").code == 0);
  const std::string svg = shop.text("sweep.svg");
  CHECK(svg.find("<svg") != std::string::npos);
  for (const char* part : {"base part", "coupling part", "orthogonal", "G2", "G3", "C1"}) {
    INFO(part);
    CHECK(svg.find(part) != std::string::npos);
  }
}

TEST_CASE("simulate shows what the controllers of the paper do, and writes the motion") {
  const Workshop shop;
  const std::string problem = quoted(source_path("problems/planar_two_link_post_impact_a.yaml"));
  const Outcome outcome = shop.run("simulate " + problem + " --json");
  REQUIRE(outcome.code == 0);
  const json runs = json::parse(outcome.out).at("runs");
  REQUIRE(runs.size() == 5);
  for (const json& run : runs) {
    const std::string name = run.at("controller");
    INFO(name);
    CHECK(run.at("relative_momentum_drift").get<double>() < 1e-9);
    const double base = std::abs(run.at("momentum_end").at("base").at(2).get<double>());
    const double total = std::abs(run.at("momentum_end").at("total").at(2).get<double>());
    // Without damping the joints go on turning, and control held over 0.01 s lags behind them.
    if (name == "rns") CHECK(base < 1e-2 * total);
    if (name == "rns_damped") CHECK(base < 1e-3 * total);
    if (name == "joint_damping") CHECK(base == Approx(total).epsilon(1e-3));
  }
  const Outcome traced = shop.run("simulate " + problem + " --controller rns --trace motion.csv");
  CHECK(traced.code == 0);
  const std::string csv = shop.text("motion.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') > 1000);
  CHECK(shop.run("simulate " + problem + " --trace motion.csv").code == 7);
  CHECK(shop.run("simulate " + problem + " --controller magic").code == 2);
}

TEST_CASE("plan --pareto writes the front of two quantities as JSON, CSV and a plot") {
  const Workshop shop;
  const std::string command = "plan " +
                              quoted(source_path("problems/planar_three_link_null.yaml")) +
                              " --starts 16 --pareto base_angular_momentum,joint_rate_norm";
  const Outcome outcome = shop.run(command + " -o front.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.says("the values are nominal: the problem's measure 'worst_case' is not used"));
  const json front = json::parse(shop.text("front.json"));
  CHECK(front.at("format") == "stillbase.pareto");
  CHECK(front.at("complete") == true);
  CHECK(front.at("quantities").at(1).at("unit") == "rad/s");
  const json& points = front.at("points");
  REQUIRE(points.size() >= 5);
  for (std::size_t i = 1; i < points.size(); ++i) {
    CHECK(points[i].at("base_angular_momentum") > points[i - 1].at("base_angular_momentum"));
    CHECK(points[i].at("joint_rate_norm") < points[i - 1].at("joint_rate_norm"));
  }
  REQUIRE(shop.run(command + " -o front.csv").code == 0);
  const std::string csv = shop.text("front.csv");
  CHECK(csv.rfind("base_angular_momentum_N_m_s,joint_rate_norm_rad_s,", 0) == 0);
  CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) == points.size() + 1);
  REQUIRE(shop.run(command + " -o front.svg").code == 0);
  CHECK(shop.text("front.svg").find("joint rate norm (rad/s)") != std::string::npos);
  CHECK(shop.run(command).says("reduces"));

  const std::string plan = "plan " + quoted(source_path("problems/planar_three_link_null.yaml"));
  CHECK(shop.run(plan + " --pareto base_angular_momentum").code == 2);
  CHECK(shop.run(plan + " --pareto joint_rate_norm,joint_rate_norm").code == 2);
  CHECK(shop.run(plan + " --pareto joint_rate_norm,beauty").says("there are"));
  CHECK(shop.run(command + " -o front.txt").code == 2);
}

TEST_CASE("check says what was understood of robots and problems") {
  const Workshop shop;
  const Outcome outcome =
      shop.run("check robots/planar_two_link_a.urdf " + quoted(source_path(kProblem)));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  for (const char* part : {"3 bodies after merging fixed links", "1200 kg", "with hand",
                           "rank 1 in 64 of 64", "2 variables, 2 independent equations"}) {
    INFO(part);
    CHECK(outcome.out.find(part) != std::string::npos);
  }
}

TEST_CASE("the starts of a search are a number or its own choice") {
  const Workshop shop;
  const std::string plan = "plan '" + source_path("problems/planar_two_link_c2_a.yaml") +
                           "' --time-limit 0.01 --starts ";
  for (const char* starts : {"1", "10000000", "auto"}) {
    INFO(starts);
    CHECK(shop.run(plan + starts).code != 2);
  }
  for (const char* starts : {"0", "10000001", "1.5", "-1", "Auto"}) {
    INFO(starts);
    CHECK(shop.run(plan + starts).code == 2);
  }
}

TEST_CASE("a plan in place of its problem is called a plan and nothing more") {
  const Workshop shop;
  shop.write("plan.json", R"({"format": "stillbase.plan", "version": 1, "problem": {}})");
  const Outcome outcome = shop.run("plan plan.json");
  CHECK(outcome.code == 3);
  CHECK(outcome.err == "plan.json:1: format: is 'stillbase.plan'; must be 'stillbase.problem'\n");
}

TEST_CASE("a problem without variables is taken further by analyze") {
  const Workshop shop;
  const Outcome outcome =
      shop.run("check '" + source_path("problems/planar_two_link_sweep_a.yaml") + "'");
  CHECK(outcome.code == 0);
  CHECK(outcome.says("next: stillbase analyze"));
}

TEST_CASE("candidates that were not judged before a limit are not called colliding") {
  const Workshop shop;
  // However quick the machine, the limit comes within the search.
  shop.write_changed("many.yaml", "problems/planar_three_link_client.yaml", "starts: 64",
                     "starts: 20000");
  const Outcome outcome = shop.run("plan many.yaml --time-limit 0.4 -o plan.json");
  INFO(outcome.err);
  CHECK(outcome.code == 6);
  CHECK(outcome.says(" candidates"));
  CHECK_FALSE(outcome.says(" 0 of them free of collision"));
}

TEST_CASE("a plan that a limit ended is called so, and nothing else") {
  const Workshop shop;
  // Each start takes a thousand evaluations: the limit comes before the best was reached often.
  shop.write_changed("slow.yaml", "problems/deos_latch_residual.yaml", "starts: auto",
                     "starts: auto\n  optimizer: random-search");
  const Outcome outcome = shop.run("plan slow.yaml --time-limit 0.1 -o plan.json");
  INFO(outcome.err);
  CHECK(outcome.code == 6);
  CHECK(outcome.says(": the search was stopped before its end"));
  CHECK_FALSE(outcome.says("feasible"));
}

TEST_CASE("an effort of best goes on to other candidates where the path decides on the posture") {
  const Workshop shop;
  const std::string problem = "problems/iiwa_fixed_start.yaml";
  shop.write_changed("first.yaml", problem, "approach:\n", "approach:\n  effort: first\n");
  shop.write_changed("best.yaml", problem, "approach:\n", "approach:\n  effort: best\n");
  std::map<std::string, json> plans;
  for (const std::string effort : {"first", "best"}) {
    const Outcome plan = shop.run("plan " + effort + ".yaml -o " + effort + ".json");
    INFO(plan.err);
    REQUIRE(plan.code == 0);
    CHECK(shop.run("verify " + effort + ".json").code == 0);
    plans[effort] = json::parse(shop.text(effort + ".json"));
  }
  const auto value = [&](const char* effort) {
    return plans[effort].at("objective").at("value").get<double>();
  };
  CHECK(value("best") < value("first"));
  int tried = 0;
  for (const json& candidate : plans["best"].at("candidates")) {
    const std::string reason = candidate.value("excluded", "");
    CHECK(reason != "not tried: approach.effort is first");
    tried += reason == "no better where its path ends" || reason.rfind("no approach path", 0) == 0;
  }
  CHECK(tried >= 1);
}

TEST_CASE("a candidate whose configuration the path decides is counted by its measure") {
  const Workshop shop;
  const Outcome run = shop.run("plan " + quoted(source_path("problems/iiwa_fixed_start.yaml")) +
                               " --starts 16 -o plan.json");
  INFO(run.err);
  REQUIRE(run.code == 0);
  const json plan = json::parse(shop.text("plan.json"));
  const auto& candidates = plan.at("candidates");
  const auto chosen = std::find_if(candidates.begin(), candidates.end(), [&](const json& one) {
    return one.at("joint_positions") == plan.at("configuration").at("joint_positions");
  });
  const auto place = chosen - candidates.begin();
  const int better = plan.at("choice").at("better");
  REQUIRE(better > place);
  CHECK(run.says("candidate " + std::to_string(better + 1) + " of " +
                 std::to_string(candidates.size()) + " by the measure, listed at " +
                 std::to_string(place + 1) + ", "));
}
