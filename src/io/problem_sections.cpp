#include <algorithm>

#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/core/constants.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "io/problem_reader.hpp"
#include "io/target_reader.hpp"

namespace stillbase::io {

bool is_scalar(const Node* node) {
  return node != nullptr && (node->kind == Node::Kind::Plain || node->kind == Node::Kind::Quoted);
}

namespace {

constexpr int kManyTimes = 1'000'000'000;
constexpr double kFastest = 1e5;  ///< m/s, ten times the speed of an orbit
/// A mission's, s: farther away a tumbling target's attitude is not known to any digit.
constexpr Range kTimes{.lower = -1e9, .upper = 1e9};

bool is_word(const Node* node, std::string_view word) {
  return is_scalar(node) && node->text == word;
}

void read_resistance(MapReader& impact, CaptureProblem& problem) {
  JointResistance& resistance = problem.resistance;
  const std::string key = "joint_resistance";
  const Node* node = impact.child(key);
  if (node == nullptr) return;
  if (is_scalar(node)) {
    impact.choice(key, resistance.model, resistance_names());
    if (resistance.model != ResistanceModel::Free) {
      impact.context().add(node->line, "missing-key",
                           fmt::format("{}: '{}' needs its values: {{model: {}, ...}}",
                                       impact.path_of(key), node->text, node->text));
    }
    return;
  }
  MapReader map(impact.context(), *node, impact.path_of(key));
  map.choice("model", resistance.model, resistance_names(), Need::Required);
  read_resistance_values(map, problem.robot, resistance);
  map.finish();
}

void read_impulse_direction(MapReader& map, ImpulseSpec& impulse) {
  const Node* node = map.child("direction");
  if (node == nullptr || is_word(node, "feature")) return;
  if (node->kind == Node::Kind::Map) {
    MapReader planar(map.context(), *node, map.path_of("direction"));
    double angle = 0;
    if (planar.number("angle", angle, Dimension::Angle, kAny, Need::Required)) {
      impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    }
    planar.finish();
  } else {
    impulse.direction = read_direction(map.context(), *node, map.path_of("direction"));
  }
}

}  // namespace

MapReader section(MapReader& map, const std::string& key) {
  static const Node empty = [] {
    Node node;
    node.kind = Node::Kind::Map;
    return node;
  }();
  const Node* node = map.child(key);
  return {map.context(), node == nullptr ? empty : *node, map.path_of(key)};
}

void read_resistance_values(MapReader& map, const RobotModel& robot, JointResistance& resistance) {
  switch (resistance.model) {
    case ResistanceModel::Free:
      break;
    case ResistanceModel::RotorInertia:
      read_joint_values(map, "rotor_inertia", robot, Dimension::Inertia, Dimension::Mass,
                        kNonNegative, true, Need::Required, resistance.rotor_inertia);
      break;
    case ResistanceModel::Servo:
      read_joint_values(map, "stiffness", robot, Dimension::Stiffness, Dimension::LinearStiffness,
                        kNonNegative, true, Need::Required, resistance.stiffness);
      read_joint_values(map, "damping", robot, Dimension::Damping, Dimension::LinearDamping,
                        kNonNegative, true, Need::Required, resistance.damping);
      map.number("contact_duration", resistance.contact_duration, Dimension::Time, kPositive,
                 Need::Required);
      break;
    case ResistanceModel::Locked:
      read_joint_flags(map, "locked", robot, Need::Required, resistance.locked);
      break;
  }
}

void read_impact_section(MapReader& map, CaptureProblem& problem) {
  MapReader impact = section(map, "impact");
  ImpulseSpec& impulse = problem.impulse;
  impact.choice("source", impulse.source, impulse_source_names(), Need::Required);
  read_impulse_direction(impact, impulse);
  impact.choice("frame", impulse.direction_frame, frame_names());
  impact.number("magnitude", impulse.magnitude, Dimension::Impulse, kPositive);
  impact.vector3("moment", impulse.moment, Dimension::AngularImpulse);
  impact.number("closing_speed", impulse.closing_speed, Dimension::Velocity,
                {.lower = 0, .upper = kFastest});
  impact.number("restitution", impulse.restitution, Dimension::None, {.lower = 0, .upper = 1});
  read_resistance(impact, problem);
  impact.finish();
}

namespace {

/// A list of features that the planner chooses among.
void read_feature_choice(MapReader& section_map, const Node& list,
                         const std::vector<ContactFeature>& features, VariableSpec& variables) {
  ReadContext& context = section_map.context();
  const std::string path = section_map.path_of("feature");
  std::vector<std::string> names;
  for (const ContactFeature& known : features) names.push_back(known.name);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const Node& item = list.items[i];
    const std::string item_path = fmt::format("{}[{}]", path, i);
    const auto name = read_text(context, item, item_path);
    if (!name || !check_name(context, item.line, item_path, *name, names, "features of the target"))
      continue;
    if (std::find(variables.features.begin(), variables.features.end(), *name) !=
        variables.features.end()) {
      context.add(item.line, "duplicate-name", fmt::format("{}: '{}' again", item_path, *name));
    }
    variables.features.push_back(*name);
  }
  if (variables.features.empty()) {
    context.add(list.line, "wrong-type", fmt::format("{}: names at least one feature", path));
    return;
  }
  variables.feature = variables.features.front();
  if (variables.features.size() == 1) variables.features.clear();
}

}  // namespace

