// The result of `replan`.
#include "io/fields/replan.hpp"

#include "io/fields/plan.hpp"
#include "io/fields/values.hpp"

namespace stillbase::io {

const ConstraintValue* tightest_constraint(const ReplanResult& result) {
  const ConstraintValue* out = nullptr;
  for (const ConstraintValue& constraint : result.constraints) {
    if (constraint.lower == constraint.upper) continue;
    if (out == nullptr || margin_of(constraint) < margin_of(*out)) out = &constraint;
  }
  return out;
}

static const About kOfObjective = needed("`objective.unit`");

static void fields(Table& t, ReplanJudgement& judgement) {
  t("value", Number(judgement.value), "of the measure", kOfObjective);
  t("max_violation", Number(judgement.max_violation), "of the constraints, in their units",
    kNeeded);
}

static void fields(Table& t, ContactDeviations& contact) {
  t("point", Number(contact.point), "root of the sum over three axes", needed("m"));
  t("normal_half_angle", Number(contact.half_angle),
    "about the normal, holds the true one with probability 0.95", needed("rad"));
  t("closing_speed", Number(contact.closing_speed), "", needed("m/s"));
}

static void update_fields(Table& t, ReplanRecord& record, ReplanUpdate& update) {
  ReplanResult& result = update.result;
  std::string reason = result.reason;
  t("time", Number(update.time), "of the estimate", needed("s"));
  t("status", Word(result.status, names_up_to(ReplanStatus::Refused)),
    "whether the new posture is feasible, and shown to be a local minimum", kNeeded);
  t("reason", WrittenIf(Text(reason), !reason.empty()), "why the estimate was refused",
    {.without = "it was used"});
  t("cut", Flag(result.was_cut), "the deadline came before the steps had ended", kNeeded);
  t("old", map_of(result.old), "the old posture under this estimate", kNeeded);
  t("corrected", map_of(result.corrected), "the old posture moved onto the constraints", kNeeded);
  t("value", Number(result.value), "of the measure at the new posture", kOfObjective);
  t("nominal", Number(result.nominal), "at the nominal direction", kOfObjective);
  t("worst_case", Number(result.worst_case), "over the cone", kOfObjective);
  t("max_violation", Number(result.max_violation), "of the constraints, in their units", kNeeded);
  t("kkt_residual", OrNull(Number(result.kkt_residual), !(result.kkt_residual < kInfinity)),
    "of the search's smooth form; null: not known", kNeeded);
  const ConstraintValue* const tightest = tightest_constraint(result);
  std::string name = tightest == nullptr ? "" : tightest->name;
  double margin = tightest == nullptr ? 0 : margin_of(*tightest);
  t("tightest", Map([&name, &margin](Table& m) {
      m("name", Text(name), "of the constraint", kNeeded);
      m("margin", Number(margin), "from its limit, in its unit; negative: violated", kNeeded);
    }),
    "the inequality that is nearest to its limit", kNeeded);
  t("configuration", Map([&](Table& m) { posture_fields(m, record.robot, result.configuration); }),
    "the new posture", kNeeded);
  ContactDeviations contact = result.contact.value_or(ContactDeviations{});
  t("contact", WrittenIf(map_of(contact), result.contact.has_value()),
    "standard deviations of the predicted contact", {.without = "no covariance was stated"});
  t("cone_half_angle", Number(result.cone_half_angle), "of the worst case", needed("rad"));
  t("steps", Integer(result.steps, 0, 1000000), "of sequential quadratic programming", kNeeded);
  t("seconds", WrittenIf(Number(result.seconds), record.with_seconds), "by the wall clock",
    {.unit = "s", .without = "--timing was not given"});
}

void replan_fields(Table& t, ReplanRecord& record) {
  format_fields(t, "stillbase.replan");
  t("problem", Text(record.problem), "its name", kNeeded);
  t("objective", Map([&record](Table& m) {
      m("name", Text(record.objective), "", kNeeded);
      m("unit", Text(record.unit), "", kNeeded);
    }),
    "what is minimised", kNeeded);
  std::vector<std::string> names = joint_names(record.robot);
  t("joint_names", Texts(names), "", kNeeded);
  t("updates",
    List<ReplanUpdate>(record.updates,
                       [&record](ReplanUpdate& update) {
                         return Map([&](Table& m) { update_fields(m, record, update); });
                       }),
    "by time", kNeeded);
  t("after_impact", WrittenIf(Text(record.after_impact), !record.after_impact.empty()),
    "what is said of the last posture's time after the impact",
    {.without = "the problem asks for no controller, or the last posture is not feasible"});
}

}  // namespace stillbase::io
