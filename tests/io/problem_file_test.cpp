#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "io/document.hpp"
#include "io/problem_text.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

TEST_CASE("a problem reads to SI units with every default in place") {
  const CaptureProblem problem = read(kProblem);
  CHECK(problem.name == "test");
  CHECK(problem.start[0] == Approx(-80 * M_PI / 180).epsilon(1e-15));
  CHECK(problem.base.position == Vector3d(1, 2, 3));
  CHECK((problem.base.orientation * Vector3d::UnitX() - Vector3d::UnitY()).norm() < 1e-15);
  REQUIRE(problem.target);
  CHECK(std::get<Box>(problem.target->shapes[0].geometry)
            .size.isApprox(Vector3d::Constant(0.6), 1e-15));
  CHECK(problem.target_state.linear_velocity == Vector3d(-0.05, 0, 0));
  CHECK(problem.target_state.angular_velocity.isApprox(Vector3d(1, 2, 2) / 3 * 5 * M_PI / 180,
                                                       1e-15));
  CHECK(problem.resistance.model == ResistanceModel::RotorInertia);
  CHECK(problem.resistance.rotor_inertia == Eigen::Vector2d(0.5, 0.25));
  CHECK(problem.variables.joints == std::vector<bool>{false, true});
  CHECK(problem.variables.base_attitude == AttitudeFreedom::Axis);
  CHECK(problem.variables.base_attitude_axis == Vector3d::UnitZ());
  CHECK(problem.variables.contact_time_lower == 60);
  CHECK(problem.variables.feature == "plus_x");
  CHECK_FALSE(problem.impulse.direction);
  CHECK(problem.search.optimizer == "sqp");
  CHECK(problem.search.starts == kAutomaticStarts);
  CHECK(problem.approach.acceleration_limit == Eigen::Vector2d(0.1, 0.1));
  CHECK(problem.obstacles.size() == 1);
  CHECK(problem.robot.hand == "hand");
}

TEST_CASE("the normalised copy reads back to the same problem, bit for bit") {
  std::vector<std::string> texts;
  CaptureProblem own = read(kProblem);
  own.target_state.pose.orientation = rotation_exp({0.1, 0.2, 0.3});
  own.uncertainty.joint_position = Eigen::Vector2d(0.01, 0.02);
  own.hand.constraint = HandConstraint::Pose;
  own.hand.orientation = rotation_exp({-1, 0.5, 0.7});
  own.search.seed = 18446744073709551615u;
  own.constraints.joint_rate_max = Eigen::Vector2d(0.1, 1.0 / 3);
  own.constraints.coupling_singular_value_min = 0.7;
  own.constraints.jacobian_singular_value_min = 0.1;
  own.constraints.jacobian_length = 2.0 / 3;
  own.constraints.clearance = 0.0;
  CaptureProblem placed = read_problem(source_path("problems/planar_three_link_null.yaml"));
  placed.hand.position = Vector3d(0.1, 1.0 / 3, -1e-17);
  std::vector<CaptureProblem> problems{own, placed};
  for (const std::string& path : shipped_problems()) problems.push_back(read_problem(path));
  REQUIRE(problems.size() >= 9);
  for (const CaptureProblem& problem : problems) {
    INFO(problem.name);
    const std::string json = problem_to_json(problem);
    const CaptureProblem again = read_problem_text(json, "copy.json", problem.urdf);
    CHECK(problem_to_json(again) == json);
    CHECK(again.name == problem.name);
    CHECK(again.start == problem.start);
    CHECK(again.base.orientation.coeffs() == problem.base.orientation.coeffs());
    CHECK(again.target_state.pose.orientation.coeffs() ==
          problem.target_state.pose.orientation.coeffs());
    CHECK(again.impulse.direction == problem.impulse.direction);
    CHECK(again.uncertainty.joint_position == problem.uncertainty.joint_position);
    CHECK(again.hand.position == problem.hand.position);
    CHECK(again.search.seed == problem.search.seed);
    CHECK(again.robot.n() == problem.robot.n());
  }
}

