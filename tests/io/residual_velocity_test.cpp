// uncertainty.residual_velocity: what is read, what is refused and where.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/left_out.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/io_support.hpp"
#include "io/problem_text.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

const std::string kCone = "  cone_half_angle: 10 deg\n";
const std::string kDiagonal = R"(  residual_velocity:
    - [4e-6, 1e-6, 0, 0, 0, 0]
    - [1e-6, 4e-6, 0, 0, 0, 0]
    - [0, 0, 4e-6, 0, 0, 0]
    - [0, 0, 0, 1e-6, 0, 0]
    - [0, 0, 0, 0, 1e-6, 0]
    - [0, 0, 0, 0, 0, 1e-6]
)";
const std::string kCarried = "  residual_velocity: from_covariance\n";
const std::string kSpin = "    angular_velocity: {axis: [1, 2, 2], rate: 5 deg/s}\n";
const std::string kCovariance =
    "    covariance: {linear_velocity: 1 mm/s, angular_velocity: 0.1 deg/s, orientation: 1 deg}\n";

std::string with(const std::string& uncertainty, const std::string& target = "") {
  return replaced(replaced(kProblem, kCone, uncertainty), kSpin, kSpin + target);
}

/// What is remarked by one rule, one per line.
std::string remarks_of(const std::string& text, const std::string& rule) {
  const TemporaryFolder folder;
  std::vector<Finding> remarks;
  (void)read_problem(
      folder.write("problem.yaml", replaced(text, "robots/", source_path("problems/robots/"))),
      &remarks);
  std::string out;
  for (const Finding& remark : remarks) {
    if (remark.rule == rule) out += fmt::format("{}: {}\n", remark.line, remark.message);
  }
  return out;
}

/// Refused at the line of the section, or so many lines below its first key.
void refuses_residual(const std::string& text, const std::string& at, const std::string& rule,
                      const std::vector<std::string>& parts, int below = 0) {
  refuses(text, line_of(text, at) + below, rule, parts);
}

}  // namespace

TEST_CASE("a residual velocity is read as a matrix or carried, and the copy says the same") {
  const CaptureProblem stated =
      read(with(kDiagonal + "  residual_frame: inertial\n  residual_deviations: 2\n"));
  REQUIRE(stated.uncertainty.residual_velocity);
  const ResidualVelocity& residual = *stated.uncertainty.residual_velocity;
  REQUIRE(residual.covariance);
  CHECK((*residual.covariance)(0, 1) == 1e-6);
  CHECK((*residual.covariance)(3, 3) == 1e-6);
  CHECK(residual.frame == ResidualFrame::Inertial);
  CHECK(residual.deviations == 2);
  const CaptureProblem carried =
      read(with(kCarried + "  hand_tracking: {linear: 2 mm/s, angular: 0.1 deg/s}\n", kCovariance));
  REQUIRE(carried.uncertainty.residual_velocity);
  CHECK_FALSE(carried.uncertainty.residual_velocity->covariance);
  CHECK(carried.uncertainty.residual_velocity->linear_tracking == Approx(2e-3));
  CHECK(carried.uncertainty.residual_velocity->angular_tracking == Approx(0.1 * kPi / 180));
  CHECK(carried.uncertainty.residual_velocity->deviations == 3);
  for (const CaptureProblem* problem : {&stated, &carried}) {
    const std::string copy = problem_to_json(*problem);
    const CaptureProblem again = read_problem_text(copy, "copy", problem->urdf);
    CHECK(problem_to_json(again) == copy);
    REQUIRE(again.uncertainty.residual_velocity);
    CHECK(again.uncertainty.residual_velocity->covariance ==
          problem->uncertainty.residual_velocity->covariance);
    CHECK(again.uncertainty.residual_velocity->deviations ==
          problem->uncertainty.residual_velocity->deviations);
  }
  CHECK_FALSE(read(kProblem).uncertainty.residual_velocity);
}

TEST_CASE("what is no covariance is refused at its row") {
  const auto changed = [](const std::string& from, const std::string& to) {
    return with(replaced(kDiagonal, from, to));
  };
  const std::string key = "residual_velocity:";
  refuses_residual(changed("[1e-6, 4e-6, 0", "[2e-6, 4e-6, 0"), key, "not-a-covariance",
                   {"uncertainty.residual_velocity[1][0]", "symmetric"}, 2);
  refuses_residual(changed("[0, 0, 4e-6", "[0, 0, -4e-6"), key, "not-a-covariance",
                   {"residual_velocity[2][2]", "not negative"}, 3);
  refuses_residual(with(replaced(replaced(kDiagonal, "4e-6, 1e-6, 0", "4e-6, 5e-6, 0"),
                                 "[1e-6, 4e-6, 0", "[5e-6, 4e-6, 0")),
                   key, "not-a-covariance",
                   {"residual_velocity[1][0]", "positive semidefinite", "4e-06"}, 2);
  // Every pair is possible, all three are not.
  std::string three = replaced(kDiagonal, "4e-6, 1e-6, 0, 0", "4e-6, 3e-6, -3e-6, 0");
  three = replaced(three, "1e-6, 4e-6, 0, 0", "3e-6, 4e-6, 3e-6, 0");
  three = replaced(three, "0, 0, 4e-6, 0", "-3e-6, 3e-6, 4e-6, 0");
  refuses_residual(with(three), key, "not-a-covariance",
                   {"positive semidefinite", "least eigenvalue"}, 1);
  refuses_residual(changed("    - [0, 0, 0, 0, 0, 1e-6]\n", ""), key, "wrong-length",
                   {"residual_velocity", "5 rows", "6"}, 1);
  refuses_residual(changed("[0, 0, 4e-6, 0, 0, 0]", "[0, 0, 4e-6, 0, 0]"), key, "wrong-length",
                   {"residual_velocity[2]", "5"}, 3);
  refuses_residual(changed("[0, 0, 4e-6,", "[0, 0, 2 mm/s,"), key, "wrong-unit",
                   {"residual_velocity[2][2]"}, 3);
  refuses_residual(changed("[0, 0, 4e-6,", "[0, 0, 1e30,"), key, "out-of-range",
                   {"residual_velocity[2][2]"}, 3);
}

