#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <stillbase/core/sha256.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/plan/scenario.hpp>

#include "io/json_impact.hpp"
#include "io/plan_content.hpp"
#include "io/problem_reader.hpp"
#include "io/target_reader.hpp"

namespace stillbase {

namespace io {

namespace {

constexpr int kMany = std::numeric_limits<int>::max();

void inconsistent(ReadContext& context, int line, const std::string& message) {
  context.add(line, "inconsistent", message);
}

/// A quaternion of a plan was written by a program: it is a unit quaternion to rounding and is kept
/// bit for bit, or somebody has changed it.
Pose read_pose_object(ReadContext& context, const Node& node, const std::string& path) {
  MapReader map(context, node, path);
  Pose pose;
  map.vector3("position", pose.position, Dimension::None, Need::Required);
  if (const Node* orientation = map.child("orientation", Need::Required)) {
    MapReader fields(context, *orientation, map.path_of("orientation"));
    Eigen::Quaterniond& q = pose.orientation;
    bool is_good = fields.number("w", q.w(), Dimension::None, kAny, Need::Required);
    is_good = fields.number("x", q.x(), Dimension::None, kAny, Need::Required) && is_good;
    is_good = fields.number("y", q.y(), Dimension::None, kAny, Need::Required) && is_good;
    is_good = fields.number("z", q.z(), Dimension::None, kAny, Need::Required) && is_good;
    fields.finish();
    if (is_good && !(std::abs(q.norm() - 1) <= 1e-12)) {
      context.add(
          orientation->line, "not-unit",
          fmt::format("{}: the quaternion has norm {}; must be 1", fields.path(), q.norm()));
    }
  }
  map.finish();
  return pose;
}

/// The elements of a list that must be there.
template <class Read>
void read_list(MapReader& map, const std::string& key, const Read& read) {
  const Node* list = map.child(key, Need::Required);
  if (list == nullptr) return;
  if (list->kind != Node::Kind::Sequence) {
    map.context().add(list->line, "wrong-type",
                      fmt::format("{}: must be a list", map.path_of(key)));
    return;
  }
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    read(list->items[i], fmt::format("{}[{}]", map.path_of(key), i));
  }
}

bool is_null(const Node& node) {
  return node.kind == Node::Kind::Null || (node.kind == Node::Kind::Plain && node.text == "null");
}

/// null: no bound.
void read_bound(MapReader& map, const std::string& key, double no_bound, double& out) {
  const Node* node = map.child(key, Need::Required);
  if (node == nullptr) return;
  if (is_null(*node)) {
    out = no_bound;
  } else {
    map.number(key, out, Dimension::None);
  }
}

/// null: there is none.
void read_optional(MapReader& map, const std::string& key, std::optional<double>& out) {
  const Node* node = map.child(key, Need::Required);
  double value = 0;
  if (node == nullptr || is_null(*node)) return;
  if (map.number(key, value, Dimension::None)) out = value;
}

/// Of a file that says that it is something else, nothing more is said than that.
void refuse_other_format(MapReader& map) {
  const Node* format = map.child("format");
  if (format == nullptr || format->text.rfind("stillbase.", 0) != 0 ||
      format->text == "stillbase.plan") {
    return;
  }
  ReadContext only{map.context().source, {}, {}};
  only.add(format->line, "format",
           format->text == "stillbase.problem"
               ? "this is a problem file; make a plan of it first (stillbase plan)"
               : fmt::format("is '{}'; must be 'stillbase.plan'", format->text));
  only.throw_if_any();
}

ToolVersions read_tool(MapReader& map) {
  ToolVersions tool;
  const Node* node = map.child("tool", Need::Required);
  if (node == nullptr) return tool;
  MapReader fields(map.context(), *node, "tool");
  for (const std::string& name : node->keys) fields.text(name, tool[name]);
  return tool;
}

/// Which of several contact features is met; the only one is not stated again.
void read_feature(MapReader& fields, const Plan& plan, Configuration& configuration) {
  const VariableSpec& variables = plan.problem.variables;
  if (variables.features.empty()) return;
  if (fields.text("feature", configuration.feature, Need::Required)) {
    check_name(fields.context(), fields.line_of("feature"), fields.path_of("feature"),
               configuration.feature, variables.features, "features of the problem");
  }
}

void read_configuration(MapReader& map, Plan& plan) {
  const Node* node = map.child("configuration", Need::Required);
  if (node == nullptr) return;
  ReadContext& context = map.context();
  MapReader fields(context, *node, "configuration");
  const std::vector<std::string> names = joint_names(plan.problem.robot);
  std::vector<std::string> stated;
  read_list(fields, "joint_names", [&](const Node& item, const std::string& path) {
    stated.push_back(read_text(context, item, path).value_or(""));
  });
  if (stated != names) {
    inconsistent(context, node->line,
                 fmt::format("configuration.joint_names: the robot's are {}", list_of(names)));
  }
  read_joint_list(fields, "joint_positions", plan.problem.robot.n(), plan.configuration.phi);
  if (const Node* pose = fields.child("base_pose", Need::Required)) {
    plan.configuration.base = read_pose_object(context, *pose, "configuration.base_pose");
  }
  fields.number("contact_time", plan.configuration.contact_time, Dimension::None, kAny,
                Need::Required);
  read_feature(fields, plan, plan.configuration);
  fields.finish();
  // From here on the problem is that of the chosen feature.
  if (!plan.configuration.feature.empty()) {
    plan.problem.variables.feature = plan.configuration.feature;
  }
}

void read_joint_pose_time(MapReader& fields, const Plan& plan, Configuration& configuration) {
  read_joint_list(fields, "joint_positions", plan.problem.robot.n(), configuration.phi);
  if (const Node* pose = fields.child("base_pose", Need::Required)) {
    configuration.base = read_pose_object(fields.context(), *pose, fields.path_of("base_pose"));
  }
  fields.number("contact_time", configuration.contact_time, Dimension::None, kAny, Need::Required);
  read_feature(fields, plan, configuration);
}

void read_nominal_optimum(MapReader& objective, Plan& plan) {
  const Node* node = objective.child("nominal_optimum", Need::Required);
  if (node == nullptr || is_null(*node)) return;
  MapReader fields(objective.context(), *node, objective.path_of("nominal_optimum"));
  NominalOptimum optimum;
  read_joint_pose_time(fields, plan, optimum.configuration);
  fields.number("nominal", optimum.nominal, Dimension::None, kNonNegative, Need::Required);
  fields.number("worst_case", optimum.worst_case, Dimension::None, kNonNegative, Need::Required);
  fields.number("value", optimum.value, Dimension::None, kNonNegative, Need::Required);
  fields.finish();
  plan.nominal_optimum = optimum;
}

void read_objective(MapReader& map, Plan& plan) {
  const Node* node = map.child("objective", Need::Required);
  if (node == nullptr) return;
  ReadContext& context = map.context();
  ObjectiveValue& objective = plan.objective;
  MapReader fields(context, *node, "objective");
  RiskMeasure measure = plan.problem.measure.kind;
  const std::size_t before = context.findings.size();
  fields.text("name", objective.name, Need::Required);
  fields.choice("measure", measure, measure_names(), Need::Required);
  fields.number("value", objective.value, Dimension::None, kAny, Need::Required);
  fields.text("unit", objective.unit, Need::Required);
  if (const Node* terms = fields.child("terms", Need::Required)) {
    MapReader term_fields(context, *terms, "objective.terms");
    for (const ObjectiveTerm& term : plan.problem.objective) {
      const std::string name = to_string(term.quantity);
      term_fields.number(name, objective.terms[name], Dimension::None, kAny, Need::Required);
    }
    term_fields.finish();
  }
  fields.number("nominal", objective.nominal, Dimension::None, kAny, Need::Required);
  fields.number("worst_case", objective.worst_case, Dimension::None, kAny, Need::Required);
  fields.vector3("worst_direction", objective.worst_direction, Dimension::None, Need::Required);
  fields.flag("judged", objective.is_judged, Need::Required);
  read_nominal_optimum(fields, plan);
  fields.finish();
  if (context.findings.size() != before) return;
  if (measure != plan.problem.measure.kind) {
    inconsistent(context, node->line, "objective.measure: is not the problem's");
  }
  if (measure == RiskMeasure::Nominal && objective.value != objective.nominal) {
    inconsistent(context, node->line,
                 fmt::format("objective: value {} and nominal {} must be equal", objective.value,
                             objective.nominal));
  }
}

void read_constraints(MapReader& map, Plan& plan) {
  ReadContext& context = map.context();
  read_list(map, "constraints", [&](const Node& node, const std::string& path) {
    MapReader fields(context, node, path);
    ConstraintValue constraint;
    fields.text("name", constraint.name, Need::Required);
    fields.number("value", constraint.value, Dimension::None, kAny, Need::Required);
    read_bound(fields, "lower", -kInfinity, constraint.lower);
    read_bound(fields, "upper", kInfinity, constraint.upper);
    fields.number("violation", constraint.violation, Dimension::None, kNonNegative, Need::Required);
    fields.finish();
    plan.constraints.push_back(std::move(constraint));
  });
}

void read_proof(MapReader& map, const Plan& plan, Proof& proof) {
  const Node* node = map.child("proof", Need::Required);
  if (node == nullptr) return;
  ReadContext& context = map.context();
  MapReader fields(context, *node, "certificate.proof");
  const VariableSpec& variables = plan.problem.variables;
  const bool has_angle = variables.base_attitude == AttitudeFreedom::Axis;
  const bool has_time = variables.contact_time_upper > variables.contact_time_lower;
  const auto read_ends = [&](MapReader& box, const std::string& key, std::optional<Ends>& out) {
    const Node* ends = box.child(key, Need::Required);
    if (ends == nullptr) return;
    const auto values = read_numbers(context, *ends, box.path_of(key), Dimension::None, 2);
    if (values) out = Ends{(*values)[0], (*values)[1]};
  };
  const auto read_boxes = [&](const std::string& key, std::vector<JointBox>& out) {
    read_list(fields, key, [&](const Node& item, const std::string& path) {
      MapReader box(context, item, path);
      JointBox ends;
      read_joint_list(box, "lower", plan.problem.robot.n(), ends.lower);
      read_joint_list(box, "upper", plan.problem.robot.n(), ends.upper);
      if (has_angle) read_ends(box, "base_angle", ends.base_angle);
      if (has_time) read_ends(box, "contact_time", ends.contact_time);
      box.finish();
      out.push_back(std::move(ends));
    });
  };
  int boxes = 0;
  fields.choice("status", proof.status, proof_status_names(), Need::Required);
  fields.text("statement", proof.statement, Need::Required);
  read_boxes("solutions", proof.solutions);
  read_list(fields, "candidates", [&](const Node& item, const std::string& path) {
    const double index = read_number(context, item, path, Dimension::None).value_or(-1);
    if (index != std::floor(index) || index < -1 || index > kMany) {
      context.add(item.line, "out-of-range", path + ": must be the number of a candidate, or -1");
    } else {
      proof.candidates.push_back(static_cast<int>(index));
    }
  });
  read_boxes("undecided", proof.undecided);
  fields.integer("found_by_search", proof.found_by_search, 0, kMany, Need::Required);
  fields.integer("boxes", boxes, 0, kMany, Need::Required);
  proof.boxes = boxes;
  read_optional(fields, "lower_bound", proof.lower_bound);
  read_optional(fields, "gap", proof.gap);
  fields.finish();
  if (context.findings.empty() && proof.candidates.size() != proof.solutions.size()) {
    context.add(node->line, "wrong-length",
                "certificate.proof: solutions and candidates must have the same length");
  }
}

void read_certificate(MapReader& map, const Plan& plan, Certificate& certificate) {
  const Node* node = map.child("certificate", Need::Required);
  if (node == nullptr) return;
  MapReader fields(map.context(), *node, "certificate");
  if (const Node* residual = fields.child("kkt_residual", Need::Required)) {
    certificate.kkt_residual = kInfinity;
    if (!is_null(*residual)) {
      fields.number("kkt_residual", certificate.kkt_residual, Dimension::None, kNonNegative);
    }
  }
  fields.number("max_violation", certificate.max_violation, Dimension::None, kNonNegative,
                Need::Required);
  read_optional(fields, "reduced_hessian_min_eigenvalue",
                certificate.reduced_hessian_min_eigenvalue);
  fields.integer("starts", certificate.starts, 0, kMany, Need::Required);
  fields.integer("distinct_solutions", certificate.distinct_solutions, 0, kMany, Need::Required);
  fields.number("unseen", certificate.unseen, Dimension::None, {.lower = 0, .upper = 1},
                Need::Required);
  read_proof(fields, plan, certificate.proof);
  fields.finish();
}

void read_families(MapReader& map, Plan& plan) {
  read_list(map, "families", [&](const Node& node, const std::string& path) {
    MapReader fields(map.context(), node, path);
    SolutionFamily family;
    fields.number("length", family.length, Dimension::None, kNonNegative, Need::Required);
    fields.flag("closed", family.is_closed, Need::Required);
    fields.flag("complete", family.is_complete, Need::Required);
    fields.integer("starts", family.starts, 0, kMany, Need::Required);
    read_list(fields, "points", [&](const Node& point_node, const std::string& point_path) {
      MapReader point_fields(map.context(), point_node, point_path);
      Configuration point;
      read_joint_pose_time(point_fields, plan, point);
      point_fields.finish();
      family.points.push_back(std::move(point));
    });
    fields.finish();
    plan.families.push_back(std::move(family));
  });
}

void read_candidates(MapReader& map, Plan& plan) {
  ReadContext& context = map.context();
  const int last_family = static_cast<int>(plan.families.size()) - 1;
  read_list(map, "candidates", [&](const Node& node, const std::string& path) {
    MapReader fields(context, node, path);
    Candidate candidate;
    read_joint_pose_time(fields, plan, candidate.configuration);
    fields.number("objective", candidate.objective, Dimension::None, kAny, Need::Required);
    fields.number("worst_case", candidate.worst_case, Dimension::None, kAny, Need::Required);
    fields.number("value", candidate.value, Dimension::None, kAny, Need::Required);
    fields.flag("judged", candidate.is_judged, Need::Required);
    fields.number("max_violation", candidate.max_violation, Dimension::None, kNonNegative,
                  Need::Required);
    fields.integer("starts_reached", candidate.starts_reached, 0, kMany, Need::Required);
    const Node* family = fields.child("family", Need::Required);
    if (family != nullptr && !is_null(*family)) {
      fields.integer("family", candidate.family, 0, last_family);
    }
    fields.flag("collision_free", candidate.collision_free, Need::Required);
    fields.text("collision", candidate.collision, Need::Required);
    fields.finish();
    plan.candidates.push_back(std::move(candidate));
  });
}

void read_approach_results(MapReader& fields, Approach& approach) {
  ReadContext& context = fields.context();
  fields.number("duration", approach.duration, Dimension::None, kAny, Need::Required);
  fields.number("path_length", approach.path_length, Dimension::None, kAny, Need::Required);
  fields.number("attitude_excursion", approach.attitude_excursion, Dimension::None, kAny,
                Need::Required);
  read_bound(fields, "min_clearance", kInfinity, approach.min_clearance);
  fields.number("effort_used", approach.effort_used, Dimension::None, kNonNegative, Need::Required);
  if (const Node* node = fields.child("hand_error", Need::Required)) {
    MapReader error(context, *node, "approach.hand_error");
    error.number("position", approach.hand_position_error, Dimension::None, kNonNegative,
                 Need::Required);
    error.number("angle", approach.hand_angle_error, Dimension::None, kNonNegative, Need::Required);
    error.finish();
  }
  fields.number("late_by", approach.late_by, Dimension::None, kNonNegative, Need::Required);
  if (const Node* node = fields.child("polish", Need::Required)) {
    MapReader polish(context, *node, "approach.polish");
    polish.choice("quantity", approach.polish, path_polish_names(), Need::Required);
    polish.number("before", approach.before_polish, Dimension::None, kNonNegative, Need::Required);
    polish.number("after", approach.after_polish, Dimension::None, kNonNegative, Need::Required);
    polish.finish();
  }
}

void read_approach(MapReader& map, Plan& plan) {
  const Node* node = map.child("approach", Need::Required);
  if (node == nullptr) return;
  ReadContext& context = map.context();
  MapReader fields(context, *node, "approach");
  Approach& approach = plan.approach;
  const int n = plan.problem.robot.n();
  fields.choice("status", approach.status, approach_status_names(), Need::Required);
  fields.text("detail", approach.detail, Need::Required);
  read_list(fields, "times", [&](const Node& item, const std::string& path) {
    approach.times.push_back(read_number(context, item, path, Dimension::None).value_or(0));
  });
  const auto vectors = [&](const std::string& key, int size, auto& out) {
    read_list(fields, key, [&](const Node& item, const std::string& path) {
      using Vector = typename std::decay_t<decltype(out)>::value_type;
      const auto values = read_numbers(context, item, path, Dimension::None, size);
      if (values) out.push_back(Vector(Eigen::Map<const Eigen::VectorXd>(values->data(), size)));
    });
  };
  vectors("joint_positions", n, approach.joint_positions);
  vectors("joint_velocities", n, approach.joint_velocities);
  vectors("joint_accelerations", n, approach.joint_accelerations);
  vectors("joint_torques", n, approach.joint_torques);
  read_list(fields, "base_poses", [&](const Node& item, const std::string& path) {
    approach.base_poses.push_back(read_pose_object(context, item, path));
  });
  vectors("base_velocities", 6, approach.base_velocities);
  read_approach_results(fields, approach);
  fields.finish();
  const std::size_t samples = approach.times.size();
  if (approach.joint_positions.size() != samples || approach.joint_velocities.size() != samples ||
      approach.joint_accelerations.size() != samples || approach.joint_torques.size() != samples ||
      approach.base_poses.size() != samples || approach.base_velocities.size() != samples) {
    context.add(
        node->line, "wrong-length",
        "approach: times, joint_positions, joint_velocities, joint_accelerations, "
        "joint_torques, base_poses and base_velocities must have the same number of samples");
  }
}

void read_inputs(MapReader& map, PlanFile& file) {
  read_list(map, "inputs", [&](const Node& item, const std::string& path) {
    MapReader fields(map.context(), item, path);
    InputFile input;
    fields.text("role", input.role, Need::Required);
    fields.text("path", input.path, Need::Required);
    fields.text("sha256", input.sha256, Need::Required);
    fields.finish();
    check_name(map.context(), item.line, path + ".role", input.role, {"problem", "robot", "target"},
               "roles");
    file.inputs.push_back(std::move(input));
  });
}

void read_robot(MapReader& map, std::optional<std::string>& urdf, std::string& hand,
                PlanFile& file) {
  const Node* node = map.child("robot", Need::Required);
  if (node == nullptr) return;
  MapReader fields(map.context(), *node, "robot");
  std::string text;
  if (fields.text("urdf", text, Need::Required)) urdf = text;
  fields.text("sha256", file.stated_robot_sha256, Need::Required);
  fields.text("hand", hand, Need::Required);
  fields.finish();
  file.computed_robot_sha256 = sha256_hex(text);
}

void read_counts(MapReader& map, Plan& plan) {
  ReadContext& context = map.context();
  if (const Node* calls = map.child("solver_calls", Need::Required)) {
    MapReader fields(context, *calls, "solver_calls");
    for (const std::string& name : calls->keys) {
      int count = 0;
      fields.integer(name, count, 0, kMany);
      plan.solver_calls[name] = count;
    }
  }
  if (const Node* timing = map.child("timing")) {
    MapReader fields(context, *timing, "timing");
    for (const std::string& name : timing->keys) {
      fields.number(name, plan.timing[name], Dimension::None);
    }
  }
}

/// The text as JSON, for its fingerprint. YAML that is not JSON is refused.
std::string fingerprint(std::string_view text, ReadContext& context) {
  try {
    return content_sha256(Json::parse(text));
  } catch (const JsonError& error) {
    const std::size_t end = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(end), '\n');
    context.add(static_cast<int>(line), "syntax", "the file is not JSON");
    throw InputError(context.findings);
  }
}

}  // namespace