TEST_CASE("every shipped problem is accepted and says what it is for") {
  for (const std::string& path : shipped_problems()) {
    INFO(path);
    CaptureProblem problem;
    REQUIRE_NOTHROW(problem = read_problem(path));
    CHECK(problem.purpose.size() > 20);
    CHECK(problem.name == std::filesystem::path(path).stem().string());
  }
}

TEST_CASE("purpose and limits after the impact have defaults, and controllers alone need limits") {
  const std::string quiet =
      replaced(kProblem, "purpose: A text that the tests spoil one line at a time.\n", "");
  CHECK(read(quiet).purpose == "Capture of client.");
  CHECK(read(quiet).post_impact.residual_base_rate_max == 0);
  const std::string controlled = kProblem + "post_impact: {controllers: [none]}\n";
  CHECK(read(controlled).post_impact.residual_base_rate_max == Approx(kPi / 180));
  CHECK(read(controlled).post_impact.attitude_change_max == Approx(kPi / 9));
  const auto limit = [](const std::string& words) {
    return kProblem + "post_impact: {controllers: [none], " + words + "}\n";
  };
  CHECK(read(limit("attitude_change_max: 3 deg")).post_impact.attitude_change_max ==
        Approx(kPi / 60));
  CHECK(read(limit("attitude_change_max: 3 deg")).post_impact.residual_base_rate_max ==
        Approx(kPi / 180));
  const int line = static_cast<int>(std::count(kProblem.begin(), kProblem.end(), '\n')) + 1;
  refuses(limit("residual_base_rate_max: .nan"), line, "not-finite", {"residual_base_rate_max"});
  refuses(limit("residual_base_rate_max: -1 deg/s"), line, "out-of-range",
          {"residual_base_rate_max"});
}

TEST_CASE("shipped problems leave what decides their result to no default") {
  for (const std::string& path : shipped_problems()) {
    INFO(path);
    stillbase::io::ReadContext context{path, {}, {}};
    const stillbase::io::Node root = stillbase::io::parse_document(file_text(path), context);
    const auto states = [&root](const std::string& section, const std::string& key) {
      const stillbase::io::Node* const map = root.find(section);
      return map != nullptr && map->find(key) != nullptr;
    };
    const CaptureProblem problem = read_problem(path);
    for (const auto& [section, key] :
         std::vector<std::pair<std::string, std::string>>{{"robot", "start"},
                                                          {"impact", "joint_resistance"},
                                                          {"variables", "base_position"},
                                                          {"hand", "approach_axis"},
                                                          {"post_impact", "horizon"}}) {
      INFO(section << "." << key);
      CHECK(states(section, key));
    }
    CHECK((states("uncertainty", "cone_half_angle") || states("uncertainty", "residual_velocity")));
    if (problem.approach.enabled) CHECK(states("approach", "station_free"));
    if (problem.impulse.source == ImpulseSource::Given) continue;
    CHECK(states("impact", "restitution"));
    CHECK(states("constraints", "closing_speed_min"));
    if (!problem.impulse.direction) CHECK(states("target", "state"));
  }
}

TEST_CASE("unknown, duplicate and missing keys are refused with the nearest known key") {
  refuses_change("restitution: 0.5", "restitutoin: 0.5", "unknown-key",
                 {"impact.restitutoin", "did you mean 'restitution'?"});
  refuses_change("  restitution: 0.5\n  joint", "  source: rigid_body\n  joint", "duplicate-key",
                 {"'source'", "line 23"});
  refuses(replaced(kProblem, "objective: base_angular_momentum\n", ""), line_of(kProblem, "format"),
          "missing-key", {"objective.quantity"});
  refuses(replaced(kProblem, "  mass: 50 kg\n", ""), 11, "missing-key", {"target.mass"});
}

