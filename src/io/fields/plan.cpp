// Plan files.
#include "io/fields/results.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/sha256.hpp>
#include <stillbase/plan/scenario.hpp>

#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

void inconsistent(Table& t, const std::string& message) {
  if (t.reader() == nullptr) return;
  t.reader()->context().add(t.reader()->line(), "inconsistent", message);
}

/// The normalised copy of the problem, about the robot of the plan.
struct ProblemCopy : Value {
  ProblemCopy(CaptureProblem& problem, const std::optional<std::string>& urdf)
      : Value(Map([&problem](Table& t) { problem_fields(t, problem, {}); }, {.name = "problem"})) {
    read = [&problem, urdf](ReadContext& context, const Node& node, const std::string& path) {
      if (!urdf) return false;
      problem = read_problem_map(node, context, path, {.urdf = urdf});
      return context.findings.empty();
    };
  }
};

/// An object that is written as it is, and not read.
struct Verdict : Value {
  explicit Verdict(const std::string& text)
      : Value(Map(
            [](Table& t) {
              Verification none;
              std::string sha256;
              Trials trials;
              verification_fields(t, none, sha256, &trials);
            },
            {.name = "verification"})) {
    read = [](ReadContext&, const Node&, const std::string&) { return true; };
    write = [text] { return Json::parse(text); };
    is_written = !text.empty();
  }
};

}  // namespace

Map written_pose(Pose& pose) {
  return Map(
      [&pose](Table& t) {
        Eigen::Quaterniond& q = pose.orientation;
        t("position", Vector(pose.position), "origin of B", needed("m", "N"));
        t("orientation",
          Map(
              [&q](Table& m) {
                m("w", Number(q.w()), "real part", kNeeded);
                m("x", Number(q.x()), "", kNeeded);
                m("y", Number(q.y()), "", kNeeded);
                m("z", Number(q.z()), "", kNeeded);
              },
              {.name = "quaternion"}),
          "unit quaternion of the axes of B", kNeeded);
        if (t.reader() == nullptr || t.reader()->was_refused("orientation") ||
            std::abs(q.norm() - 1) <= 1e-12) {
          return;
        }
        t.reader()->refuse("orientation", "not-unit",
                           fmt::format("the quaternion has norm {}; must be 1", q.norm()));
      },
      {.name = "pose"});
}

void posture_fields(Table& t, const RobotModel& robot, Configuration& configuration) {
  t("joint_positions", Numbers(configuration.phi, robot.n()), "in joint order", kPerJoint);
  t("base_pose", written_pose(configuration.base), "pose of B", needed("m", "N"));
  t("contact_time", Number(configuration.contact_time), "on the clock of the problem", needed("s"));
}

