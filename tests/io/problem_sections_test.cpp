// Variables, objective and constraints of a problem file.
#include <cmath>

#include <catch2/catch.hpp>

#include "io/problem_text.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

TEST_CASE("margins are read in their units and stay unasked for otherwise") {
  const CaptureProblem without = read(kProblem);
  CHECK_FALSE(without.constraints.joint_rate_scale);
  CHECK(without.constraints.joint_rate_max.size() == 0);
  CHECK(without.constraints.coupling_singular_value_min == 0);
  CHECK(without.constraints.jacobian_singular_value_min == 0);
  CHECK_FALSE(without.constraints.clearance);
  const std::string line = "  closing_speed_min: 0.01\n";
  const CaptureProblem with = read(replaced(kProblem, line,
                                            line + "  joint_rate_max: 5 deg/s\n"
                                                   "  coupling_singular_value_min: 0.5\n"
                                                   "  jacobian_singular_value_min: 100 mm\n"
                                                   "  jacobian_length: 0.5 m\n"
                                                   "  clearance: 2 cm\n"));
  CHECK(with.constraints.joint_rate_max.isApprox(Eigen::Vector2d::Constant(5 * M_PI / 180), 1e-15));
  CHECK(with.constraints.coupling_singular_value_min == 0.5);
  CHECK(with.constraints.jacobian_singular_value_min == Approx(0.1).epsilon(1e-15));
  CHECK(with.constraints.jacobian_length == 0.5);
  CHECK(with.constraints.clearance.value() == Approx(0.02).epsilon(1e-15));
  const CaptureProblem scaled = read(replaced(kProblem, line, line + "  joint_rate_scale: 0.5\n"));
  CHECK(scaled.constraints.joint_rate_scale.value() == 0.5);
}

TEST_CASE("a cone of attitudes is read, with an axis and a size") {
  const std::string attitude = "{freedom: axis, axis: [0, 0, 2], max: 30 deg}";
  const CaptureProblem cone =
      read(replaced(kProblem, attitude, "{freedom: cone, axis: [0, 0, 2], max: 30 deg}"));
  CHECK(cone.variables.base_attitude == AttitudeFreedom::Cone);
  CHECK(cone.variables.base_attitude_axis == Vector3d::UnitZ());
  refuses_change(attitude, "{freedom: cone, axis: [0, 0, 2]}", "missing-key", {"max"});
  refuses_change(attitude, "{freedom: cone, max: 30 deg}", "missing-key", {"axis"});
  refuses_change(attitude, "cone", "missing-key", {"axis"});
  const std::string json = problem_to_json(cone);
  CHECK(problem_to_json(read_problem_text(json, "copy.json", cone.urdf)) == json);
}

TEST_CASE("a choice of features is read") {
  const std::string one = "    - {name: plus_x, point: [0.3, 0.12, 0.06], normal: [1, 0, 0]}\n";
  const std::string two = one + "    - {name: plus_y, point: [0, 0.3, 0], normal: [0, 1, 0]}\n";
  const std::string text = replaced(kProblem, one, two);
  const auto choice = [&](const std::string& names) {
    return replaced(text, "  joints: [joint_2]\n",
                    "  joints: [joint_2]\n  feature: " + names + "\n");
  };
  const CaptureProblem either = read(choice("[plus_y, plus_x]"));
  CHECK(either.variables.features == std::vector<std::string>{"plus_y", "plus_x"});
  CHECK(either.variables.feature == "plus_y");
  const std::string json = problem_to_json(either);
  const CaptureProblem again = read_problem_text(json, "copy.json", either.urdf);
  CHECK(again.variables.features == either.variables.features);
  CHECK(problem_to_json(again) == json);
  CHECK(read(choice("[plus_y]")).variables.features.empty());
  CHECK(read(choice("[plus_y]")).variables.feature == "plus_y");
  const int line = line_of(choice("[plus_y, plus_z]"), "feature: [");
  refuses(choice("[plus_y, plus_z]"), line, "unknown-name", {"plus_z"});
  refuses(choice("[plus_y, plus_y]"), line, "duplicate-name", {"plus_y"});
  refuses(choice("[]"), line, "wrong-type", {"at least one"});
}