TEST_CASE("wrong types, lengths and units are refused") {
  refuses_change("restitution: 0.5", "restitution: high", "wrong-type",
                 {"impact.restitution", "'high'"});
  refuses_change("restitution: 0.5", "restitution: \"0.5\"", "wrong-type", {"quotes"});
  refuses_change("restitution: 0.5", "restitution: 0.5 m", "wrong-unit",
                 {"impact.restitution", "without unit"});
  refuses_change("mass: 50 kg", "mass: 50 s", "wrong-unit", {"target.mass", "'s'", "kg, g"});
  refuses_change("mass: 50 kg", "mass: 50 pounds", "unknown-unit", {"target.mass", "'pounds'"});
  refuses_change("mass: 50 kg", "mass: 1,5", "wrong-type", {"target.mass", "'1,5'"});
  refuses_change("mass: 50 kg", "mass: 0x10", "wrong-type", {"target.mass"});
  refuses_change("mass: 50 kg", "mass: 050", "wrong-type", {"target.mass", "leading zeros"});
  refuses_change("mass: 50 kg", "mass:", "wrong-type", {"target.mass", "nothing"});
  refuses_change("normal: [1, 0, 0]", "normal: [1, 0]", "wrong-length",
                 {"target.features[0].normal", "must have 3"});
  refuses_change("rotor_inertia: [0.5, 0.25]", "rotor_inertia: [0.5]", "wrong-length",
                 {"joint_1, joint_2"});
  refuses_change("start: {joint_1: -80 deg, joint_2: 160 deg}", "start: {joint_1: -80 deg}",
                 "missing-key", {"robot.start", "joint_2"});
  refuses_change("start: {joint_1: -80 deg", "start: {joint_1: -80 m", "wrong-unit",
                 {"robot.start.joint_1", "rad, deg"});
  refuses_change("objective:", "search: {starts: Auto}\nobjective:", "wrong-type",
                 {"search.starts", "'Auto'", "an integer", "or `auto`"});
  refuses_change("version: 1", "version: 2", "out-of-range", {"version"});
  refuses_change("format: stillbase.problem", "format: stillbase.plan", "format",
                 {"stillbase.problem"});
}

TEST_CASE("numbers that are not finite are refused") {
  for (const char* bad : {".nan", "nan", ".inf", "-.inf", "inf", "Infinity", "1e999", "-1e999"}) {
    refuses_change("mass: 50 kg", std::string("mass: ") + bad, "not-finite", {"target.mass", bad});
    refuses_change("[0.3, 0.12, 0.06]", std::string("[0.3, ") + bad + ", 0.06]", "not-finite",
                   {"target.features[0].point[1]"});
  }
  refuses_change("mass: 50 kg", "mass: nan kg", "not-finite", {"target.mass"});
}

TEST_CASE("values that no body, contact or direction can have are refused") {
  refuses_change("mass: 50 kg", "mass: 0 kg", "out-of-range",
                 {"target.mass", "must be in [1e-30, 1e+30] kg"});
  refuses_change("mass: 50 kg", "mass: -5", "out-of-range", {"target.mass"});
  refuses_change("{ixx: 3, iyy: 3, izz: 3}", "{ixx: 1, iyy: 1, izz: 3}", "impossible-inertia",
                 {"target.inertia", "triangle"});
  refuses_change("{ixx: 3, iyy: 3, izz: 3}", "{ixx: 3, iyy: 3, izz: -3}", "impossible-inertia",
                 {"target.inertia", "positive definite"});
  refuses_change("restitution: 0.5", "restitution: 1.5", "out-of-range",
                 {"impact.restitution", "'1.5'", "[0, 1]"});
  refuses_change("restitution: 0.5", "restitution: -0.1", "out-of-range", {"[0, 1]"});
  refuses_change("restitution: 0.5", "direction: [0, 0, 0]\n  restitution: 0.5", "zero-direction",
                 {"impact.direction"});
  refuses_change("normal: [1, 0, 0]", "normal: [2, 0, 0]", "not-unit",
                 {"target.features[0].normal", "norm 2"});
  refuses_change("orientation: {rpy: [0, 0, 90 deg]}", "orientation: {w: 1, x: 1, y: 0, z: 0}",
                 "not-unit", {"robot.base.orientation", "1.414"});
  refuses_change("closing_speed_min: 0.01", "closing_speed_min: 0", "out-of-range",
                 {"constraints.closing_speed_min", "in (0, 100000]"});
  refuses_change("cone_half_angle: 10 deg", "cone_half_angle: 100 deg", "out-of-range",
                 {"uncertainty.cone_half_angle"});
  refuses_change("lower: 1 min", "lower: 2 min", "out-of-range", {"variables.contact_time"});
  refuses_change("radius: 0.1", "radius: 0", "out-of-range", {"obstacles[0].geometry.sphere"});
  refuses_change("geometry: {sphere: {radius: 0.1}}", "geometry: {}", "geometry",
                 {"obstacles[0].geometry", "exactly one"});
}