void read_variables_section(MapReader& map, CaptureProblem& problem) {
  MapReader section_map = section(map, "variables");
  ReadContext& context = map.context();
  VariableSpec& variables = problem.variables;
  variables.joints.assign(problem.robot.joints.size(), true);
  read_joint_flags(section_map, "joints", problem.robot, Need::Optional, variables.joints);

  const Node* attitude = section_map.child("base_attitude");
  if (is_scalar(attitude)) {
    section_map.choice("base_attitude", variables.base_attitude, attitude_freedom_names());
    if (variables.base_attitude == AttitudeFreedom::Axis ||
        variables.base_attitude == AttitudeFreedom::Cone) {
      context.add(attitude->line, "missing-key",
                  fmt::format("{0}: '{1}' needs its axis: {{freedom: {1}, axis: [x, y, z]}}",
                              section_map.path_of("base_attitude"), attitude->text));
    }
  } else if (attitude != nullptr) {
    MapReader fields(context, *attitude, section_map.path_of("base_attitude"));
    fields.choice("freedom", variables.base_attitude, attitude_freedom_names(), Need::Required);
    const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
    const bool needs_axis = is_cone || variables.base_attitude == AttitudeFreedom::Axis;
    fields.direction("axis", variables.base_attitude_axis,
                     needs_axis ? Need::Required : Need::Optional);
    fields.number("max", variables.base_attitude_max, Dimension::Angle,
                  {.lower = 0, .upper = kPi, .is_lower_open = true},
                  is_cone ? Need::Required : Need::Optional);
    fields.finish();
  }

  const Node* position = section_map.child("base_position");
  if (is_scalar(position)) {
    section_map.choice("base_position", variables.base_position, position_freedom_names());
    if (variables.base_position == PositionFreedom::Box) {
      context.add(position->line, "missing-key",
                  fmt::format("{}: 'box' needs its corners: {{freedom: box, lower: [x, y, z], "
                              "upper: [x, y, z]}}",
                              section_map.path_of("base_position")));
    }
  } else if (position != nullptr) {
    MapReader fields(context, *position, section_map.path_of("base_position"));
    fields.choice("freedom", variables.base_position, position_freedom_names(), Need::Required);
    const Need need =
        variables.base_position == PositionFreedom::Box ? Need::Required : Need::Optional;
    fields.vector3("lower", variables.base_position_lower, Dimension::Length, need);
    fields.vector3("upper", variables.base_position_upper, Dimension::Length, need);
    if (!(variables.base_position_lower.array() <= variables.base_position_upper.array()).all()) {
      context.add(position->line, "out-of-range",
                  fmt::format("{}: lower must not exceed upper", fields.path()));
    }
    fields.finish();
  }

  const Node* time = section_map.child("contact_time");
  if (time != nullptr && time->kind == Node::Kind::Map) {
    MapReader fields(context, *time, section_map.path_of("contact_time"));
    fields.number("lower", variables.contact_time_lower, Dimension::Time, kTimes, Need::Required);
    fields.number("upper", variables.contact_time_upper, Dimension::Time, kTimes, Need::Required);
    fields.finish();
    if (variables.contact_time_lower > variables.contact_time_upper) {
      context.add(time->line, "out-of-range",
                  fmt::format("{}: lower must not exceed upper", fields.path()));
    }
  } else if (time != nullptr) {
    section_map.number("contact_time", variables.contact_time_lower, Dimension::Time, kTimes);
    variables.contact_time_upper = variables.contact_time_lower;
  }

  const std::vector<ContactFeature> none;
  const std::vector<ContactFeature>& features = problem.target ? problem.target->features : none;
  if (features.size() == 1) variables.feature = features[0].name;
  const Node* feature =
      section_map.child("feature", features.size() > 1 ? Need::Required : Need::Optional);
  if (is_word(feature, "none")) {
    variables.feature.clear();
  } else if (feature != nullptr && feature->kind == Node::Kind::Sequence) {
    read_feature_choice(section_map, *feature, features, variables);
  } else if (feature != nullptr && section_map.text("feature", variables.feature)) {
    std::vector<std::string> names;
    for (const ContactFeature& known : features) names.push_back(known.name);
    check_name(context, feature->line, section_map.path_of("feature"), variables.feature, names,
               "features of the target");
  }
  section_map.finish();
}