namespace {

/// Posture, base and time; the contact feature where there are several.
void configuration_fields(Table& t, const CaptureProblem& problem, Configuration& configuration) {
  posture_fields(t, problem.robot, configuration);
  const std::vector<std::string>& features = problem.variables.features;
  t("feature",
    Text(configuration.feature, features, features.empty() ? "" : "features of the problem"),
    "contact feature, where the problem names several", {.when = !features.empty()});
}

void chosen_fields(Table& t, Plan& plan) {
  const std::vector<std::string> names = joint_names(plan.problem.robot);
  std::vector<std::string> stated = names;
  t("joint_names", Texts(stated), "one per joint, in joint order", kNeeded);
  if (stated != names) {
    inconsistent(t, "configuration.joint_names: the robot's are " + list_of(names));
  }
  configuration_fields(t, plan.problem, plan.configuration);
  // From here on the problem is that of the chosen feature.
  if (!plan.configuration.feature.empty()) {
    plan.problem.variables.feature = plan.configuration.feature;
  }
}

void residual_summary_fields(Table& t, ResidualSummary& residual) {
  const std::string velocity = "m/s, rad/s";
  t("velocity", Numbers(residual.velocity, 6), "nominal, linear and angular, target minus hand",
    needed(velocity, "B"));
  t("covariance", Covariance(residual.covariance), "of its error",
    needed("m^2/s^2, m rad/s^2, rad^2/s^2", "B"));
  t("deviations", Number(residual.deviations, {.lower = 0, .is_lower_open = true}),
    "size of the ellipsoid in standard deviations", kNeeded);
  t("worst_velocity", Numbers(residual.worst_velocity, 6),
    "where in the ellipsoid the worst case is", needed(velocity, "B"));
  t("separating", Number(residual.separating, {.lower = 0, .upper = 1}),
    "probability that target and hand separate, so that there is no contact; the measures count "
    "such velocities as if the contact held, and are upper bounds; 0 of a latch that moves along, "
    "which has hold of the target",
    kNeeded);
}

void objective_value_fields(Table& t, Plan& plan) {
  ObjectiveValue& objective = plan.objective;
  RiskMeasure measure = plan.problem.measure.kind;
  t("name", Text(objective.name), "quantity, or the terms joined by `+`", kNeeded);
  t("measure", Word(measure, kMeasureNames),
    "what was minimised over the uncertainty: `nominal`, `worst_case`, `expectation` or `cvar`",
    kNeeded);
  t("value", Number(objective.value), "of the measure", needed("`unit`"));
  t("unit", Text(objective.unit), "of value, nominal and worst_case; 1 for several terms", kNeeded);
  t("terms", Map([&](Table& m) {
      for (const auto& [word, quantity] : objective_names()) {
        const bool is_term =
            std::any_of(plan.problem.objective.begin(), plan.problem.objective.end(),
                        [q = quantity](const ObjectiveTerm& term) { return term.quantity == q; });
        double value = 0;
        const auto known = objective.terms.find(std::string(word));
        if (known != objective.terms.end()) value = known->second;
        m(std::string(word), Number(value), "nominal value",
          {.unit = unit_of(quantity), .when = is_term});
        if (m.reader() != nullptr && is_term) objective.terms[std::string(word)] = value;
      }
    }),
    "nominal value of each quantity", kNeeded);
  t("user_terms", WrittenIf(Texts(objective.user_terms), !objective.user_terms.empty()),
    "names of the terms that a user's program added to the objective; they are not recomputed",
    {.without = "none"});
  t("nominal", Number(objective.nominal), "for the nominal direction", needed("`unit`"));
  t("worst_case", Number(objective.worst_case),
    "over the cone of directions, or the ellipsoid of the residual velocity; the nominal value "
    "without both",
    needed("`unit`"));
  t("worst_direction", Vector(objective.worst_direction),
    "of the impulse, norm 1; without a cone the normal", needed("1", "B"));
  ResidualSummary residual = objective.residual.value_or(ResidualSummary{});
  t("residual",
    Map([&](Table& m) { residual_summary_fields(m, residual); },
        {.is_written = objective.residual.has_value()}),
    "relative velocity of target and hand at the contact, where the problem states a "
    "`residual_velocity`",
    {.without = "none"});
  if (t.reader() != nullptr && t.reader()->has("residual")) objective.residual = residual;
  t("judged", Flag(objective.is_judged),
    "false: a limit came before worst case and measure were computed", kNeeded);
  NominalOptimum optimum = plan.nominal_optimum.value_or(NominalOptimum{});
  bool is_null = !plan.nominal_optimum;
  t("nominal_optimum",
    OrNull(Map([&](Table& m) {
             configuration_fields(m, plan.problem, optimum.configuration);
             m("nominal", Number(optimum.nominal, kNonNegative), "for the nominal direction",
               needed("`unit`"));
             m("worst_case", Number(optimum.worst_case, kNonNegative), "as `objective.worst_case`",
               needed("`unit`"));
             m("value", Number(optimum.value, kNonNegative), "of the measure", needed("`unit`"));
             is_null = false;
           }),
           is_null),
    "the best configuration for the nominal direction alone; null: a limit came before it was "
    "known",
    kNeeded);
  MapReader* map = t.reader();
  if (map == nullptr) return;
  if (!is_null) plan.nominal_optimum = optimum;
  if (!map->context().findings.empty()) return;
  if (measure != plan.problem.measure.kind) {
    inconsistent(t, "objective.measure: is not the problem's");
  }
  if (measure == RiskMeasure::Nominal && objective.value != objective.nominal) {
    inconsistent(t, fmt::format("objective: value {} and nominal {} must be equal", objective.value,
                                objective.nominal));
  }
}

}  // namespace