TEST_CASE("names that do not exist are refused with those that do") {
  refuses_change("hand: hand", "hand: gripper", "hand-unknown", {"robot.hand", "gripper", "hand"});
  refuses_change("joints: [joint_2]", "joints: [joint_3]", "unknown-name",
                 {"variables.joints[0]", "'joint_3'", "joint_1, joint_2"});
  refuses_change("start: {joint_1: -80 deg, joint_2",
                 "start: {joint_1: -80 deg, joint_2: 0, joint_9", "unknown-name",
                 {"robot.start.joint_9"});
  refuses_change("[[base, link_2]]", "[[base, lnik_2]]", "unknown-name",
                 {"robot.allowed_contacts[0]", "did you mean 'link_2'?"});
  refuses_change("contact_time: {lower", "feature: minus_x\n  contact_time: {lower", "unknown-name",
                 {"variables.feature", "plus_x"});
  refuses_change("source: rigid_body", "source: rigid-body", "unknown-name",
                 {"impact.source", "did you mean 'rigid_body'?", "given, point_mass"});
  refuses_change("objective: base_angular_momentum",
                 "objective: {terms: [{quantity: impulse_magnitude, size: 1 rad/s}]}", "wrong-unit",
                 {"objective.terms[0].size"});
  refuses_change("objective: base_angular_momentum", "objective: base_moment", "unknown-name",
                 {"base_angular_velocity"});
}

TEST_CASE("an impulse of a target without a target names the section that is missing") {
  const std::string text(kProblem);
  const std::size_t begin = text.find("target:\n"), end = text.find("impact:\n");
  REQUIRE(begin < end);
  const std::string without = text.substr(0, begin) + text.substr(end);
  for (const char* source : {"rigid_body", "point_mass"}) {
    const std::string problem = replaced(without, "rigid_body", source);
    refuses(problem, line_of(problem, "impact:"), "missing-key",
            {"target: must be stated", std::string("impact.source '") + source + "'"});
  }
}

TEST_CASE("a measure over an uncertainty that is not stated is refused") {
  for (const char* measure : {"worst_case", "cvar", "expectation"}) {
    const std::string certain = replaced(kProblem, "cone_half_angle: 10 deg", "cone_half_angle: 0");
    refuses(replaced(certain, "objective: base_angular_momentum",
                     std::string("objective: {quantity: base_angular_momentum, measure: ") +
                         measure + "}"),
            line_of(kProblem, "objective: base_angular_momentum"), "missing-key",
            {"objective.measure", "uncertainty"});
  }
}

TEST_CASE("a start outside the joint limits is refused with the limits") {
  const auto findings = findings_of([] {
    const std::string text =
        replaced(replaced(kProblem, "{joint_1: -80 deg, joint_2: 160 deg}", "[0, 121 deg, 0]"),
                 "[[base, link_2]]", "[]");
    const std::string free =
        replaced(replaced(text, "rotor_inertia: [0.5, 0.25]", "rotor_inertia: 1"), "hand: hand",
                 "hand: link_3");
    read_problem_text(free, "test.yaml", robot_text("spart_sc_3dof"));
  });
  INFO(text_of(findings));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].line == 7);
  CHECK(findings[0].rule == "outside-limits");
  CHECK_THAT(findings[0].message,
             Catch::Contains("robot.start.joint_2") && Catch::Contains("[-2, 2]"));
}

TEST_CASE("sections that contradict each other are refused") {
  refuses_change("impact:\n", "impact:\n  closing_speed: 1\n", "not-used",
                 {"impact.closing_speed"});
  refuses_change("impact:\n", "impact:\n  moment: [0, 0, 1]\n", "not-used", {"impact.moment"});
}