TEST_CASE("a wedge is refused where something leaves its plane") {
  const std::string flat =
      replaced(replaced(kProblem, "axis: [1, 2, 2], rate", "axis: [0, 0, 1], rate"),
               "  cone_half_angle: 10 deg", "  cone_half_angle: 10 deg\n  cone_plane: xy");
  CHECK(read(flat).uncertainty.cone_plane_normal);
  const int line = line_of(flat, "uncertainty:");
  const auto refuses_wedge = [&](const std::string& from, const std::string& to,
                                 const std::string& part) {
    INFO(from << " -> " << to);
    const auto findings = findings_of([&] { read(replaced(flat, from, to)); });
    INFO(text_of(findings));
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].rule == "not-planar");
    CHECK_THAT(findings[0].message, Catch::Contains(part));
  };
  CHECK(line > 0);
  refuses_wedge("cone_plane: xy", "cone_plane: yz", "joint_1");
  refuses_wedge("axis: [0, 0, 1], rate", "axis: [0, 1, 1], rate", "target rotates");
  refuses_wedge("freedom: axis, axis: [0, 0, 2]", "freedom: axis, axis: [0, 1, 2]",
                "base may rotate");
  refuses_wedge("base_attitude: {freedom: axis, axis: [0, 0, 2], max: 30 deg}",
                "base_attitude: free", "base may rotate");
  refuses_wedge("ixx: 3, iyy: 3, izz: 3", "ixx: 3, iyy: 3, izz: 3, ixz: 0.5", "symmetry");
  refuses_wedge("normal: [1, 0, 0]", "normal: [0.6, 0, 0.8]", "feature points");

  const std::string covariance = replaced(
      replaced(flat, "cone_half_angle: 10 deg", "cone_half_angle: from_covariance"),
      "rate: 5 deg/s}\n", "rate: 5 deg/s}\n    covariance: {orientation: [0, 0, 1 deg]}\n");
  CHECK(read(covariance).uncertainty.cone_half_angle > 0);
  const auto tilted =
      findings_of([&] { read(replaced(covariance, "[0, 0, 1 deg]", "[0, 0.1 deg, 1 deg]")); });
  REQUIRE(tilted.size() == 1);
  CHECK(tilted[0].rule == "not-planar");
  CHECK_THAT(tilted[0].message, Catch::Contains("covariance.orientation"));
}

TEST_CASE("the turn after the impact needs its time, a controller and an instantaneous impact") {
  const std::string text =
      replaced(kProblem, "objective: base_angular_momentum",
               "objective: {quantity: attitude_turned, after: 5 s}") +
      "post_impact: {controllers: [rns], residual_base_rate_max: 1, attitude_change_max: 1}\n";
  const CaptureProblem problem = read(text);
  REQUIRE(problem.objective.size() == 1);
  CHECK(problem.objective[0].quantity == ObjectiveQuantity::AttitudeTurned);
  CHECK(problem.objective[0].after == 5);
  const int line = line_of(text, "objective:");
  const auto refuses_objective = [&](const std::string& from, const std::string& to,
                                     const std::string& rule, const std::string& part) {
    INFO(from << " -> " << to);
    refuses(replaced(text, from, to), line, rule, {part});
  };
  refuses_objective(", after: 5 s", "", "missing-key", "after");
  refuses_objective("{quantity: attitude_turned, after: 5 s}", "attitude_turned", "missing-key",
                    "after");
  refuses_objective("attitude_turned, after", "joint_rate_norm, after", "not-used",
                    "attitude_turned");
  for (const char* time : {"0 s", "-1 s", "1e-300 s", "0.99 ms", "3601 s", "1e300 s"}) {
    refuses_objective("after: 5 s", std::string("after: ") + time, "out-of-range", "after");
  }
  CHECK(read(replaced(text, "after: 5 s", "after: 1 ms")).objective[0].after == 1e-3);
  refuses_objective("after: 5 s", "after: 5 m", "wrong-unit", "after");
  refuses_objective("after: 5 s", "after: 11 s", "out-of-range", "post_impact.horizon");
  refuses_objective("controllers: [rns], residual_base_rate_max: 1, attitude_change_max: 1",
                    "controllers: []", "missing-key", "post_impact.controllers");
  refuses_objective("attitude_change_max: 1}", "attitude_change_max: 1, contact: compliant}",
                    "not-supported", "post_impact.contact");
  for (const auto& [measure, kind] :
       {std::pair("worst_case", RiskMeasure::WorstCase),
        std::pair("expectation", RiskMeasure::Expectation), std::pair("cvar", RiskMeasure::Cvar)}) {
    const std::string with = std::string("after: 5 s, measure: ") + measure + "}";
    CHECK(read(replaced(text, "after: 5 s}", with)).measure.kind == kind);
  }
}

TEST_CASE("the turn after the impact as one of several terms reads back the same") {
  const std::string text =
      replaced(replaced(kProblem, "cone_half_angle: 10 deg", "cone_half_angle: 0"),
               "objective: base_angular_momentum",
               "objective:\n"
               "  terms:\n"
               "    - {quantity: attitude_turned, size: 2 deg, after: 1 min}\n"
               "    - {quantity: joint_rate_norm, size: 0.1 rad/s}") +
      "post_impact: {controllers: [none], horizon: 60 s, residual_base_rate_max: 1, "
      "attitude_change_max: 1}\n";
  const CaptureProblem problem = read(text);
  REQUIRE(problem.objective.size() == 2);
  CHECK(problem.objective[0].after == 60);
  CHECK(problem.objective[0].size == Approx(2 * M_PI / 180).epsilon(1e-15));
  CHECK(problem.objective[1].after == 0);
  const std::string alone = replaced(replaced(text, "size: 2 deg, ", "size: 1, "),
                                     "    - {quantity: joint_rate_norm, size: 0.1 rad/s}\n", "");
  for (const CaptureProblem& one : {problem, read(alone)}) {
    const std::string json = problem_to_json(one);
    const CaptureProblem again = read_problem_text(json, "copy.json", one.urdf);
    CHECK(problem_to_json(again) == json);
    CHECK(again.objective[0].quantity == ObjectiveQuantity::AttitudeTurned);
    CHECK(again.objective[0].after == 60);
  }
  refuses(replaced(text, ", after: 1 min", ""), line_of(text, "attitude_turned"), "missing-key",
          {"objective.terms[0]", "after"});
  refuses(replaced(text, "0.1 rad/s}", "0.1 rad/s, after: 2 s}"), line_of(text, "joint_rate_norm"),
          "not-used", {"objective.terms[1].after"});
}