TEST_CASE("what cannot stand beside a residual velocity is refused with the reason") {
  const std::string section = "uncertainty:";
  refuses_residual(with(kCarried), section, "missing-key",
                   {"residual_velocity", "target.state.covariance"});
  refuses_residual(with(kCone + kDiagonal), section, "contradiction",
                   {"residual_velocity", "cone_half_angle"});
  refuses_residual(with(kDiagonal + "  hand_tracking: {linear: 1 mm/s}\n"), "hand_tracking",
                   "not-used", {"from_covariance"});
  refuses_residual(with(kCarried + "  residual_frame: target\n", kCovariance), "residual_frame",
                   "not-used", {"matrix"});
  refuses_residual(with("  residual_deviations: 2\n"), "residual_deviations", "not-used",
                   {"residual_velocity"});
  refuses_residual(with(kDiagonal + "  residual_deviations: 0\n"), "residual_deviations",
                   "out-of-range", {"residual_deviations"});
  refuses_residual(with(kDiagonal + "  closing_speed: 1 mm/s\n"), "  closing_speed: 1 mm/s",
                   "contradiction", {"uncertainty.closing_speed", "count twice"});
  const std::string cvar = replaced(with(kDiagonal), "objective: base_angular_momentum",
                                    "objective: {quantity: base_angular_momentum, measure: cvar}");
  refuses_residual(cvar, "objective:", "not-supported", {"cvar", "closed form"});
}

TEST_CASE("a cone that is narrower than its own covariance is remarked") {
  const auto narrow = [](const std::string& text) { return remarks_of(text, kNarrowConeRule); };
  // 60 s at 0.1 deg/s: 6 deg along every axis.
  const std::string said = narrow(with(kCone, kCovariance));
  CHECK_THAT(said, Catch::Contains("uncertainty.cone_half_angle: the cone of 10 deg"));
  CHECK_THAT(said, Catch::Contains("with probability 0.95"));
  CHECK_THAT(narrow(with("  target_mass: 0.1\n", kCovariance)), Catch::Contains("exactly known"));
  CHECK(narrow(with("  cone_half_angle: 45 deg\n", kCovariance)).empty());
  CHECK(narrow(with("  cone_half_angle: from_covariance\n", kCovariance)).empty());
  CHECK(narrow(with(kCarried, kCovariance)).empty());
  CHECK(narrow(kProblem).empty());
  // Nothing is known of the direction.
  const std::string lost = narrow(with(kCone, replaced(kCovariance, "0.1 deg/s", "1 deg/s")));
  CHECK_THAT(lost, Catch::Contains("no cone holds it"));
}

TEST_CASE("a stated residual velocity that is smaller than its own covariance is remarked") {
  const auto narrow = [](const std::string& uncertainty, const std::string& covariance) {
    return remarks_of(with(uncertainty, covariance), kNarrowResidualRule);
  };
  // Rates are known to 1e-3 rad/s by the matrix, to 0.1 deg/s by the estimate: a part of 0.573, and
  // less in directions that mix both with the feature's velocity.
  const std::string said = narrow(kDiagonal, kCovariance);
  CHECK_THAT(said, Catch::Contains("uncertainty.residual_velocity: in some direction"));
  const auto at = said.find("deviation is ") + 13;
  CHECK(std::stod(said.substr(at)) < 0.573);
  CHECK(std::stod(said.substr(at)) > 0.1);
  // Larger in every direction but one.
  const std::string large = R"(  residual_velocity:
    - [1e-2, 0, 0, 0, 0, 0]
    - [0, 1e-2, 0, 0, 0, 0]
    - [0, 0, 1e-2, 0, 0, 0]
    - [0, 0, 0, 1e-2, 0, 0]
    - [0, 0, 0, 0, 1e-2, 0]
    - [0, 0, 0, 0, 0, 1e-2]
)";
  CHECK(narrow(large, kCovariance).empty());
  const std::string flat = replaced(large, "[0, 1e-2, 0, 0, 0, 0]", "[0, 0, 0, 0, 0, 0]");
  CHECK_THAT(narrow(flat, kCovariance), Catch::Contains("standard deviation is 0 of"));
  CHECK(narrow(kDiagonal, "").empty());
  CHECK(narrow(kCarried, kCovariance).empty());
}