TEST_CASE("a hand that nothing brings to its place, and a time that changes nothing, are refused") {
  const std::string free = replaced(kProblem, "constraint: axis", "constraint: none");
  const int line = line_of(kProblem, "\nhand:") + 1;
  refuses(free, line, "missing-key", {"hand.constraint", "contact feature", "base_position"});
  const auto with_station = [](const std::string& text) {
    return replaced(text, "  joints: [joint_2]\n", "  joints: [joint_2]\n  base_position: free\n");
  };
  CHECK(text_of(findings_of([&] { read(with_station(free)); })) == "");
  const std::string elsewhere = "constraint: position\n  position: [1, 0, 0]";
  refuses(replaced(kProblem, "constraint: axis", elsewhere), line, "not-used",
          {"hand.position", "contact feature", "impact.direction"});

  // Beside a stated direction the target comes along it, whenever that is.
  const std::string given =
      replaced(replaced(kProblem, "source: rigid_body\n  restitution: 0.5",
                        "source: given\n  direction: [1, 0, 0]"),
               "  state:\n    linear_velocity: [-50 mm/s, 0, 0]\n    angular_velocity: {axis: [1, "
               "2, 2], rate: 5 deg/s}\n",
               "");
  refuses(given, line_of(given, "variables:"), "not-used", {"variables.contact_time", "instant"});
  const std::string instant = replaced(given, "{lower: 1 min, upper: 70}", "70");
  CHECK(read(instant).variables.contact_time_lower == 70);
  const std::string nowhere = replaced(instant, "constraint: axis", "position: [1, 0, 0]");
  refuses(nowhere, line_of(nowhere, "\nhand:") + 1, "not-used", {"hand.position", "base_position"});
  CHECK(text_of(findings_of([&] { read(with_station(nowhere)); })) == "");
  // A place in the base does not say where the base is.
  const std::string in_base = with_station(replaced(
      instant, "constraint: axis", "constraint: position\n  position: [1, 0, 0]\n  frame: base"));
  refuses(in_base, line_of(in_base, "variables:"), "not-used", {"variables.base_position", "hand"});
  CHECK(text_of(findings_of([&] { read(replaced(in_base, "  base_position: free\n", "")); })) ==
        "");
}

namespace {

const std::string kRate = "angular_velocity: {axis: [1, 2, 2], rate: 5 deg/s}\n";

/// The problem with a covariance of its target's state, and a cone that follows from it.
std::string uncertain(const std::string& covariance, const std::string& cone) {
  return replaced(replaced(kProblem, kRate, kRate + "    covariance: " + covariance + "\n"),
                  "cone_half_angle: 10 deg", cone);
}

}  // namespace

TEST_CASE("a covariance gives the cone, and its normalised copy the same") {
  const CaptureProblem problem =
      read(uncertain("{orientation: [1 deg, 2 deg, 2 deg], position: 1 cm, linear_velocity: [1, 2, "
                     "3 mm/s], angular_velocity: 0.02 deg/s, mass: 0.05, moments: [0.01, 0.02, 0]}",
                     "cone_half_angle: from_covariance\n  confidence: 0.9"));
  REQUIRE(problem.target_deviations);
  const EstimateDeviations& sigma = *problem.target_deviations;
  CHECK(sigma.position == Vector3d(0.01, 0.01, 0.01));
  CHECK(sigma.orientation.isApprox(Vector3d(1, 2, 2) * M_PI / 180, 1e-15));
  CHECK(sigma.linear_velocity.isApprox(Vector3d(1, 2, 0.003), 1e-15));
  CHECK(sigma.mass == 0.05);
  CHECK(sigma.moments == Vector3d(0.01, 0.02, 0));
  CHECK(problem.uncertainty.cone_confidence == 0.9);
  // The attitude alone gives 2 deg about both axes across the normal.
  const double from_attitude = 2 * M_PI / 180 * std::sqrt(-2 * std::log(0.1));
  CHECK(problem.uncertainty.cone_half_angle > from_attitude);
  CHECK(problem.uncertainty.cone_half_angle < 2 * from_attitude);
  const std::string json = problem_to_json(problem);
  CHECK_THAT(json, Catch::Contains("\"cone_half_angle\": \"from_covariance\""));
  const CaptureProblem again = read_problem_text(json, "copy.json", problem.urdf);
  CHECK(problem_to_json(again) == json);
  CHECK(again.uncertainty.cone_half_angle == problem.uncertainty.cone_half_angle);
  CHECK(again.target_deviations->orientation == sigma.orientation);

  // In a plane only the turn about its normal counts.
  const CaptureProblem planar =
      read(replaced(uncertain("{orientation: [0, 0, 1 deg]}",
                              "cone_half_angle: from_covariance\n  cone_plane: xy"),
                    "axis: [1, 2, 2]", "axis: [0, 0, 1]"));
  CHECK(planar.uncertainty.cone_half_angle == Approx(1.959964 * M_PI / 180).epsilon(1e-5));
}