PlanFile read_plan_document(std::string_view text, ReadContext& context) {
  PlanFile file;
  Plan& plan = file.plan;
  const Node root =
      parse_document(text, context, {.bytes = 64u << 20, .depth = 32, .nodes = 1'000'000});
  MapReader map(context, root, "");
  read_format(map, "stillbase.plan");
  refuse_other_format(map);
  file.tool = read_tool(map);
  read_inputs(map, file);
  std::optional<std::string> urdf;
  std::string hand;
  read_robot(map, urdf, hand, file);
  const Node* problem = map.child("problem", Need::Required);
  if (problem != nullptr && urdf) {
    plan.problem = read_problem_map(*problem, context, "problem", {.urdf = urdf});
    if (context.findings.empty() && plan.problem.robot.hand != hand) {
      inconsistent(context, map.line_of("robot"),
                   fmt::format("robot.hand: is '{}', but problem.robot.hand is '{}'", hand,
                               plan.problem.robot.hand));
    }
  }
  // What follows is about the robot's joints.
  context.throw_if_any();
  map.choice("status", plan.status, plan_status_names(), Need::Required);
  map.text("optimizer", plan.optimizer, Need::Required);
  read_configuration(map, plan);
  if (const Node* impact = map.child("impact", Need::Required)) {
    plan.impact = read_impact_object(context, *impact, "impact", plan.problem.robot);
  }
  read_objective(map, plan);
  read_constraints(map, plan);
  read_certificate(map, plan, plan.certificate);
  read_families(map, plan);
  read_candidates(map, plan);
  read_approach(map, plan);
  read_counts(map, plan);
  map.text("content_sha256", file.stated_sha256, Need::Required);
  map.child("verification");
  map.finish();
  context.throw_if_any();
  file.computed_sha256 = fingerprint(text, context);
  return file;
}

}  // namespace io

PlanFile read_plan(std::string_view text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  return io::read_plan_document(text, context);
}

}  // namespace stillbase