TEST_CASE("what a measure leaves out of the stated uncertainty is remarked at its line") {
  const auto latched = [](const std::string& text) {
    return replaced(text, "  restitution: 0.5\n", "  contact: latch\n");
  };
  const std::string covariance = latched(with("  target_mass: 0.1\n", kCovariance));
  const std::string unused = remarks_of(covariance, kUnusedCovarianceRule);
  CHECK_THAT(unused, Catch::Contains(fmt::format("{}: target.state.covariance: the impulse",
                                                 line_of(covariance, "target:"))));
  CHECK_THAT(unused, Catch::Contains("state uncertainty.residual_velocity"));
  CHECK(remarks_of(latched(with(kCarried, kCovariance)), kUnusedCovarianceRule).empty());
  CHECK(remarks_of(latched(with("  target_mass: 0.1\n")), kUnusedCovarianceRule).empty());
  CHECK(remarks_of(with(kCone, kCovariance), kUnusedCovarianceRule).empty());

  const auto mean = [](const std::string& uncertainty) {
    return replaced(with(kCarried + uncertainty, kCovariance), "objective: base_angular_momentum",
                    "objective: {quantity: base_angular_momentum, measure: expectation}");
  };
  CHECK(remarks_of(mean(""), kNotInMeasureRule).empty());
  const std::string mass = mean("  target_mass: 0.1\n  contact_time: 2 s\n");
  const std::string said = remarks_of(mass, kNotInMeasureRule);
  CHECK_THAT(said, Catch::Contains(fmt::format("{}: uncertainty.target_mass: is drawn by trials",
                                               line_of(mass, "target_mass"))));
  CHECK_THAT(said, Catch::Contains("uncertainty.contact_time: is drawn by trials"));
  const std::string sampled = replaced(mean(""), "expectation}", "expectation, samples: 32}");
  CHECK_THAT(remarks_of(sampled, kNotInMeasureRule),
             Catch::Contains(fmt::format("{}: objective.samples: is not used",
                                         line_of(sampled, "samples: 32"))));
  // Without a residual velocity the samples have it all.
  const std::string samples = replaced(mean("  target_mass: 0.1\n"), kCarried, "");
  CHECK(remarks_of(samples, kNotInMeasureRule).empty());
}

TEST_CASE("a normal that a residual velocity fixes is remarked with the key that counts it") {
  const auto fixed = [](const std::string& text) { return remarks_of(text, kFixedNormalRule); };
  // 60 s at 0.1 deg/s: 6 deg along every axis.
  const std::string text = with(kCarried, kCovariance), said = fixed(text);
  CHECK_THAT(said, Catch::Contains(fmt::format("{}: uncertainty.residual_velocity: the impulse",
                                               line_of(text, "residual_velocity:"))));
  CHECK_THAT(said, Catch::Contains("with probability 0.95"));
  CHECK_THAT(said, Catch::Contains("this error is in no measure"));
  CHECK_THAT(said, Catch::Contains("state uncertainty.cone_half_angle: from_covariance"));
  CHECK_THAT(fixed(with(kDiagonal, kCovariance)), Catch::Contains("in no measure"));
  CHECK(fixed(with(kDiagonal)).empty());
  CHECK(fixed(with(kCone, kCovariance)).empty());
  CHECK(fixed(replaced(text, "  restitution: 0.5\n", "  contact: sticking\n")).empty());
  const std::string known = "    covariance: {linear_velocity: 1 mm/s, orientation: 0.1 deg}\n";
  CHECK(fixed(with(kCarried, known)).empty());
}

TEST_CASE("an estimate that leaves the contact open is remarked where the hand takes hold") {
  const auto wide = [](const std::string& target, const char* contact) {
    return remarks_of(replaced(with(kCarried, target), "  restitution: 0.5\n", contact),
                      kWideEstimateRule);
  };
  const auto known = [](const std::string& position, const std::string& orientation) {
    return "    covariance: {position: " + position + ", orientation: " + orientation +
           ", linear_velocity: 0.1 mm/s}\n";
  };
  const char* const latch = "  contact: latch\n";
  CHECK(wide(known("2 cm", "1 deg"), latch).empty());
  const std::string far = wide(known("5 cm", "1 deg"), latch);
  // 2.795 standard deviations, and a little from the rotation.
  CHECK_THAT(far,
             Catch::Contains("target.state.covariance: the contact point is known within 0.14"));
  CHECK_THAT(far, Catch::Contains("trials do not count"));
  CHECK_THAT(wide(known("1 mm", "15 deg"), latch), Catch::Contains("the normal within 36"));
  CHECK(wide(known("5 cm", "1 deg"), "  contact: sticking\n").empty());
  CHECK(wide(known("5 cm", "1 deg"), "  restitution: 0.5\n").empty());
}
