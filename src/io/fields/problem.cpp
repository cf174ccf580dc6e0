// A problem file: its sections in order, and the small ones among them.
#include <fmt/format.h>

#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/search/search.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

void search_fields(Table& t, SearchSpec& search) {
  t("optimizer", Text(search.optimizer, nlp::optimizer_names(), "optimizers"),
    "name of a local optimizer");
  t("starts",
    Either({Instead("auto", search.starts == kAutomaticStarts,
                    [&search] { search.starts = kAutomaticStarts; }),
            Integer(search.starts, 1, kMaxStarts)}),
    "number of start points, 16 times as many where the equations leave no freedom, or `auto`: 64, "
    "and of a worst case or a mean over the residual velocity rounds of further ones until eight "
    "have ended at the best minimum");
  t("seed", Seed(search.seed), "same seed, same bytes");
  t("max_candidates", Integer(search.max_candidates, 1, kManyTimes), "solutions kept in the plan");
}

void hand_fields(Table& t, HandSpec& hand) {
  t("constraint", Word(hand.constraint, kHandConstraintNames),
    "`none` (a contact feature is then reached by a free `base_position` alone), `position`, "
    "`axis` (position, and approach axis against the normal), `pose` (all axes)");
  t("position",
    Either({Instead("feature", !hand.position), Vector(hand.position, Dimension::Length, kPlace)}),
    "where the hand's origin must be (beside a stated `impact.direction`), or `feature` (the "
    "contact feature at the contact time)");
  t("orientation", Either({Instead("feature", !hand.orientation), Orientation(hand.orientation)}),
    "`pose`: of the hand's frame, or `feature` (approach axis against the normal, or against a "
    "stated `impact.direction`)");
  t("frame", Word(hand.frame, kFrameNames), "of position and orientation: `inertial` or `base`");
  t("approach_axis", Vector(hand.approach_axis, VectorKind::Direction),
    "direction in the hand's frame that points out of the hand", {.frame = "hand"});
  t("roll", Number(hand.roll, Dimension::Angle, kAngle),
    "`pose` without stated orientation: angle about the normal");
}

void constraints_fields(Table& t, CaptureProblem& problem) {
  ConstraintSpec& constraints = problem.constraints;
  t("case", Word(constraints.impact_case, kCaseConstraintNames),
    "the paper's impact case: `none`, `C` (C1 or C2), `C1`, `C2`, `G2`, `G3`");
  t("joint_limit_margin",
    Number(constraints.joint_limit_margin, Dimension::JointPosition, kDistance),
    "kept from every joint limit");
  t("closing_speed_min", Number(constraints.closing_speed_min, Dimension::Velocity, kSpeedPositive),
    "smallest closing speed of the nominal target towards a hand at rest, also where "
    "`contact.hand_velocity` has the hand move along; without it the best plan would be to miss "
    "the target. A trial below it is a miss where the hand waits");
  t("joint_rate_scale", Number(constraints.joint_rate_scale, kLargePositive),
    "the joint rates right after the nominal impact stay below this part of the robot file's "
    "limits");
  t("joint_rate_max",
    JointValues(constraints.joint_rate_max, problem.robot, kJointVelocity, kLargePositive),
    "instead: limits of their own");
  t.not_both("joint_rate_scale", "joint_rate_max");
  const Range least{.lower = 0, .upper = 1e9};
#define STILLBASE_LEAST_VALUE(quantity, dimension, uncounted, sentence) \
  t(#quantity "_min", Number(constraints.quantity##_min, Dimension::dimension, least), sentence);
  STILLBASE_LEAST_VALUES(STILLBASE_LEAST_VALUE)
#undef STILLBASE_LEAST_VALUE
  t("jacobian_length", Number(constraints.jacobian_length, Dimension::Length, kSize),
    "converts angles into lengths there");
  t("clearance", Number(constraints.clearance, Dimension::Length, kDistance),
    "the search keeps this distance at the contact between the shapes of arm, base, base-fixed "
    "obstacles and target; see problems/reference/constraints.md");
}

/// What the impulse of a target needs is said where the source is stated, before what names parts
/// of the target.
void check_target_is_stated(MapReader& map, ImpulseSource source) {
  if (source == ImpulseSource::Given || map.has("target")) return;
  map.context().add(
      map.line_of("impact"), "missing-key",
      fmt::format("{}: must be stated: impact.source '{}' needs its {}", map.path_of("target"),
                  word_of(kImpulseSourceNames, source),
                  source == ImpulseSource::RigidBody ? "mass, inertia, motion and contact feature"
                                                     : "mass"));
}

}  // namespace

void problem_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources) {
  const auto section = [&problem](void (*table)(Table&, CaptureProblem&)) {
    return Map([&problem, table](Table& m) { table(m, problem); }, {.is_section = true});
  };
  format_fields(t, "stillbase.problem");
  t("name", Text(problem.name), "short name", {.without = "stem of the file's name"});
  t("purpose", Text(problem.purpose), "one sentence", {.without = "`Capture of`, with the target"});
  t("robot", Map([&](Table& m) { robot_fields(m, problem, sources); }), "", kNeeded);
  t("target",
    Map([&](Table& m) { target_fields(m, problem, sources); },
        {.is_written = problem.target.has_value()}),
    "the body that is captured; left out for a given impulse without body", {.without = "none"});
  t("impact", section(impact_fields), "", kNeeded);
  if (t.reader() != nullptr) check_target_is_stated(*t.reader(), problem.impulse.source);
  t("contact",
    Map([&problem](Table& m) { contact_fields(m, problem); },
        {.is_written = problem.hand_motion.moves(), .is_section = true}),
    "how the hand moves right before the contact");
  t("variables", section(variables_fields), "what the search may change; all else stays as stated");
  t("objective",
    Map([&](Table& m) { objective_fields(m, problem); }, {.alone = "quantity", .is_section = true}),
    "the quantity alone, or a map", kNeeded);
  t("hand", Map([&](Table& m) { hand_fields(m, problem.hand); }, {.is_section = true}),
    "equations on the hand");
  t("constraints", section(constraints_fields), "");
  t("uncertainty", section(uncertainty_fields), "");
  t("search", Map([&](Table& m) { search_fields(m, problem.search); }, {.is_section = true}), "");
  t("approach", section(approach_fields), "");
  t("post_impact",
    Map([&](Table& m) { post_impact_fields(m, problem.post_impact); }, {.is_section = true}), "");
  t("obstacles",
    maps_of(problem.obstacles, {.unique_key = "name"},
            Obstacle{{}, Frame::Inertial, {}, Sphere{0}}),
    "list of fixed bodies");
  if (t.reader() != nullptr && problem.purpose.empty()) {
    problem.purpose = problem.target ? "Capture of " + problem.target->name + "."
                                     : "An impulse without a target.";
  }
}

}  // namespace stillbase::io