void read_hand_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "hand");
  ReadContext& context = map.context();
  HandSpec& hand = problem.hand;
  fields.choice("constraint", hand.constraint, hand_constraint_names());
  const Node* position = fields.child("position");
  if (position != nullptr && !is_word(position, "feature")) {
    hand.position = read_vector3(context, *position, fields.path_of("position"), Dimension::Length);
  }
  const Node* orientation = fields.child("orientation");
  if (orientation != nullptr && !is_word(orientation, "feature")) {
    hand.orientation = read_orientation(context, *orientation, fields.path_of("orientation"));
  }
  fields.choice("frame", hand.frame, frame_names());
  fields.direction("approach_axis", hand.approach_axis);
  fields.number("roll", hand.roll, Dimension::Angle);
  fields.finish();
}

void read_uncertainty_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "uncertainty");
  const Node* half_angle = fields.child("cone_half_angle");
  double confidence = 0.95;
  const bool states_confidence =
      fields.number("confidence", confidence, Dimension::None,
                    {.lower = 0, .upper = 0.9999, .is_lower_open = true});
  if (is_word(half_angle, "from_covariance")) {
    problem.uncertainty.cone_confidence = confidence;
  } else {
    fields.number("cone_half_angle", problem.uncertainty.cone_half_angle, Dimension::Angle,
                  {.lower = 0, .upper = kPi / 2});
    if (states_confidence) {
      map.context().add(fields.line_of("confidence"), "not-used",
                        fmt::format("{}: is stated only beside cone_half_angle: from_covariance",
                                    fields.path_of("confidence")));
    }
  }
  const Node* plane = fields.child("cone_plane");
  static const Names<std::optional<Vector3d>> kPlanes{{"none", std::nullopt},
                                                      {"xy", Vector3d::UnitZ()},
                                                      {"yz", Vector3d::UnitX()},
                                                      {"xz", Vector3d::UnitY()}};
  if (is_scalar(plane)) {
    fields.choice("cone_plane", problem.uncertainty.cone_plane_normal, kPlanes);
  } else if (plane != nullptr) {
    problem.uncertainty.cone_plane_normal =
        read_unit_vector(map.context(), *plane, fields.path_of("cone_plane"));
  }
  UncertaintySpec& spread = problem.uncertainty;
  fields.number("closing_speed", spread.closing_speed, Dimension::Velocity,
                {.lower = 0, .upper = kFastest});
  fields.number("restitution", spread.restitution, Dimension::None, {.lower = 0, .upper = 1});
  fields.number("target_mass", spread.target_mass, Dimension::None, {.lower = 0, .upper = 0.99});
  fields.number("target_inertia", spread.target_inertia, Dimension::None,
                {.lower = 0, .upper = 0.99});
  fields.number("contact_point", spread.contact_point, Dimension::Length,
                {.lower = 0, .upper = 1000});
  fields.number("contact_time", spread.contact_time, Dimension::Time, {.lower = 0, .upper = 600});
  if (fields.child("joint_position") != nullptr) {
    spread.joint_position = JointVectord::Zero(problem.robot.n());
    read_joint_values(fields, "joint_position", problem.robot, Dimension::Angle, Dimension::Length,
                      {.lower = 0, .upper = 1}, true, Need::Optional, spread.joint_position);
  }
  fields.finish();
}

void read_search_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "search");
  SearchSpec& search = problem.search;
  if (fields.text("optimizer", search.optimizer)) {
    check_name(map.context(), fields.line_of("optimizer"), fields.path_of("optimizer"),
               search.optimizer, nlp::optimizer_names(), "optimizers");
  }
  fields.integer("starts", search.starts, 1, kMaxStarts);
  fields.unsigned_integer("seed", search.seed);
  fields.integer("max_candidates", search.max_candidates, 1, kManyTimes);
  fields.finish();
}