static void fields(Table& t, PlanWarning& warning) {
  t("code", Text(warning.code),
    "`narrow-cone`: the covariance of the estimate gives a wider cone than the stated one; "
    "`narrow-residual`: it gives a larger covariance of the relative velocity than the stated one; "
    "`unused-covariance`: a sticking contact or a latch without `residual_velocity` does not use "
    "it; `fixed-normal`: over `residual_velocity` a contact along the normal keeps the nominal "
    "one, which it leaves open; `wide-estimate`: it leaves open where a hand that moves or latches "
    "finds the contact; `not-in-measure`: beside `residual_velocity` the mean does not count it",
    kNeeded);
  t("message", Text(warning.message), "the key, and the numbers", kNeeded);
}

static void fields(Table& t, ConstraintValue& constraint) {
  t("name", Text(constraint.name), "of the constraint", kNeeded);
  t("value", Number(constraint.value), "in the configuration", kOwnUnit);
  t("lower",
    OrNull(Number(constraint.lower), std::isinf(constraint.lower),
           [&] { constraint.lower = -kInfinity; }),
    "bound of the value; null: none", kOwnUnit);
  t("upper",
    OrNull(Number(constraint.upper), std::isinf(constraint.upper),
           [&] { constraint.upper = kInfinity; }),
    "bound of the value; null: none", kOwnUnit);
  t("violation", Number(constraint.violation, kNonNegative), "max(lower - value, value - upper, 0)",
    kOwnUnit);
}

static void fields(Table& t, BindingLimit& limit) {
  static constexpr auto kEnds = names<bool>({{"lower", false}, {"upper", true}});
  t("name", Text(limit.name),
    "of a joint, `contact_time`, `base_attitude` (the angle of the problem, whatever function of "
    "it a constraint bounds) or a constraint",
    kNeeded);
  t("end", Word(limit.is_upper, kEnds), "of its range, `lower` or `upper`", kNeeded);
  t("limit", Number(limit.value), "that is reached", needed("`unit`"));
  t("margin", Number(limit.margin), "distance from it", needed("`unit`"));
  t("multiplier", Number(limit.multiplier, kNonNegative),
    "by which the measure falls per unit that the limit is moved outwards, to first order",
    needed("`objective.unit` per `unit`"));
  t("unit", Text(limit.unit), "of limit and margin", kNeeded);
}

static void fields(Table& t, JointTurns& turns) {
  constexpr int kMost = 1'000'000;
  t("joint", Text(turns.joint), "its name", kNeeded);
  t("least", Integer(turns.least, -kMost, 0), "down to the lower limit", needed("2 pi rad"));
  t("most", Integer(turns.most, 0, kMost), "up to the upper limit", needed("2 pi rad"));
}

namespace {

void candidate_fields(Table& t, const CaptureProblem& problem, int families, Candidate& candidate) {
  configuration_fields(t, problem, candidate.configuration);
  t("objective", Number(candidate.objective), "nominal value", needed("`objective.unit`"));
  t("worst_case", Number(candidate.worst_case), "as `objective.worst_case`",
    needed("`objective.unit`"));
  t("value", Number(candidate.value), "of the measure", needed("`objective.unit`"));
  t("judged", Flag(candidate.is_judged), "as `objective.judged`", kNeeded);
  t("max_violation", Number(candidate.max_violation, kNonNegative),
    "largest violation of a constraint", kOwnUnit);
  t("starts_reached", Integer(candidate.starts_reached, 0, kMany), "starts that ended here",
    kNeeded);
  t("family", OrNull(Integer(candidate.family, 0, families - 1), candidate.family < 0),
    "index of its curve in `families`; null: none was followed", kNeeded);
  t("collision_free", Flag(candidate.collision_free),
    "arm, base, obstacles and target at the contact", kNeeded);
  t("collision", Text(candidate.collision), "\"a with b\" where it is not", kNeeded);
  t("excluded", WrittenIf(Text(candidate.excluded), !candidate.excluded.empty()),
    "why it was not chosen, of a candidate that ranks before the chosen one", {.without = "none"});
  t("turns", WrittenIf(maps_of(candidate.turns), !candidate.turns.empty()),
    "joints of which whole turns may be added, each by itself: the posture and the impact stay the "
    "same",
    {.without = "none"});
}

void choice_fields(Table& t, Choice& choice) {
  t("better", Integer(choice.better, 0, kMany), "candidates that rank before it", kNeeded);
  t("loss_percent", OrNull(Number(choice.loss_percent), !choice.loss_percent),
    "by which its measure exceeds the least one; null: that is zero", needed("%"));
}

void family_fields(Table& t, const CaptureProblem& problem, SolutionFamily& family) {
  t("length", Number(family.length, kNonNegative), "of the curve", needed("rad, m and s mixed"));
  t("closed", Flag(family.is_closed), "ends where it begins", kNeeded);
  t("complete", Flag(family.is_complete), "closed, or followed to limits at both ends", kNeeded);
  t("starts", Integer(family.starts, 0, kMany), "starts that ended on it", kNeeded);
  t("points",
    List(family.points,
         [&problem](Configuration& point) {
           return Map([&](Table& m) { configuration_fields(m, problem, point); });
         }),
    "along the curve, at most 0.1 apart; a closed one ends with its first point; of a free joint "
    "the ends of its range, of a continuous one also the middle",
    kNeeded);
}

}  // namespace

