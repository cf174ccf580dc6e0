// impact.contact: what a problem may ask of a contact, and what it may not.
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/io_support.hpp"
#include "io/problem_text.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

using Changes = std::vector<std::pair<std::string, std::string>>;

/// What the shipped problems of a latch and of a sticking contact state under `uncertainty`.
const std::string kNoCone = "cone_half_angle: 0 deg";

CaptureProblem contact_problem(const std::string& name, const Changes& changes) {
  std::string text = file_text(source_path("problems/" + name + ".yaml"));
  for (const auto& [from, to] : changes) {
    INFO(from);
    REQUIRE(text.find(from) != std::string::npos);
    text = replaced(text, from, to);
  }
  text = replaced(text, "robots/", source_path("problems/robots/"));
  if (text.find("targets/") != std::string::npos) {
    text = replaced(text, "targets/", source_path("problems/targets/"));
  }
  return read_problem(TemporaryFolder().write("problem.yaml", text));
}

std::string contact_refusal(const std::string& name, const Changes& changes) {
  try {
    (void)contact_problem(name, changes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a contact is read, normal without a word, and the copy says the same") {
  CHECK(contact_problem("servicer_6dof_held", {}).impulse.contact == ContactLaw::Frictionless);
  CHECK(contact_problem("spart_sticking", {}).impulse.contact == ContactLaw::Sticking);
  const CaptureProblem latch = contact_problem(
      "servicer_latch", {{"  horizon", "  model: {target_mass_scale: 0}\n  horizon"}});
  CHECK(latch.impulse.contact == ContactLaw::Latch);
  CHECK(latch.post_impact.model.target_mass_scale == 0);
  const std::string copy = problem_to_json(latch);
  CHECK(read_problem_text(copy, "copy", latch.urdf).impulse.contact == ContactLaw::Latch);
}

TEST_CASE("what a contact cannot be is refused with the reason") {
  struct Bad {
    const char* problem;
    Changes changes;
    const char* says;
  };
  const char* const objective = "objective: base_angular_momentum";
  const Bad bads[] = {
      {"servicer_latch", {{"contact: latch", "contact: glue"}}, "impact.contact"},
      {"servicer_latch", {{"contact: latch", "contact: 1"}}, "impact.contact"},
      {"servicer_latch",
       {{"restitution: 0", "restitution: 0.1"}},
       "impact.restitution: is that of the contact 'normal'"},
      {"spart_sticking", {{"restitution: 0", "restitution: 0.1"}}, "impact.restitution"},
      {"spart_sticking", {{"contact: sticking", "contact: latch"}}, "a point mass offers nothing"},
      {"spart_given_push",
       {{"  source: given", "  source: given\n  contact: sticking"}},
       "a given impulse has none"},
      {"servicer_latch",
       {{kNoCone, "cone_half_angle: 5 deg"}},
       "uncertainty.cone_half_angle: the impulse of the contact 'latch' follows from the whole"},
      {"servicer_latch", {{kNoCone, "restitution: 0.1"}}, "uncertainty.restitution"},
      {"servicer_latch",
       {{objective, "objective: {quantity: base_angular_momentum, measure: worst_case}"}},
       "objective.measure: 'worst_case' is that over a cone"},
      {"servicer_latch",
       {{objective, "objective: {quantity: attitude_turned, after: 2 s}"}},
       "objective.attitude_turned"},
      {"servicer_latch",
       {{"closing_speed_min", "coupling_singular_value_min: 0.1\n  closing_speed_min"}},
       "constraints.coupling_singular_value_min"},
      {"servicer_latch",
       {{"  horizon", "  contact: {model: compliant, damping: 10}\n  horizon"}},
       "post_impact.contact: a spring-damper with Coulomb friction rebounds"},
      {"servicer_6dof_held",
       {{"  horizon", "  model: {target_mass_scale: 2}\n  horizon"}},
       "post_impact.model.target_mass_scale"},
  };
  for (const Bad& bad : bads) {
    const std::string says = contact_refusal(bad.problem, bad.changes);
    INFO(bad.problem << " " << bad.says << "\n" << says);
    CHECK(says.find(bad.says) != std::string::npos);
  }
}

TEST_CASE("samples of mass, inertia, place and time are for every contact") {
  const CaptureProblem problem = contact_problem(
      "servicer_latch",
      {{"objective: base_angular_momentum",
        "objective: {quantity: base_angular_momentum, measure: expectation, samples: 8}"},
       {kNoCone,
        "target_mass: 0.1\n  target_inertia: 0.1\n  contact_point: 0.01\n  contact_time: 0.5"}});
  CHECK(problem.measure.kind == RiskMeasure::Expectation);
}

TEST_CASE("the motion of the hand is read, at rest without a word, and the copy says the same") {
  CHECK_FALSE(contact_problem("deos_latch", {}).hand_motion.moves());
  CHECK(problem_to_json(contact_problem("deos_latch", {})).find("hand_velocity") ==
        std::string::npos);
  const CaptureProblem matched = contact_problem("matched_medium", {});
  CHECK(matched.hand_motion.velocity == HandVelocity::MatchAll);
  CHECK(matched.hand_motion.rates == ArrivalRates::LeastBaseRate);
  CHECK(matched.approach.abort);
  const CaptureProblem stated = contact_problem(
      "matched_medium", {{"hand_velocity: match_all",
                          "hand_velocity: {linear: [1 cm/s, 0, 0], angular: [0, 0, 0.1 deg/s]}"},
                         {"  wait: 3 s", "  wait: 3 s\n  abort: false"}});
  CHECK(stated.hand_motion.velocity == HandVelocity::Stated);
  CHECK(stated.hand_motion.linear->isApprox(Vector3d(0.01, 0, 0)));
  const CaptureProblem copy = read_problem_text(problem_to_json(stated), "copy", stated.urdf);
  CHECK(copy.hand_motion.velocity == HandVelocity::Stated);
  CHECK(*copy.hand_motion.linear == *stated.hand_motion.linear);
  CHECK(*copy.hand_motion.angular == *stated.hand_motion.angular);
  CHECK(copy.hand_motion.rates == ArrivalRates::LeastBaseRate);
  CHECK_FALSE(copy.approach.abort);
}

TEST_CASE("a measure of a hand that moves is one over its residual velocity") {
  const auto measured = [](const std::string& hand, const std::string& measure,
                           const std::string& uncertainty) -> Changes {
    return {{"hand_velocity: match_all", "hand_velocity: " + hand},
            {"objective: base_angular_momentum",
             "objective: {quantity: base_angular_momentum, measure: " + measure + "}"},
            {kNoCone, uncertainty}};
  };
  const std::string matrix =
      "residual_velocity: [[1e-6, 0, 0, 0, 0, 0], [0, 1e-6, 0, 0, 0, 0], [0, 0, 1e-6, 0, 0, 0], "
      "[0, 0, 0, 1e-7, 0, 0], [0, 0, 0, 0, 1e-7, 0], [0, 0, 0, 0, 0, 1e-7]]";
  for (const std::string hand : {"match_normal", "match_linear", "match_all"}) {
    for (const std::string measure : {"expectation", "worst_case", "nominal"}) {
      const CaptureProblem problem =
          contact_problem("matched_medium", measured(hand, measure, matrix));
      CHECK(problem.hand_motion.moves());
      REQUIRE(problem.uncertainty.residual_velocity);
      CHECK(problem.uncertainty.residual_velocity->covariance->trace() == Approx(3.3e-6));
    }
  }
  CHECK_THAT(contact_refusal("matched_medium", measured("match_all", "cvar", matrix)),
             Catch::Contains("'cvar' has no closed form"));
  CHECK_THAT(
      contact_refusal("matched_medium", measured("match_all", "expectation", "target_mass: 0.1")),
      Catch::Contains("state uncertainty.residual_velocity, or use 'nominal'"));
}

TEST_CASE("a motion of the hand that nothing can follow is refused with the reason") {
  const auto refusal = [](const Changes& changes) {
    return contact_refusal("matched_medium", changes);
  };
  const auto velocity = [](const std::string& value) -> Changes {
    return {{"hand_velocity: match_all", "hand_velocity: " + value}};
  };
  CHECK_THAT(refusal(velocity("{linear: [-1 cm/s, 0, 0]}")),
             Catch::Contains("separates") && Catch::Contains("moves the target away"));
  CHECK_THAT(refusal(velocity("{}")), Catch::Contains("'linear', 'angular' or both"));
  CHECK_THAT(refusal({{"contact: latch", "contact: normal"}}),
             Catch::Contains("needs impact.contact 'latch' or 'sticking'"));
  CHECK_THAT(refusal({{"contact: latch", "contact: sticking"}}),
             Catch::Contains("points that move together along the normal"));
  const auto sticking = [&](const std::string& value) {
    Changes changes = velocity(value);
    changes.push_back({"contact: latch", "contact: sticking"});
    return refusal(changes);
  };
  CHECK_THAT(sticking("match_normal"), Catch::Contains("points that move together"));
  CHECK_THAT(sticking("{linear: [0, 0, 0]}"), Catch::Contains("nothing pushes"));
  CHECK_THAT(sticking("{angular: [0, 0, 0.1 deg/s]}"), Catch::Contains("state 'linear'"));
  CHECK_THAT(refusal({{"contact: latch", "contact: latch\n  magnitude: 3"}}),
             Catch::Contains("not-used: impact.magnitude: only a given impulse has one"));
  CHECK_THAT(refusal({{"base: floating", "base: held"}}), Catch::Contains("needs 'floating'"));
  CHECK_THAT(refusal({{"objective: base_angular_momentum", "objective: impulse_magnitude"}}),
             Catch::Contains("the impulse is zero in every posture"));
  CHECK_THAT(refusal({{"hand_velocity: match_all",
                       "hand_velocity: {linear: [0, 0, 0], angular: [0, 0, 0]}"},
                      {"objective: base_angular_momentum", "objective: impulse_magnitude"}}),
             Catch::Contains("stated zeros included"));
  CHECK_THAT(refusal(velocity("{linear: [1 cm/s, 0, 0]}")),
             Catch::Contains("closes in along the normal of 'handle' at 0.01 m/s") &&
                 Catch::Contains("approach.abort: false (the default is true)"));
  CHECK_THAT(refusal({{"hand_velocity: match_all", "hand_velocity: {linear: [-1 cm/s, 0, 0]}"},
                      {"  features:\n",
                       "  features:\n    - {name: knob, point: [0, 0, 0.5], normal: [0, 0, 1]}\n"},
                      {"  feature: handle", "  feature: [knob, handle]"},
                      {"  wait: 3 s", "  wait: 3 s\n  abort: false"}}),
             Catch::Contains("moves the target away from the hand along the normal of 'handle'"));
  CHECK_THAT(refusal({{"joints: all", "joints: [joint_1, joint_2]"}}),
             Catch::Contains("all joints move"));
  CHECK_THAT(refusal({{"post_impact:\n",
                       "post_impact:\n  wheels: {torque: 1, capacity: 4, preset: [1, 0, 0]}\n"}}),
             Catch::Contains("preset: momentum in the wheels"));
  CHECK_THAT(refusal({{"  hand_velocity: match_all\n", ""}}),
             Catch::Contains("a hand at rest has none"));
  CHECK_THAT(contact_refusal("spart_sticking", {{"variables:",
                                                 "contact: {hand_velocity: "
                                                 "match_linear}\nvariables:"}}),
             Catch::Contains("contact.hand_velocity"));
  CHECK_THAT(contact_refusal("planar_three_link_client",
                             {{"variables:", "contact: {hand_velocity: match_all}\nvariables:"}}),
             Catch::Contains("6 components") && Catch::Contains("3 joints"));
}