TEST_CASE("what the measure or the quantity takes no notice of is refused") {
  const auto with = [](const std::string& fields) {
    return replaced(kProblem, "objective: base_angular_momentum",
                    "objective: {quantity: base_angular_momentum, " + fields + "}");
  };
  const int line = line_of(kProblem, "objective:");
  for (const char* measure : {"", "measure: nominal, ", "measure: worst_case, "}) {
    INFO(measure);
    refuses(with(measure + std::string("cvar_level: 0.5")), line, "not-used",
            {"objective.cvar_level", "cvar"});
    refuses(with(measure + std::string("samples: 64")), line, "not-used",
            {"objective.samples", "expectation", "cvar"});
    refuses(with(measure + std::string("sample_seed: 1")), line, "not-used",
            {"objective.sample_seed", "expectation", "cvar"});
  }
  refuses(with("measure: expectation, cvar_level: 0.5"), line, "not-used",
          {"objective.cvar_level", "cvar"});
  const MeasureSpec mean = read(with("measure: expectation, samples: 9, sample_seed: 3")).measure;
  CHECK(mean.samples == 9);
  CHECK(mean.seed == 3);
  // Of a misspelt word nothing more is said.
  refuses(with("measure: cvvar, cvar_level: 0.5, samples: 9"), line, "unknown-name", {"cvar"});

  const auto of = [](const std::string& quantity) {
    return replaced(kProblem, "objective: base_angular_momentum",
                    "objective: {terms: [{quantity: " + quantity + ", size: 1, length: 2 m}]}");
  };
  CHECK(read(of("base_momentum")).objective[0].length == 2);
  refuses(of("impulse_magnitude"), line, "not-used",
          {"objective.terms[0].length", "base_momentum"});
  refuses(of("base_momentun"), line, "unknown-name", {"base_momentum"});
  // What is written names no such field either, whatever the data hold.
  CaptureProblem problem = read(with("measure: worst_case"));
  problem.measure.samples = 7;
  problem.objective[0].length = 3;
  const std::string json = problem_to_json(problem);
  CHECK(problem_to_json(read_problem_text(json, "copy.json", problem.urdf)) == json);
}

TEST_CASE("a tail of fewer than two samples is refused") {
  const auto with = [](const std::string& level, const std::string& samples) {
    return replaced(kProblem, "objective: base_angular_momentum",
                    "objective: {quantity: base_angular_momentum, measure: cvar, cvar_level: " +
                        level + ", samples: " + samples + "}");
  };
  CHECK(read(with("0.9", "20")).measure.samples == 20);
  CHECK(read(with("0", "2")).measure.samples == 2);
  refuses(with("0.9", "19"), line_of(kProblem, "objective:"), "out-of-range", {"samples"});
  refuses(with("0.999", "1000"), line_of(kProblem, "objective:"), "out-of-range", {"samples"});
}

TEST_CASE("margins that cannot be meant are refused") {
  const std::string line = "  closing_speed_min: 0.01";
  const auto refuses_line = [&](const std::string& added, const std::string& rule,
                                const std::string& part) {
    refuses(replaced(kProblem, line, line + "\n  " + added), line_of(kProblem, line) + 1, rule,
            {part});
  };
  refuses_line("joint_rate_scale: 0", "out-of-range", "joint_rate_scale");
  refuses_line("joint_rate_max: [1, -1]", "out-of-range", "joint_rate_max");
  refuses_line("coupling_singular_value_min: -1", "out-of-range", "coupling_singular_value_min");
  refuses_line("jacobian_length: 0", "out-of-range", "jacobian_length");
  refuses_line("clearance: -1 mm", "out-of-range", "clearance");
  refuses_line("clearance: near", "wrong-type", "clearance");
  refuses(replaced(kProblem, line, line + "\n  joint_rate_scale: 0.5\n  joint_rate_max: 1"),
          line_of(kProblem, line) + 2, "not-used", {"joint_rate_scale"});
}

TEST_CASE("sizes beyond anything that is captured are refused: their squares are no numbers") {
  refuses_change("mass: 50 kg", "mass: 1e300 kg", "out-of-range", {"target.mass", "1e+30"});
  refuses_change("mass: 50 kg", "mass: 1e-300 kg", "out-of-range", {"target.mass", "1e-30"});
}