static void fields(Table& t, Finding& remark) {
  t("file", Text(remark.file), "as the problem names it", kNeeded);
  t("line", Integer(remark.line, 0, kManyTimes), "of the first of its kind; 0: of none", kNeeded);
  t("rule", Text(remark.rule), "short name of the kind", kNeeded);
  t("message", Text(remark.message), "in words, with the number of times", kNeeded);
}

static void fields(Table& t, InputFile& input) {
  t("role", Text(input.role, {"problem", "robot", "target"}, "roles"),
    "`problem`, `robot` or `target`", kNeeded);
  t("path", Text(input.path),
    "of the problem as on the command line, of the others as in the problem", kNeeded);
  t("sha256", Text(input.sha256), "of the whole file", kNeeded);
}

namespace {

/// The robot's text, wherever in the file it stands.
std::optional<std::string> urdf_of(const MapReader* map) {
  const Node* robot = map == nullptr ? nullptr : map->find("robot");
  const Node* urdf = robot == nullptr ? nullptr : robot->find("urdf");
  if (urdf == nullptr) return std::nullopt;
  return urdf->text;
}

void robot_copy_fields(Table& t, PlanFile& file, std::string& hand) {
  std::string& urdf = file.plan.problem.urdf;
  file.computed_robot_sha256 = sha256_hex(urdf);
  if (t.reader() == nullptr) file.stated_robot_sha256 = file.computed_robot_sha256;
  std::string text = urdf;
  t("urdf", Text(text), "text of the robot file", kNeeded);
  t("sha256", Text(file.stated_robot_sha256), "of that text", kNeeded);
  t("hand", Text(hand), "hand link", kNeeded);
  std::vector<Finding>& remarks = file.plan.problem.robot.remarks;
  t("remarks", WrittenIf(maps_of(remarks), !remarks.empty()),
    "what of the robot file was left out or assumed, once per kind");
}

}  // namespace

