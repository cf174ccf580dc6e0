#include "io/json_problem.hpp"

#include <stillbase/io/problem_file.hpp>

#include "io/names.hpp"

namespace stillbase::io {

namespace {

/// {"joint": value, ...}
Json joint_values_json(const RobotModel& robot, const JointVectord& values) {
  Json json = Json::object();
  for (int k = 0; k < robot.n(); ++k) json[robot.joints[k].name] = values[k];
  return json;
}

/// Names of the joints whose flag is set.
Json joint_flags_json(const RobotModel& robot, const std::vector<bool>& flags) {
  Json json = Json::array();
  for (int k = 0; k < robot.n(); ++k) {
    if (flags[k]) json.push_back(robot.joints[k].name);
  }
  return json;
}

Json geometry_json(const Geometry& geometry) {
  struct Visitor {
    Json operator()(const Sphere& s) const { return {{"sphere", {{"radius", s.radius}}}}; }
    Json operator()(const Capsule& c) const {
      return {{"capsule", {{"radius", c.radius}, {"length", c.length}}}};
    }
    Json operator()(const Cylinder& c) const {
      return {{"cylinder", {{"radius", c.radius}, {"length", c.length}}}};
    }
    Json operator()(const Box& b) const { return {{"box", {{"size", array_json(b.size)}}}}; }
    Json operator()(const ConvexMesh& m) const {
      Json vertices = Json::array();
      for (const Vector3d& v : m.vertices) vertices.push_back(array_json(v));
      return {{"convex_mesh", {{"vertices", vertices}, {"faces", m.faces}}}};
    }
  };
  return std::visit(Visitor{}, geometry);
}

Json target_body_json(const TargetBody& body) {
  Json json = {{"name", body.name},
               {"model", body.is_point_mass ? "point_mass" : "rigid_body"},
               {"mass", body.mass}};
  if (!body.is_point_mass) {
    const Matrix3d& inertia = body.inertia;
    json["inertia"] = {{"ixx", inertia(0, 0)}, {"iyy", inertia(1, 1)}, {"izz", inertia(2, 2)},
                       {"ixy", inertia(0, 1)}, {"ixz", inertia(0, 2)}, {"iyz", inertia(1, 2)}};
  }
  json["shapes"] = Json::array();
  for (const TargetShape& shape : body.shapes) {
    Json entry = pose_json(shape.pose);
    entry["geometry"] = geometry_json(shape.geometry);
    json["shapes"].push_back(std::move(entry));
  }
  json["features"] = Json::array();
  for (const ContactFeature& feature : body.features) {
    json["features"].push_back({{"name", feature.name},
                                {"point", array_json(feature.point)},
                                {"normal", array_json(feature.normal)}});
  }
  return json;
}

Json target_state_json(const TargetState& state,
                       const std::optional<EstimateDeviations>& deviations) {
  Json json = {{"time", state.time},
               {"position", array_json(state.pose.position)},
               {"orientation", quaternion_json(state.pose.orientation)},
               {"linear_velocity", array_json(state.linear_velocity)},
               {"angular_velocity", array_json(state.angular_velocity)}};
  if (deviations) {
    json["covariance"] = {{"position", array_json(deviations->position)},
                          {"orientation", array_json(deviations->orientation)},
                          {"linear_velocity", array_json(deviations->linear_velocity)},
                          {"angular_velocity", array_json(deviations->angular_velocity)},
                          {"mass", deviations->mass},
                          {"moments", array_json(deviations->moments)}};
  }
  return json;
}

Json impact_section_json(const CaptureProblem& problem) {
  const ImpulseSpec& impulse = problem.impulse;
  return {{"source", word_of(impulse_source_names(), impulse.source)},
          {"direction", impulse.direction ? array_json(*impulse.direction) : Json("feature")},
          {"frame", word_of(frame_names(), impulse.direction_frame)},
          {"magnitude", impulse.magnitude},
          {"moment", array_json(impulse.moment)},
          {"closing_speed", impulse.closing_speed},
          {"restitution", impulse.restitution},
          {"joint_resistance", resistance_json(problem.resistance, problem.robot)}};
}

Json variables_json(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  return {{"joints", joint_flags_json(problem.robot, variables.joints)},
          {"base_attitude",
           {{"freedom", word_of(attitude_freedom_names(), variables.base_attitude)},
            {"axis", array_json(variables.base_attitude_axis)},
            {"max", variables.base_attitude_max}}},
          {"base_position",
           {{"freedom", word_of(position_freedom_names(), variables.base_position)},
            {"lower", array_json(variables.base_position_lower)},
            {"upper", array_json(variables.base_position_upper)}}},
          {"contact_time",
           {{"lower", variables.contact_time_lower}, {"upper", variables.contact_time_upper}}},
          {"feature", !variables.features.empty() ? Json(variables.features)
                      : variables.feature.empty() ? Json("none")
                                                  : Json(variables.feature)}};
}

Json objective_section_json(const CaptureProblem& problem) {
  const MeasureSpec& measure = problem.measure;
  Json json = {{"measure", word_of(measure_names(), measure.kind)}};
  const bool is_tail = measure.kind == RiskMeasure::Cvar;
  if (is_tail) json["cvar_level"] = measure.cvar_level;
  if (is_tail || measure.kind == RiskMeasure::Expectation) {
    json["samples"] = measure.samples;
    json["sample_seed"] = measure.seed;
  }
  const ObjectiveTerm& first = problem.objective.front();
  const bool is_plain =
      first.size == 1 && (first.length == 1 || first.quantity != ObjectiveQuantity::BaseMomentum);
  if (problem.objective.size() == 1 && is_plain) {
    json["quantity"] = word_of(objective_names(), first.quantity);
    if (first.after > 0) json["after"] = first.after;
    return json;
  }
  json["terms"] = Json::array();
  for (const ObjectiveTerm& term : problem.objective) {
    json["terms"].push_back(
        {{"quantity", word_of(objective_names(), term.quantity)}, {"size", term.size}});
    if (term.quantity == ObjectiveQuantity::BaseMomentum) {
      json["terms"].back()["length"] = term.length;
    }
    if (term.after > 0) json["terms"].back()["after"] = term.after;
  }
  return json;
}

Json constraints_json(const CaptureProblem& problem) {
  const ConstraintSpec& constraints = problem.constraints;
  Json json = {{"case", word_of(case_constraint_names(), constraints.impact_case)},
               {"joint_limit_margin", constraints.joint_limit_margin},
               {"closing_speed_min", constraints.closing_speed_min},
               {"coupling_singular_value_min", constraints.coupling_singular_value_min},
               {"jacobian_singular_value_min", constraints.jacobian_singular_value_min},
               {"jacobian_length", constraints.jacobian_length}};
  if (constraints.joint_rate_scale) {
    json["joint_rate_scale"] = *constraints.joint_rate_scale;
  }
  if (constraints.joint_rate_max.size() > 0) {
    json["joint_rate_max"] = joint_values_json(problem.robot, constraints.joint_rate_max);
  }
  if (constraints.clearance) json["clearance"] = *constraints.clearance;
  return json;
}

Json uncertainty_json(const RobotModel& robot, const UncertaintySpec& uncertainty) {
  const auto& plane = uncertainty.cone_plane_normal;
  Json json = {{"cone_half_angle", uncertainty.cone_confidence ? Json("from_covariance")
                                                               : uncertainty.cone_half_angle},
               {"cone_plane", plane ? array_json(*plane) : Json("none")},
               {"closing_speed", uncertainty.closing_speed},
               {"restitution", uncertainty.restitution},
               {"target_mass", uncertainty.target_mass},
               {"target_inertia", uncertainty.target_inertia},
               {"contact_point", uncertainty.contact_point},
               {"contact_time", uncertainty.contact_time}};
  if (uncertainty.joint_position.size() > 0) {
    json["joint_position"] = joint_values_json(robot, uncertainty.joint_position);
  }
  if (uncertainty.cone_confidence) json["confidence"] = *uncertainty.cone_confidence;
  return json;
}

Json approach_section_json(const CaptureProblem& problem) {
  const ApproachSpec& approach = problem.approach;
  return {{"enabled", approach.enabled},
          {"base", word_of(base_mode_names(), approach.base)},
          {"station_free", approach.station_free},
          {"acceleration_limit", joint_values_json(problem.robot, approach.acceleration_limit)},
          {"velocity_scale", approach.velocity_scale},
          {"wait", approach.wait},
          {"max_duration", approach.max_duration},
          {"clearance", approach.clearance},
          {"contact_allowance", approach.contact_allowance},
          {"resolution", approach.resolution},
          {"planner", approach.planner},
          {"max_iterations", approach.max_iterations},
          {"polish", word_of(path_polish_names(), approach.polish)},
          {"attitude_tolerance", approach.attitude_tolerance}};
}

Json post_impact_json(const PostImpactSpec& post) {
  const ContactSpec& contact = post.contact;
  const SensorSpec& sensor = post.sensor;
  return {{"controllers", post.controllers},
          {"base_rate_gain", post.K_omega},
          {"joint_rate_gain", post.K_phi},
          {"control_period", post.control_period},
          {"horizon", post.horizon},
          {"joint_friction", post.joint_friction},
          {"stop_restitution", post.stop_restitution},
          {"wheel_torque", post.wheel_torque},
          {"wheel_momentum", post.wheel_momentum},
          {"handback_start", post.handback_start},
          {"handback_gain", post.handback_gain},
          {"contact",
           {{"model", word_of(contact_model_names(), contact.model)},
            {"stiffness", contact.stiffness},
            {"damping", contact.damping ? *contact.damping : Json("from_restitution")},
            {"friction", contact.friction}}},
          {"sensor",
           {{"base_rate_error", sensor.base_rate_error},
            {"joint_position_error", sensor.joint_position_error},
            {"joint_rate_error", sensor.joint_rate_error},
            {"delay", sensor.delay},
            {"seed", sensor.seed}}},
          {"model",
           {{"base_mass_scale", post.model.base_mass_scale},
            {"arm_mass_scale", post.model.arm_mass_scale},
            {"target_mass_scale", post.model.target_mass_scale},
            {"friction_scale", post.model.friction_scale}}},
          {"thrusters",
           {{"torque", post.thrusters.torque},
            {"gain", post.thrusters.gain},
            {"dead_band", post.thrusters.dead_band}}},
          {"residual_base_rate_max", post.residual_base_rate_max},
          {"attitude_change_max", post.attitude_change_max}};
}

}  // namespace

Json resistance_json(const JointResistance& resistance, const RobotModel& robot) {
  Json json = {{"model", word_of(resistance_names(), resistance.model)}};
  switch (resistance.model) {
    case ResistanceModel::Free:
      break;
    case ResistanceModel::RotorInertia:
      json["rotor_inertia"] = joint_values_json(robot, resistance.rotor_inertia);
      break;
    case ResistanceModel::Servo:
      json["stiffness"] = joint_values_json(robot, resistance.stiffness);
      json["damping"] = joint_values_json(robot, resistance.damping);
      json["contact_duration"] = resistance.contact_duration;
      break;
    case ResistanceModel::Locked:
      json["locked"] = joint_flags_json(robot, resistance.locked);
      break;
  }
  return json;
}

Json problem_json(const CaptureProblem& problem) {
  Json json;
  json["format"] = "stillbase.problem";
  json["version"] = 1;
  json["name"] = problem.name;
  json["purpose"] = problem.purpose;
  Json contacts = Json::array();
  for (const auto& [a, b] : problem.allowed_contacts) contacts.push_back({a, b});
  json["robot"] = {{"file", problem.urdf_path},
                   {"hand", problem.robot.hand},
                   {"start", joint_values_json(problem.robot, problem.start)},
                   {"base", pose_json(problem.base)},
                   {"allowed_contacts", contacts}};
  if (problem.target) {
    json["target"] = target_body_json(*problem.target);
    if (!problem.impulse.direction) {
      json["target"]["state"] = target_state_json(problem.target_state, problem.target_deviations);
    }
  }
  json["impact"] = impact_section_json(problem);
  json["variables"] = variables_json(problem);
  json["objective"] = objective_section_json(problem);
  const HandSpec& hand = problem.hand;
  json["hand"] = {
      {"constraint", word_of(hand_constraint_names(), hand.constraint)},
      {"position", hand.position ? array_json(*hand.position) : Json("feature")},
      {"orientation", hand.orientation ? quaternion_json(*hand.orientation) : Json("feature")},
      {"frame", word_of(frame_names(), hand.frame)},
      {"approach_axis", array_json(hand.approach_axis)},
      {"roll", hand.roll}};
  json["constraints"] = constraints_json(problem);
  json["uncertainty"] = uncertainty_json(problem.robot, problem.uncertainty);
  json["search"] = {{"optimizer", problem.search.optimizer},
                    {"starts", problem.search.starts},
                    {"seed", problem.search.seed},
                    {"max_candidates", problem.search.max_candidates}};
  json["approach"] = approach_section_json(problem);
  json["post_impact"] = post_impact_json(problem.post_impact);
  json["obstacles"] = Json::array();
  for (const Obstacle& obstacle : problem.obstacles) {
    json["obstacles"].push_back({{"name", obstacle.name},
                                 {"frame", word_of(frame_names(), obstacle.frame)},
                                 {"position", array_json(obstacle.pose.position)},
                                 {"orientation", quaternion_json(obstacle.pose.orientation)},
                                 {"geometry", geometry_json(obstacle.geometry)}});
  }
  return json;
}

}  // namespace stillbase::io

namespace stillbase {

std::string problem_to_json(const CaptureProblem& problem) {
  return io::pretty(io::problem_json(problem));
}

}  // namespace stillbase
