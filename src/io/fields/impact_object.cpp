// The impact object of plans, `inspect` and `analyze`.
#include "io/fields/plan.hpp"

namespace stillbase::io {

Map impulse_of(Vector6d& F) {
  return Map([&F](Table& t) {
    Vector3d force = F.head<3>(), moment = F.tail<3>();
    t("force", Vector(force), "force impulse", needed("N s", "B"));
    t("moment", Vector(moment), "moment impulse about the origin of the hand",
      needed("N m s", "B"));
    F << force, moment;
  });
}

namespace {

/// A velocity [v; omega] in B. @param point whose velocity is v @param body whose velocity is omega
Map velocity_of(Vector6d& V, const char* point, const char* body) {
  return Map([=, &V](Table& t) {
    Vector3d linear = V.head<3>(), angular = V.tail<3>();
    t("linear", Vector(linear), point, needed("m/s", "B"));
    t("angular", Vector(angular), body, needed("rad/s", "B"));
    V << linear, angular;
  });
}

Map base_velocity_of(Vector6d& Omega) {
  return velocity_of(Omega, "of the base centroid", "of the base");
}

}  // namespace

Map momentum_split(Vector3d& total, Vector3d& base, Vector3d& coupling) {
  return Map([&](Table& t) {
    const About about = needed("N m s", "B");
    t("total", Vector(total), "of both parts", about);
    t("base", Vector(base), "base part, H~omega omega", about);
    t("coupling", Vector(coupling), "coupling part, H~omegaphi phidot", about);
  });
}

namespace {

void motion_before_fields(Table& t, MotionBefore& before, int n) {
  const About momentum = needed("N m s", "B");
  t("base_velocity", base_velocity_of(before.Omega), "that leaves the robot without momentum",
    kNeeded);
  t("joint_velocities", Numbers(before.phidot, n), "joint rates that move the hand so",
    needed("rad/s (m/s)"));
  t("hand_velocity", velocity_of(before.hand_velocity, "of the origin of the hand", "of the hand"),
    "of the hand", kNeeded);
  t("relative_velocity",
    velocity_of(before.relative_velocity, "of the target's point at the hand", "of the target"),
    "of the target less that of the hand", kNeeded);
  t("base_momentum", Vector(before.base), "base part of the robot alone before the contact",
    momentum);
  t("at_rest", Map([&](Table& m) {
      m("impulse", impulse_of(before.Fbar_at_rest), "on the hand", kNeeded);
      m("base_momentum", Vector(before.base_at_rest), "base part right after the impact", momentum);
    }),
    "with a hand at rest in the same posture", kNeeded);
}

}  // namespace

void impact_object_fields(Table& t, ImpactSummary& impact, const RobotModel& robot) {
  const int n = robot.n();
  const About rates = needed("rad/s (m/s)");
  CaseJudgement& judgement = impact.judgement;
  t("impulse", impulse_of(impact.Fbar), "on the hand", kNeeded);
  t("base_velocity_jump", base_velocity_of(impact.Delta_Omega), "velocity change of the base",
    kNeeded);
  t("joint_velocity_jump", Numbers(impact.Delta_phidot, n), "change of the joint rates", rates);
  t("joint_velocity_rns", Numbers(impact.Delta_phidot_rns, n),
    "its part in the reaction null space", rates);
  t("joint_velocity_orthogonal", Numbers(impact.Delta_phidot_orthogonal, n),
    "its part orthogonal to that", rates);
  t("momentum", momentum_split(impact.total, impact.base, impact.coupling),
    "angular momentum right after the impact, about the system centroid: what the impulse brings "
    "to a robot at rest; after a latch that of robot and target",
    kNeeded);
  t("case", Word(judgement.impact_case, impact_case_names()),
    "of the paper's classification: G1, G2, G3, C1 or C2", kNeeded);
  t("case_tolerance", Number(judgement.tolerance, kNonNegative), "residuals below it count as zero",
    kNeeded);
  t("case_residuals", Map([&](Table& m) {
      m("total", Number(judgement.total, kNonNegative), "of both parts", kNeeded);
      m("base", Number(judgement.base, kNonNegative), "of the base part", kNeeded);
      m("coupling", Number(judgement.coupling, kNonNegative), "of the coupling part", kNeeded);
    }),
    "norm of a momentum over |f| |r_gh| + |t|, after a latch over the size of the target's",
    kNeeded);
  t("rank_tolerance", Number(impact.rank_tolerance, kNonNegative),
    "singular values at or below it count as zero, relative to the largest", kNeeded);
  t("rank", Integer(impact.rank, 0, kMaxJoints), "of the angular coupling matrix", kNeeded);
  t("closing_speed", Number(impact.closing_speed),
    "of the target along the normal, towards a hand at rest", needed("m/s"));
  t("joint_resistance", Word(impact.resistance.model, resistance_names()),
    "how joints resist during the impact: `free`, `rotor_inertia`, `servo` or `locked`",
    {.need = Need::Required, .decides = true});
  t("joint_resistance_values",
    Map([&](Table& m) { resistance_values(m, impact.resistance, robot); }),
    "its values, as in `impact.joint_resistance` of a problem", kNeeded);
  MotionBefore before = impact.before.value_or(MotionBefore{});
  t("before",
    Map([&](Table& m) { motion_before_fields(m, before, n); },
        {.is_written = impact.before.has_value()}),
    "the robot right before the contact where its hand moves", {.without = "at rest"});
  if (t.reader() != nullptr && t.reader()->has("before")) impact.before = before;
}

}  // namespace stillbase::io
