// The impact object of plans, `inspect` and `analyze`.
#include "io/fields/plan.hpp"

namespace stillbase::io {

Map halves(Vector6d& both, const char* upper, const char* upper_unit, const char* lower,
           const char* lower_unit) {
  return Map([=, &both](Table& t) {
    Vector3d first = both.head<3>(), second = both.tail<3>();
    t(upper, Vector(first), "", needed(upper_unit, "B"));
    t(lower, Vector(second), "", needed(lower_unit, "B"));
    both << first, second;
  });
}

Map momentum_split(Vector3d& total, Vector3d& base, Vector3d& coupling) {
  return Map(
      [&](Table& t) {
        const About about = needed("N m s", "B");
        t("total", Vector(total), "", about);
        t("base", Vector(base), "", about);
        t("coupling", Vector(coupling), "", about);
      },
      {.name = "momentum_split"});
}

namespace {

void motion_before_fields(Table& t, MotionBefore& before, int n) {
  const About momentum = needed("N m s", "B");
  t("base_velocity", halves(before.Omega, "linear", "m/s", "angular", "rad/s"),
    "that leaves the robot without momentum", kNeeded);
  t("joint_velocities", Numbers(before.phidot, n), "", needed("rad/s (m/s)"));
  t("hand_velocity", halves(before.hand_velocity, "linear", "m/s", "angular", "rad/s"), "",
    kNeeded);
  t("relative_velocity", halves(before.relative_velocity, "linear", "m/s", "angular", "rad/s"),
    "of the target's point and of the target, less those of the hand", kNeeded);
  t("base_momentum", Vector(before.base), "angular momentum of the base part", momentum);
  t("at_rest", Map([&](Table& m) {
      m("impulse", halves(before.Fbar_at_rest, "force", "N s", "moment", "N m s"), "", kNeeded);
      m("base_momentum", Vector(before.base_at_rest), "right after the impact", momentum);
    }),
    "with a hand at rest in the same posture", kNeeded);
}

}  // namespace

void impact_object_fields(Table& t, ImpactSummary& impact, const RobotModel& robot) {
  const int n = robot.n();
  const About rates = needed("rad/s (m/s)");
  CaseJudgement& judgement = impact.judgement;
  t("impulse", halves(impact.Fbar, "force", "N s", "moment", "N m s"), "on the hand", kNeeded);
  t("base_velocity_jump", halves(impact.Delta_Omega, "linear", "m/s", "angular", "rad/s"), "",
    kNeeded);
  t("joint_velocity_jump", Numbers(impact.Delta_phidot, n), "", rates);
  t("joint_velocity_rns", Numbers(impact.Delta_phidot_rns, n),
    "its part in the reaction null space", rates);
  t("joint_velocity_orthogonal", Numbers(impact.Delta_phidot_orthogonal, n),
    "its part orthogonal to that", rates);
  t("momentum", momentum_split(impact.total, impact.base, impact.coupling),
    "angular momentum right after the impact, gained by a robot at rest, and its parts", kNeeded);
  t("case", Word(judgement.impact_case, impact_case_names()), "of the paper's classification",
    kNeeded);
  t("case_tolerance", Number(judgement.tolerance, kNonNegative),
    "below which a part counts as zero", kNeeded);
  t("case_residuals", Map([&](Table& m) {
      m("total", Number(judgement.total, kNonNegative), "", kNeeded);
      m("base", Number(judgement.base, kNonNegative), "", kNeeded);
      m("coupling", Number(judgement.coupling, kNonNegative), "", kNeeded);
    }),
    "sizes of the parts, relative", kNeeded);
  t("rank_tolerance", Number(impact.rank_tolerance, kNonNegative),
    "below which a singular value counts as zero", kNeeded);
  t("rank", Integer(impact.rank, 0, kMaxJoints), "of the angular coupling matrix", kNeeded);
  t("closing_speed", Number(impact.closing_speed), "of hand and target along the normal",
    needed("m/s"));
  t("joint_resistance", Word(impact.resistance.model, resistance_names()),
    "how joints resist during the impact", {.need = Need::Required, .decides = true});
  t("joint_resistance_values",
    Map([&](Table& m) { resistance_values(m, impact.resistance, robot); }),
    "its values, as in `impact.joint_resistance` of a problem", kNeeded);
  MotionBefore before = impact.before.value_or(MotionBefore{});
  t("before",
    Map([&](Table& m) { motion_before_fields(m, before, n); },
        {.name = "motion_before", .is_written = impact.before.has_value()}),
    "the robot right before a contact with a hand that moves", {.without = "at rest"});
  if (t.reader() != nullptr && t.reader()->has("before")) impact.before = before;
}

}  // namespace stillbase::io