TEST_CASE("a covariance that gives no cone is refused") {
  const auto refuses_with = [](const std::string& text, const std::string& rule,
                               const std::string& part) {
    const auto findings = findings_of([&] { read(text); });
    INFO(text_of(findings));
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].rule == rule);
    CHECK_THAT(findings[0].message, Catch::Contains(part));
  };
  const std::string cone = "cone_half_angle: from_covariance";
  refuses_with(replaced(kProblem, "cone_half_angle: 10 deg", cone), "missing-key",
               "target.state.covariance");
  refuses_with(uncertain("{orientation: 1 deg}", "cone_half_angle: 1 deg\n  confidence: 0.9"),
               "not-used", "uncertainty.confidence");
  refuses_with(uncertain("{orientation: 1 deg}", cone + "\n  confidence: 1"), "out-of-range",
               "uncertainty.confidence");
  refuses_with(uncertain("{orientation: 1 deg}", "cone_half_angle: from_somewhere"), "wrong-type",
               "uncertainty.cone_half_angle");
  refuses_with(uncertain("{orientation: -1 deg}", cone), "out-of-range",
               "target.state.covariance.orientation");
  refuses_with(uncertain("{orientation: [1 deg, 2 deg]}", cone), "wrong-length",
               "target.state.covariance.orientation");
  refuses_with(uncertain("{moments: 0.7}", cone), "out-of-range",
               "target.state.covariance.moments");
  refuses_with(uncertain("{attitude: 1 deg}", cone), "unknown-key", "covariance.attitude");
  refuses_with(uncertain("{orientation: 0.9}", cone), "out-of-range", "at most pi/2");
  refuses_with(uncertain("{angular_velocity: 10}", cone), "out-of-range", "300 rad");
  refuses_with(replaced(uncertain("{orientation: 1 deg}", cone), "rate: 5 deg/s", "rate: 6"),
               "out-of-range", "300 rad");
}

TEST_CASE("an approach that the base mode cannot have is refused") {
  const auto refuses_approach = [](const std::string& approach, const std::string& rule,
                                   const std::vector<std::string>& parts) {
    refuses_change("obstacles:\n", "approach: " + approach + "\nobstacles:\n", rule, parts);
  };
  // The problem frees the base's attitude, which a stated start of a floating base decides.
  refuses_approach("{base: floating, station_free: false}", "contradiction",
                   {"approach.station_free", "follows from the path"});
  refuses_approach("{base: held, station_free: false}", "contradiction",
                   {"approach.station_free", "must be fixed"});
  refuses_approach("{base: reaction-null, station_free: false}", "not-supported",
                   {"approach.station_free"});
  refuses_approach("{base: reaction-null, polish: time}", "not-supported", {"approach.polish"});
  refuses_approach("{base: reaction-null, planner: kpiece}", "not-used", {"approach.planner"});
  refuses_approach("{planner: rrt}", "unknown-name", {"approach.planner", "ait_star"});
  refuses_approach("{polish: speed}", "unknown-name", {"approach.polish", "attitude, time"});
  refuses_approach("{attitude_tolerance: 0}", "out-of-range", {"approach.attitude_tolerance"});
}

