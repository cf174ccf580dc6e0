// Results of `inspect`, `analyze`, `simulate` and `plan --pareto`.
#include "io/fields/results.hpp"

#include <cmath>

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/simulation/controllers.hpp>

namespace stillbase::io {

namespace {

/// A list of directions (columns).
Rows directions_of(const Eigen::MatrixXd& columns) { return Rows(columns.transpose()); }

}  // namespace

void inspection_fields(Table& t, const RobotModel& robot, const RobotState& state) {
  const auto kinematics = compute_kinematics<double>(robot, state.phi);
  const auto inertia = compute_inertia<double>(robot, kinematics);
  const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
  const auto tilde = compute_tilde_inertia<double>(inertia);
  const auto hat = compute_hat_inertia<double>(inertia, jacobian);
  const auto bias = compute_bias<double>(robot, kinematics, inertia, state.Omega, state.phidot);
  const auto momentum = compute_momentum<double>(inertia, tilde, state.Omega, state.phidot);
  const ReactionNullSpace space = angular_reaction_null_space(tilde);
  // Without mass of the base the whole inertia matrix is singular: what its inverse gives is left
  // out.
  const bool has_inverse = robot.base.mass > 0;
  Matrix6d hand_inverse_inertia = Matrix6d::Zero();
  if (has_inverse) {
    const auto factor = factorize_inertia<double>(inertia, JointVectord::Zero(robot.n()), {});
    hand_inverse_inertia = extended_inverse_inertia(factor, jacobian);
  }
  const auto numbers = [&t](const char* key, Eigen::VectorXd x, const char* text,
                            const char* unit) {
    t(key, Numbers(x, static_cast<int>(x.size())), text, needed(unit));
  };
  const auto matrix = [&t](const char* key, const Eigen::MatrixXd& x, const char* text) {
    t(key, Rows(x), text, kNeeded);
  };
  std::vector<std::string> names = joint_names(robot);
  double mass = robot.total_mass();
  int rank = space.rank;
  t("joint_names", Texts(names), "in joint order", kNeeded);
  t("total_mass", Number(mass), "of the robot", needed("kg"));
  numbers("centroid", inertia.r_bg, "system centroid", "m");
  numbers("hand_position", kinematics.r_bh, "hand", "m");
  matrix("H_b", inertia.H_b, "base inertia");
  matrix("H_bphi", inertia.H_bphi, "inertia coupling");
  matrix("H_phi", inertia.H_phi, "arm inertia on a fixed base");
  matrix("J_phi", jacobian.J_phi, "hand Jacobian on a fixed base");
  matrix("R_bh", jacobian.R_bh, "shift of velocity from base to hand");
  numbers("c_b", bias.c_b, "velocity-dependent force and moment at the base", "N, N m");
  numbers("c_phi", bias.c_phi, "velocity-dependent joint torques", "N m");
  numbers("P", momentum.P, "linear momentum", "N s");
  numbers("L_g", momentum.L_g, "angular momentum about the system centroid", "N m s");
  matrix("Htilde_omega", tilde.Htilde_omega, "central inertia of the locked robot");
  matrix("Htilde_omegaphi", tilde.Htilde_omegaphi, "angular coupling");
  matrix("Htilde_phi", tilde.Htilde_phi, "arm inertia, base free to translate");
  matrix("Hhat_phi", hat.Hhat_phi, "generalized inertia, base free");
  matrix("Jhat_phi", hat.Jhat_phi, "generalized Jacobian, base free");
  t("rns_rank", Integer(rank, 0, 3), "rank of the angular coupling", kNeeded);
  numbers("singular_values", space.singular_values, "of the angular coupling", "");
  t("hand_inverse_inertia", WrittenIf(Rows(hand_inverse_inertia), has_inverse),
    "hand velocity change per impulse", {.without = "a base without mass"});
  // The state names no target, so nothing closes in.
  ImpactSummary impact;
  const bool has_impact = state.Fbar.has_value() && has_inverse;
  if (has_impact) impact = summarize_impact(robot, state.phi, {}, *state.Fbar, 0);
  t("impact",
    Map([&](Table& m) { impact_object_fields(m, impact, robot); }, {.is_written = has_impact}),
    "where the state names an impulse");
}

static void fields(Table& t, ZeroDirections& zero) {
  t("directions", directions_of(zero.directions), "orthonormal basis", needed("1", "B"));
  t("rank", Integer(zero.rank, 0, 3), "of the map from impulse to momentum", kNeeded);
  t("singular_values", Numbers(zero.singular_values), "of that map", needed("m"));
}

static void fields(Table& t, CaseDirections& cases) {
  const MapOptions zero{.name = "zero"};
  t("tolerance", Number(cases.tolerance, kNonNegative), "below which a value counts as zero",
    kNeeded);
  t("base", map_of(cases.base, zero), "G2: the base part is zero", kNeeded);
  t("coupling", map_of(cases.coupling, zero), "G3: the coupling part is zero", kNeeded);
  t("total", map_of(cases.total, zero), "C1: the total is zero", kNeeded);
  t("all", map_of(cases.all, zero), "C2: all three are zero", kNeeded);
}

static void fields(Table& t, FavourableDirections& favourable) {
  t("directions", directions_of(favourable.directions), "least reaction first", needed("1", "B"));
  t("base_reaction", Numbers(favourable.base_reaction), "base rate per impulse",
    needed("rad/s per N s"));
}

static void fields(Table& t, PostureIndices& x) {
  const auto plane_and_space = [&t](const char* key, auto& plane, auto& space, const char* name,
                                    const char* text) {
    t(key, Map([&plane, &space, name](Table& m) {
        m("in_xy_plane", map_of(plane, {.name = name}), "", kNeeded);
        m("in_space", map_of(space, {.name = name}), "", kNeeded);
      }),
      text, kNeeded);
  };
  plane_and_space("zero_directions", x.zero_in_plane, x.zero_in_space, "cases",
                  "impulses without effect on a momentum");
  plane_and_space("favourable_directions", x.favourable_in_plane, x.favourable_in_space,
                  "favourable", "impulses ordered by the base rate that they cause");
  t("impulse_ellipsoid", Map([&](Table& m) {
      m("axes", directions_of(x.impulse.axes), "", needed("1", "B"));
      m("lengths", Numbers(x.impulse.lengths), "", needed("kg"));
    }),
    "impulses that stop 1 m/s", kNeeded);
  t("base_reaction_ellipsoid", Map([&](Table& m) {
      m("axes", directions_of(x.reaction.ellipsoid.axes), "of the base rate", needed("1", "B"));
      m("lengths", Numbers(x.reaction.ellipsoid.lengths), "", needed("rad/s per N s"));
      m("causes", directions_of(x.reaction.causes), "impulse of each axis", needed("1", "B"));
      m("rank", Integer(x.reaction.rank, 0, 3), "lengths above the tolerance", kNeeded);
      m("rank_tolerance", Number(x.reaction.rank_tolerance, kNonNegative),
        "relative to the largest length", kNeeded);
    }),
    "base rates of impulses of 1 N s", kNeeded);
  t("generalized_jacobian", Map([&](Table& m) {
      m("singular_values", Numbers(x.jacobian.all), "m and rad mixed", kNeeded);
      m("linear", Numbers(x.jacobian.linear), "singular values of the linear rows", kNeeded);
      m("angular", Numbers(x.jacobian.angular), "of the angular rows", kNeeded);
      m("linear_manipulability", Number(x.jacobian.linear_manipulability), "", kNeeded);
      m("angular_manipulability", Number(x.jacobian.angular_manipulability), "", kNeeded);
    }),
    "", kNeeded);
  t("dynamic_coupling", Map([&](Table& m) {
      m("rotation_per_rate", Numbers(x.coupling.rotation_per_rate), "base rate per joint rate",
        kNeeded);
      m("translation_per_rate", Numbers(x.coupling.translation_per_rate),
        "base velocity per joint rate", kNeeded);
      m("rotation_per_hand", Numbers(x.coupling.rotation_per_hand), "base rate per hand velocity",
        kNeeded);
      m("hand_rank", Integer(x.coupling.hand_rank, 0, 3), "of the generalized Jacobian", kNeeded);
    }),
    "singular values", kNeeded);
}

void analysis_fields(Table& t, Analysis& analysis) {
  const RobotModel& robot = analysis.robot;
  format_fields(t, "stillbase.analysis");
  t("rows",
    List(analysis.rows,
         [&robot](AnalysisRow& row) {
           return Map([&](Table& m) {
             m("direction_deg", Number(row.direction_deg),
               "azimuth of the impulse (`impulse.force`), from x of B about z", needed("deg"));
             impact_object_fields(m, row.impact, robot);
           });
         }),
    "one impact per direction", kNeeded);
  t("joint_resistances",
    List(analysis.resistances,
         [&robot](AnalysisComparison& row) {
           return Map([&](Table& m) {
             m("illustrative", Flag(row.is_illustrative), "the resistance is an example", kNeeded);
             impact_object_fields(m, row.impact, robot);
           });
         }),
    "the stated impact with other joint resistances", kNeeded);
  t("posture", map_of(analysis.posture), "what holds for any impulse", kNeeded);
}

namespace {

/// What the contact was, beyond an instantaneous impact.
void contact_fields(Table& t, ControllerRun& run) {
  static constexpr auto kModels = names<bool>({{"latch", true}, {"compliant", false}});
  t("model", Word(run.contact.is_held, kModels), "", {.need = Need::Required, .decides = true});
  if (run.contact.is_held) {
    t("impulse", impulse_of(run.contact.latch_impulse), "on the hand", kNeeded);
    return;
  }
  EncounterResult encounter = run.contact.encounter.value_or(EncounterResult{});
  ContactHistory& contact = encounter.contact;
  double duration = contact.first_end - contact.first_begin;
  t("contacts", Integer(contact.contacts, 0, kMany), "how often they touched", kNeeded);
  t("begin", Number(contact.first_begin), "of the first contact", needed("s"));
  t("duration", Number(duration), "of the first contact", needed("s"));
  t("peak_force", Number(run.result.summary.peak_contact_force), "", needed("N"));
  t("impulse_inertial", Numbers(encounter.impulse_N), "on the hand", needed("N s", "N"));
  t("separation_speed", Number(encounter.separation_speed), "", needed("m/s"));
  t("momentum_error", Number(encounter.momentum_error), "of robot and target, relative", kNeeded);
}

void limit_fields(Table& t, const RobotModel& robot, LimitEvent& event) {
  std::string joint =
      robot.joints.empty() ? "" : robot.joints[static_cast<std::size_t>(event.joint)].name;
  t("joint", Text(joint), "", kNeeded);
  t("kind", Word(event.kind, names_up_to(LimitKind::UpperStop)), "", kNeeded);
  t("time", Number(event.time), "", needed("s"));
}

void run_fields(Table& t, const RobotModel& robot, ControllerRun& run) {
  SimulationSummary& summary = run.result.summary;
  const std::vector<TraceSample>& trace = run.result.trace;
  TraceSample first = trace.empty() ? TraceSample{} : trace.front();
  TraceSample last = trace.empty() ? TraceSample{} : trace.back();
  const auto momentum = [](TraceSample& sample) {
    return momentum_split(sample.total, sample.base, sample.coupling);
  };
  t("controller", Text(run.controller, controller_names(), "controllers"), "", kNeeded);
  t("status", Word(run.result.status, names_up_to(SimulationStatus::Diverged)), "", kNeeded);
  t("end_time", Number(last.time), "", needed("s"));
  t("momentum_start", momentum(first), "right after the impact", kNeeded);
  t("momentum_end", momentum(last), "at the end", kNeeded);
  t("peak_base_rate", Number(summary.peak_base_rate), "", needed("rad/s"));
  t("residual_base_rate", Number(summary.residual_base_rate), "at the end", needed("rad/s"));
  t("attitude_turned", Number(summary.attitude_turned), "largest attitude change", needed("rad"));
  t("peak_joint_rate", Number(summary.peak_joint_rate), "norm", needed("rad/s"));
  t("residual_joint_rate", Number(summary.residual_joint_rate), "norm at the end", needed("rad/s"));
  t("peak_torque", Number(summary.peak_torque), "of any joint", needed("N m"));
  t("peak_demanded_torque", Number(summary.peak_demanded_torque),
    "the same as the controller asks for it, before the torque limits", needed("N m"));
  t("stop_hits", Integer(summary.stop_hits, 0, kMany), "times that a joint reached its stop",
    kNeeded);
  t("wheel_momentum", Vector(summary.wheel_momentum), "at the end", needed("N m s", "B"));
  t("peak_grip_force", Number(summary.peak_grip_force), "on a held target", needed("N"));
  t("peak_grip_moment", Number(summary.peak_grip_moment), "the same about the hand's origin",
    needed("N m"));
  t("rest_time", OrNull(Number(summary.rest_time), !summary.rest_time),
    "from which on at most 1 % of the angular momentum is outside the wheels and joints have at "
    "most 1 % of their largest rate, or no more than the sensors' errors; null: not within the "
    "horizon",
    needed("s"));
  t("thruster_impulse_inertial", Vector(last.state.thruster_impulse), "angular impulse",
    needed("N m s", "N"));
  t("contact",
    OrNull(Map([&](Table& m) { contact_fields(m, run); }),
           !run.contact.is_held && !run.contact.encounter),
    "null: an instantaneous impact", kNeeded);
  t("relative_momentum_drift", Number(summary.relative_momentum_drift), "", kNeeded);
  t("peak_lost_momentum", Number(summary.peak_lost_momentum),
    "that the arm could not take over from the base", needed("N m s"));
  t("limits",
    List(summary.limits,
         [&robot](LimitEvent& event) {
           return Map([&](Table& m) { limit_fields(m, robot, event); });
         }),
    "limits of joints that were reached", kNeeded);
  AfterHorizon after = run.after_horizon.value_or(AfterHorizon{});
  t("after_horizon",
    OrNull(Map([&](Table& m) { after_horizon_fields(m, after); }), !run.after_horizon),
    "what the joints do after the horizon; null: not computed", kNeeded);
}

}  // namespace

void simulation_fields(Table& t, SimulationRuns& runs) {
  format_fields(t, "stillbase.simulation");
  t("problem", Text(runs.problem), "its name", kNeeded);
  t("runs",
    List(runs.runs,
         [&runs](ControllerRun& run) {
           return Map([&](Table& m) { run_fields(m, runs.robot, run); });
         }),
    "one per controller", kNeeded);
}

static void fields(Table& t, ModelCheckRow& row) {
  t("stiffness", Number(row.stiffness), "of the contact", needed("N/m"));
  t("ended", Flag(row.ended), "the contact was over in time", kNeeded);
  const auto of_ended = [&](const char* key, double& x, const char* text, const char* unit = "1") {
    t(key, OrNull(Number(x), !row.ended), text, needed(unit));
  };
  of_ended("duration", row.duration, "", "s");
  of_ended("peak_force", row.peak_force, "", "N");
  of_ended("impulse_error", row.impulse_error, "against the contact law");
  of_ended("velocity_error", row.velocity_error, "against the jump");
  of_ended("velocity_error_free_joints", row.free_error, "against the jump with free joints");
  of_ended("momentum_error", row.momentum_error, "of robot and target");
  of_ended("kinetic_energy_after", row.kinetic_energy_after, "of robot and target", "J");
}

void contact_table_fields(Table& t, ContactTable& table) {
  format_fields(t, "stillbase.contact_table");
  t("joint_resistance", Word(table.resistance, resistance_names()), "", kNeeded);
  t("restitution", Number(table.restitution), "", kNeeded);
  t("closing_speed", Number(table.closing_speed), "", needed("m/s"));
  t("friction", Number(table.friction), "of the spring-damper contact", kNeeded);
  t("rows", maps_of(table.rows), "by stiffness; null: the contact was not over in time", kNeeded);
}

static void fields(Table& t, ObjectiveQuantity& quantity) {
  std::string unit = unit_of(quantity);
  t("name", Word(quantity, objective_names()), "", kNeeded);
  t("unit", Text(unit), "", kNeeded);
}

void pareto_fields(Table& t, const CaptureProblem& problem, TradeOff& front) {
  std::string name = problem.name;
  bool is_complete = !front.stopped;
  std::vector<ObjectiveQuantity> quantities{front.first, front.second};
  const auto point_fields = [&](Table& m, TradeOffPoint& point) {
    for (const auto& [word, quantity] : objective_names()) {
      const bool is_first = quantity == front.first;
      m(word, Number(is_first ? point.first : point.second), "nominal value",
        {.unit = unit_of(quantity), .when = is_first || quantity == front.second});
    }
    posture_fields(m, problem.robot, point.configuration);
    m("max_violation", Number(point.max_violation, kNonNegative), "of the constraints", kNeeded);
    m("kkt_residual",
      OrNull(Number(point.kkt_residual, kNonNegative), !std::isfinite(point.kkt_residual)),
      "null: not known, a limit came before the simulations that it takes", kNeeded);
  };
  format_fields(t, "stillbase.pareto");
  t("problem", Text(name), "its name", kNeeded);
  t("complete", Flag(is_complete), "false: stopped early", kNeeded);
  t("quantities", maps_of(quantities), "the two, the first one rising", kNeeded);
  t("points",
    List(front.points,
         [&](TradeOffPoint& point) { return Map([&](Table& m) { point_fields(m, point); }); }),
    "configurations that no other one is better than in both quantities", kNeeded);
  t("solver_calls",
    Dictionary(front.solver_calls, [](long& count) { return Integer(count, 0, kMany); }), "",
    kNeeded);
}

}  // namespace stillbase::io
