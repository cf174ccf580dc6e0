// The impact object of plans, `inspect` and `analyze`.
#include "io/fields/plan.hpp"

namespace stillbase::io {

namespace {

/// Two vectors of three as one of six.
Map halves(Vector6d& v, const char* upper, const char* lower) {
  return Map([&v, upper, lower](Table& t) {
    Vector3d first = v.head<3>(), second = v.tail<3>();
    t(upper, Vector(first), "", kNeeded);
    t(lower, Vector(second), "", kNeeded);
    v << first, second;
  });
}

}  // namespace

void impact_object_fields(Table& t, ImpactSummary& impact, const RobotModel& robot) {
  const int n = robot.n();
  CaseJudgement& judgement = impact.judgement;
  t("impulse", halves(impact.Fbar, "force", "moment"), "on the hand, in N s and N m s",
    {.need = Need::Required, .frame = "B"});
  t("base_velocity_jump", halves(impact.Delta_Omega, "linear", "angular"), "in m/s and rad/s",
    {.need = Need::Required, .frame = "B"});
  t("joint_velocity_jump", Numbers(impact.Delta_phidot, n), "in rad/s (m/s)", kNeeded);
  t("joint_velocity_rns", Numbers(impact.Delta_phidot_rns, n),
    "its part in the reaction null space", kNeeded);
  t("joint_velocity_orthogonal", Numbers(impact.Delta_phidot_orthogonal, n),
    "its part orthogonal to that", kNeeded);
  t("momentum",
    Map(
        [&](Table& m) {
          m("total", Vector(impact.total), "", kNeeded);
          m("base", Vector(impact.base), "", kNeeded);
          m("coupling", Vector(impact.coupling), "", kNeeded);
        },
        {.name = "momentum_split"}),
    "angular momentum gained, and its parts, in N m s", {.need = Need::Required, .frame = "B"});
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
  t("closing_speed", Number(impact.closing_speed), "in m/s", kNeeded);
  t("joint_resistance", Word(impact.resistance.model, resistance_names()),
    "how joints resist during the impact", {.need = Need::Required, .decides = true});
  t("joint_resistance_values",
    Map([&](Table& m) { resistance_values(m, impact.resistance, robot); }),
    "its values, as in `impact.joint_resistance` of a problem", kNeeded);
}

}  // namespace stillbase::io