TEST_CASE("an approach reads its base mode, planner and polish") {
  const CaptureProblem problem = read(
      replaced(kProblem, "obstacles:\n",
               "approach: {base: floating, planner: bit_star, polish: attitude}\nobstacles:\n"));
  CHECK(problem.approach.base == BaseMode::Floating);
  CHECK(problem.approach.planner == "bit_star");
  CHECK(problem.approach.polish == PathPolish::Attitude);
  CHECK(problem.approach.attitude_tolerance == Approx(0.1 * 3.14159265358979323846 / 180));
  CHECK(read(replaced(kProblem, "obstacles:\n",
                      "approach: {base: reaction-null, attitude_tolerance: 1 deg}\nobstacles:\n"))
            .approach.base == BaseMode::ReactionNull);
}

TEST_CASE("what the sections need of each other is asked for") {
  const std::string point_mass =
      replaced(replaced(kProblem, "source: rigid_body", "source: point_mass"), "restitution: 0.5",
               "direction: {angle: 10 deg}");
  const auto rules = [](const std::string& text) {
    std::string list;
    for (const Finding& finding : findings_of([&] { read(text); })) list += finding.message + "\n";
    return list;
  };
  CHECK_THAT(rules(point_mass), Catch::Contains("impact.closing_speed") &&
                                    Catch::Contains("closing_speed_min = 0.01") &&
                                    Catch::Contains("target.state"));
  const std::string without_feature = replaced(
      replaced(kProblem, "    - {name: plus_x, point: [0.3, 0.12, 0.06], normal: [1, 0, 0]}", ""),
      "  features:\n", "");
  CHECK_THAT(rules(without_feature),
             Catch::Contains("impact.direction") && Catch::Contains("impact.source"));
  const std::string two_directions =
      replaced(kProblem, "impact:\n", "impact:\n  direction: [1, 0, 0]\n");
  CHECK_THAT(rules(two_directions),
             Catch::Contains("impact.direction") && Catch::Contains("target.state"));
  const std::string without_motion = replaced(
      replaced(replaced(kProblem, "  state:\n", ""), "    linear_velocity: [-50 mm/s, 0, 0]\n", ""),
      "    angular_velocity: {axis: [1, 2, 2], rate: 5 deg/s}\n", "");
  CHECK_THAT(rules(without_motion), Catch::Contains("target.state"));
}

TEST_CASE("several findings are reported together") {
  std::string text = replaced(kProblem, "restitution: 0.5", "restitution: 2");
  text = replaced(text, "mass: 50 kg", "mas: 50 kg");
  text = replaced(text, "rate: 5 deg/s", "rate: 5 deg");
  const auto findings = findings_of([&] { read(text); });
  INFO(text_of(findings));
  CHECK(findings.size() == 4);  // unknown key, missing key, unit, range
}

TEST_CASE(
    "files that a problem names and that do not exist are refused at the line that names them") {
  const std::string folder = source_path("problems/");
  CHECK(findings_of([&] { read_problem(folder + "no_such_problem.yaml"); })[0].rule ==
        "missing-file");
  const TemporaryFolder elsewhere;
  const std::string file = elsewhere.write("problem.yaml", kProblem);
  const auto findings = findings_of([&] { read_problem(file); });
  INFO(text_of(findings));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].file == file);
  CHECK(findings[0].line == 5);
  CHECK(findings[0].rule == "missing-file");
  CHECK_THAT(findings[0].message, Catch::Contains("robot.file"));
}

TEST_CASE(
    "a robot that is refused is reported with its own file and with the rest of the problem") {
  const std::string text = replaced(kProblem, "restitution: 0.5", "restitution: 2");
  const std::string robot = replaced(robot_text(), "<mass value=\"100\"/>", "<mass value=\"-1\"/>");
  const auto findings = findings_of([&] { read_problem_text(text, "test.yaml", robot); });
  INFO(text_of(findings));
  REQUIRE(findings.size() == 2);
  CHECK(findings[0].file == "robots/planar_two_link_a.urdf");
  CHECK(findings[1].line == 24);
}

TEST_CASE("a number that is not finite is never written") {
  CaptureProblem problem = read(kProblem);
  problem.impulse.restitution = std::nan("");
  CHECK_THROWS_AS(problem_to_json(problem), std::invalid_argument);
  problem.impulse.restitution = 0;
  problem.start[1] = kInfinity;
  CHECK_THROWS_AS(problem_to_json(problem), std::invalid_argument);
}