void plan_fields(Table& t, PlanFile& file, const std::string& verification) {
  Plan& plan = file.plan;
  CaptureProblem& problem = plan.problem;
  format_fields(t, "stillbase.plan");
  t("tool", Dictionary(file.tool, [](std::string& version) { return Text(version); }),
    "versions of stillbase, Eigen and the compiler", kNeeded);
  t("inputs", maps_of(file.inputs), "files that the plan was made from", kNeeded);
  t("problem", ProblemCopy(problem, urdf_of(t.reader())),
    "normalised copy of the problem: every field stated, in SI", kNeeded);
  std::string hand = problem.robot.hand;
  t("robot", Map([&](Table& m) { robot_copy_fields(m, file, hand); }), "the robot as it was read",
    kNeeded);
  MapReader* const map = t.reader();
  if (map != nullptr) {
    if (map->context().findings.empty() && hand != problem.robot.hand) {
      map->refuse(
          "robot", "inconsistent",
          fmt::format("hand is '{}', but problem.robot.hand is '{}'", hand, problem.robot.hand));
    }
    map->context().throw_if_any();  // what follows is about the robot's joints
  }
  t("status", Word(plan.status, plan_status_names()),
    "`optimal` (the best candidate), `feasible`, `infeasible` or `limit` (stopped early)", kNeeded);
  t("optimizer", Text(plan.optimizer), "local solver of the search", kNeeded);
  t("configuration", Map([&](Table& m) { chosen_fields(m, plan); }),
    "where the robot is at the contact", kNeeded);
  t("impact", Map([&](Table& m) { impact_object_fields(m, plan.impact, problem.robot); }),
    "the nominal impact in this configuration", kNeeded);
  t("objective", Map([&](Table& m) { objective_value_fields(m, plan); }),
    "what was minimised, and its values in the configuration", kNeeded);
  t("constraints", maps_of(plan.constraints), "every scalar constraint of the problem", kNeeded);
  t("certificate", Map([&](Table& m) { certificate_fields(m, problem, plan.certificate); }),
    "computed without the solver that found the configuration", kNeeded);
  int families = kMany;
  if (map != nullptr && map->find("families") != nullptr) {
    families = static_cast<int>(map->find("families")->items.size());
  }
  t("candidates",
    List(plan.candidates,
         [&](Candidate& candidate) {
           return Map([&](Table& m) { candidate_fields(m, problem, families, candidate); });
         }),
    "the best distinct solutions in the order of the search; the end of a path that decides the "
    "configuration keeps the place of its candidate",
    kNeeded);
  Choice choice = plan.choice;
  t("choice",
    Map([&](Table& m) { choice_fields(m, choice); },
        {.is_written = !plan.candidates.empty() && choice.better >= 0}),
    "where the configuration stands among the candidates",
    {.without = "no candidates, or an older file"});
  if (map != nullptr) {
    if (!map->has("choice")) choice.better = -1;
    plan.choice = choice;
  }
  t("binding", WrittenIf(maps_of(plan.binding), !plan.binding.empty()),
    "limits that are reached and decide the value, the largest saving first", {.without = "none"});
  t("families",
    List(plan.families,
         [&](SolutionFamily& family) {
           return Map([&](Table& m) { family_fields(m, problem, family); });
         }),
    "continua of solutions: curves on which the nominal objective vanishes, and those along which "
    "one joint is free: nothing depends on its angle",
    kNeeded);
  t("approach", Map([&](Table& m) { approach_result_fields(m, problem, plan.approach); }),
    "path and time law from the start posture; cubic Hermite segments between the samples",
    kNeeded);
  AfterHorizon after = plan.after_horizon.value_or(AfterHorizon{});
  t("after_horizon",
    Map([&](Table& m) { after_horizon_fields(m, after); },
        {.is_written = plan.after_horizon.has_value()}),
    "what the joints do after the horizon of the simulation under the first controller",
    {.without = "no controller, or a limit came first"});
  if (map != nullptr && map->has("after_horizon")) plan.after_horizon = after;
  ManagedMomentum managed = plan.managed_momentum.value_or(ManagedMomentum{});
  t("managed_momentum",
    Map([&](Table& m) { managed_momentum_fields(m, managed); },
        {.is_written = plan.managed_momentum.has_value()}),
    "the momentum that has to go somewhere after the contact, and which limit is tightest",
    {.without = "no target"});
  if (map != nullptr && map->has("managed_momentum")) plan.managed_momentum = managed;
  t("warnings", WrittenIf(maps_of(plan.warnings), !plan.warnings.empty()),
    "what the plan leaves out of what its own problem says", {.without = "none"});
  t("solver_calls", Dictionary(plan.solver_calls, [](long& n) { return Integer(n, 0, kMany); }),
    "calls per optimizer or planner", kNeeded);
  t("content_sha256", Text(file.stated_sha256),
    "of everything but `tool`, `timing`, `verification` and itself: SHA-256 of the JSON without "
    "blanks, keys sorted",
    kNeeded);
  t("verification", Verdict(verification), "result of `verify`, where it was entered");
  t("timing", Dictionary(plan.timing, [](double& x) { return Number(x); }), "per phase",
    {.unit = "s"});
}

}  // namespace stillbase::io