void read_approach_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "approach");
  ApproachSpec& approach = problem.approach;
  fields.flag("enabled", approach.enabled);
  fields.choice("base", approach.base, base_mode_names());
  fields.flag("station_free", approach.station_free);
  // 0.1 rad/s^2 (m/s^2): a second to reach the few degrees per second at which space arms move.
  approach.acceleration_limit = JointVectord::Constant(problem.robot.n(), 0.1);
  read_joint_values(fields, "acceleration_limit", problem.robot, Dimension::AngularAcceleration,
                    Dimension::Acceleration, kPositive, true, Need::Optional,
                    approach.acceleration_limit);
  fields.number("velocity_scale", approach.velocity_scale, Dimension::None,
                {.lower = 0, .upper = 1, .is_lower_open = true});
  fields.number("wait", approach.wait, Dimension::Time, kNonNegative);
  fields.number("max_duration", approach.max_duration, Dimension::Time, kPositive);
  fields.number("clearance", approach.clearance, Dimension::Length, kNonNegative);
  fields.number("contact_allowance", approach.contact_allowance, Dimension::Length, kNonNegative);
  fields.number("resolution", approach.resolution, Dimension::Angle, {.lower = 1e-4, .upper = 1});
  if (fields.text("planner", approach.planner)) {
    check_name(map.context(), fields.line_of("planner"), fields.path_of("planner"),
               approach.planner, approach_planner_names(), "planners");
  }
  fields.integer("max_iterations", approach.max_iterations, 1, kManyTimes);
  // Plans state the default beside every base mode.
  if (approach.base == BaseMode::ReactionNull && approach.planner != ApproachSpec{}.planner) {
    map.context().add(fields.line_of("planner"), "not-used",
                      fmt::format("{}: paths within the reaction null space are found without it",
                                  fields.path_of("planner")));
  }
  fields.choice("polish", approach.polish, path_polish_names());
  fields.number("attitude_tolerance", approach.attitude_tolerance, Dimension::Angle,
                {.lower = 1e-6, .upper = 1});
  if (approach.base == BaseMode::ReactionNull && !approach.station_free) {
    map.context().add(fields.line_of("station_free"), "not-supported",
                      "approach.station_free: false needs base: held or floating; a base whose "
                      "attitude is kept must be free to start where the arm's motion asks");
  }
  if (approach.base == BaseMode::ReactionNull && approach.polish != PathPolish::None) {
    map.context().add(fields.line_of("polish"), "not-supported",
                      "approach.polish: paths within the reaction null space are not polished");
  }
  const VariableSpec& variables = problem.variables;
  if (approach.enabled && approach.base != BaseMode::ReactionNull && !approach.station_free &&
      (variables.base_attitude != AttitudeFreedom::Fixed ||
       variables.base_position != PositionFreedom::Fixed)) {
    map.context().add(
        fields.line_of("station_free"), "contradiction",
        "approach.station_free: false: the base starts as stated, and its pose at the "
        "contact follows from the path (held: it stays); base_attitude and "
        "base_position must be fixed");
  }
  fields.finish();
}

void read_obstacles_section(MapReader& map, CaptureProblem& problem) {
  const Node* list = map.child("obstacles");
  if (list == nullptr) return;
  ReadContext& context = map.context();
  if (list->kind != Node::Kind::Sequence) {
    context.add(list->line, "wrong-type",
                fmt::format("{}: must be a list", map.path_of("obstacles")));
    return;
  }
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    const Node& node = list->items[i];
    MapReader fields(context, node, fmt::format("{}[{}]", map.path_of("obstacles"), i));
    Obstacle obstacle{{}, Frame::Inertial, {}, Sphere{0}};
    fields.text("name", obstacle.name, Need::Required);
    for (const Obstacle& other : problem.obstacles) {
      if (other.name != obstacle.name) continue;
      context.add(node.line, "duplicate-name",
                  fmt::format("{}: there is already an obstacle '{}'", fields.path(), other.name));
    }
    fields.choice("frame", obstacle.frame, frame_names());
    fields.pose(obstacle.pose);
    if (const Node* geometry = fields.child("geometry", Need::Required)) {
      if (auto value = read_geometry(context, *geometry, fields.path_of("geometry"))) {
        obstacle.geometry = std::move(*value);
      }
    }
    fields.finish();
    problem.obstacles.push_back(std::move(obstacle));
  }
}

}  // namespace stillbase::io
