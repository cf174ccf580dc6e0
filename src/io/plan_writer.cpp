#include <cmath>

#include <stillbase/core/sha256.hpp>
#include <stillbase/io/plan_file.hpp>

#include "io/json_impact.hpp"
#include "io/json_problem.hpp"
#include "io/plan_content.hpp"

namespace stillbase {

namespace io {

namespace {

/// null where there is none.
Json bound_json(double x) { return std::isinf(x) ? Json(nullptr) : x; }

template <class T, class ToJson>
Json list_json(const std::vector<T>& list, const ToJson& to_json) {
  Json json = Json::array();
  for (const T& element : list) json.push_back(to_json(element));
  return json;
}

/// Posture, base and time; the contact feature where there are several.
Json configuration_json(const CaptureProblem& problem, const Configuration& configuration) {
  Json json = {{"joint_positions", array_json(configuration.phi)},
               {"base_pose", pose_json(configuration.base)},
               {"contact_time", configuration.contact_time}};
  if (!problem.variables.features.empty()) json["feature"] = configuration.feature;
  return json;
}

Json nominal_optimum_json(const CaptureProblem& problem, const NominalOptimum& optimum) {
  Json json = configuration_json(problem, optimum.configuration);
  json["nominal"] = optimum.nominal;
  json["worst_case"] = optimum.worst_case;
  json["value"] = optimum.value;
  return json;
}

Json objective_json(const Plan& plan) {
  const ObjectiveValue& objective = plan.objective;
  Json json = {{"name", objective.name},
               {"measure", word_of(measure_names(), plan.problem.measure.kind)},
               {"value", objective.value},
               {"unit", objective.unit},
               {"terms", Json::object()},
               {"nominal", objective.nominal},
               {"worst_case", objective.worst_case},
               {"worst_direction", array_json(objective.worst_direction)},
               {"judged", objective.is_judged},
               {"nominal_optimum", nullptr}};
  for (const auto& [name, value] : objective.terms) json["terms"][name] = value;
  if (plan.nominal_optimum) {
    json["nominal_optimum"] = nominal_optimum_json(plan.problem, *plan.nominal_optimum);
  }
  return json;
}

Json constraint_json(const ConstraintValue& constraint) {
  return {{"name", constraint.name},
          {"value", constraint.value},
          {"lower", bound_json(constraint.lower)},
          {"upper", bound_json(constraint.upper)},
          {"violation", constraint.violation}};
}

Json candidate_json(const CaptureProblem& problem, const Candidate& candidate) {
  Json json = configuration_json(problem, candidate.configuration);
  json["objective"] = candidate.objective;
  json["worst_case"] = candidate.worst_case;
  json["value"] = candidate.value;
  json["judged"] = candidate.is_judged;
  json["max_violation"] = candidate.max_violation;
  json["starts_reached"] = candidate.starts_reached;
  json["family"] = candidate.family < 0 ? Json(nullptr) : Json(candidate.family);
  json["collision_free"] = candidate.collision_free;
  json["collision"] = candidate.collision;
  return json;
}

Json family_json(const CaptureProblem& problem, const SolutionFamily& family) {
  return {{"length", family.length},
          {"closed", family.is_closed},
          {"complete", family.is_complete},
          {"starts", family.starts},
          {"points", list_json(family.points, [&problem](const Configuration& point) {
             return configuration_json(problem, point);
           })}};
}

Json approach_json(const Approach& approach) {
  const auto vector = [](const auto& v) { return array_json(v); };
  return {{"status", word_of(approach_status_names(), approach.status)},
          {"detail", approach.detail},
          {"times", Json(approach.times)},
          {"joint_positions", list_json(approach.joint_positions, vector)},
          {"joint_velocities", list_json(approach.joint_velocities, vector)},
          {"joint_accelerations", list_json(approach.joint_accelerations, vector)},
          {"joint_torques", list_json(approach.joint_torques, vector)},
          {"base_poses", list_json(approach.base_poses, pose_json)},
          {"base_velocities", list_json(approach.base_velocities, vector)},
          {"duration", approach.duration},
          {"path_length", approach.path_length},
          {"attitude_excursion", approach.attitude_excursion},
          {"min_clearance", bound_json(approach.min_clearance)},
          {"effort_used", approach.effort_used},
          {"hand_error",
           {{"position", approach.hand_position_error}, {"angle", approach.hand_angle_error}}},
          {"late_by", approach.late_by},
          {"polish",
           {{"quantity", word_of(path_polish_names(), approach.polish)},
            {"before", approach.before_polish},
            {"after", approach.after_polish}}}};
}

/// null where there is none.
Json optional_json(const std::optional<double>& x) { return x ? *x : Json(nullptr); }

Json proof_json(const Proof& proof) {
  const auto box = [](const JointBox& b) {
    Json json{{"lower", array_json(b.lower)}, {"upper", array_json(b.upper)}};
    const auto add = [&json](const char* key, const std::optional<Ends>& ends) {
      if (ends) json[key] = {ends->lower, ends->upper};
    };
    add("base_angle", b.base_angle);
    add("contact_time", b.contact_time);
    return json;
  };
  return {{"status", word_of(proof_status_names(), proof.status)},
          {"statement", proof.statement},
          {"solutions", list_json(proof.solutions, box)},
          {"candidates", proof.candidates},
          {"undecided", list_json(proof.undecided, box)},
          {"found_by_search", proof.found_by_search},
          {"boxes", proof.boxes},
          {"lower_bound", optional_json(proof.lower_bound)},
          {"gap", optional_json(proof.gap)}};
}

Json certificate_json(const Certificate& certificate) {
  return {
      {"kkt_residual", bound_json(certificate.kkt_residual)},
      {"max_violation", certificate.max_violation},
      {"reduced_hessian_min_eigenvalue", optional_json(certificate.reduced_hessian_min_eigenvalue)},
      {"starts", certificate.starts},
      {"distinct_solutions", certificate.distinct_solutions},
      {"unseen", certificate.unseen},
      {"proof", proof_json(certificate.proof)}};
}

Json input_json(const InputFile& file) {
  return {{"role", file.role}, {"path", file.path}, {"sha256", file.sha256}};
}

Json plan_json(const Plan& plan, const ToolVersions& tool, const std::vector<InputFile>& inputs) {
  const CaptureProblem& problem = plan.problem;
  Json json;
  json["format"] = "stillbase.plan";
  json["version"] = 1;
  json["tool"] = tool;
  json["inputs"] = list_json(inputs, input_json);
  json["problem"] = problem_json(problem);
  json["robot"] = {
      {"urdf", problem.urdf}, {"sha256", sha256_hex(problem.urdf)}, {"hand", problem.robot.hand}};
  json["status"] = word_of(plan_status_names(), plan.status);
  json["optimizer"] = plan.optimizer;
  json["configuration"] = {{"joint_names", list_json(problem.robot.joints, [](const Joint& joint) {
                              return Json(joint.name);
                            })}};
  json["configuration"].update(configuration_json(problem, plan.configuration));
  json["impact"] = impact_json(plan.impact, problem.robot);
  json["objective"] = objective_json(plan);
  json["constraints"] = list_json(plan.constraints, constraint_json);
  json["certificate"] = certificate_json(plan.certificate);
  json["candidates"] = list_json(plan.candidates, [&problem](const Candidate& candidate) {
    return candidate_json(problem, candidate);
  });
  json["families"] = list_json(plan.families, [&problem](const SolutionFamily& family) {
    return family_json(problem, family);
  });
  json["approach"] = approach_json(plan.approach);
  json["solver_calls"] = Json::object();
  for (const auto& [name, calls] : plan.solver_calls) json["solver_calls"][name] = calls;
  return json;
}

}  // namespace

std::string content_sha256(Json document) {
  for (const char* key : {"tool", "timing", "verification", "content_sha256"}) document.erase(key);
  return sha256_hex(canonical(document));
}

}  // namespace io

std::string plan_to_json(const Plan& plan, const ToolVersions& tool,
                         const std::string& verification_json,
                         const std::vector<InputFile>& inputs) {
  io::Json json = io::plan_json(plan, tool, inputs);
  json["content_sha256"] = io::content_sha256(json);
  if (!verification_json.empty()) json["verification"] = io::Json::parse(verification_json);
  json["timing"] = io::Json::object();
  for (const auto& [name, seconds] : plan.timing) json["timing"][name] = seconds;
  return io::pretty(json);
}

}  // namespace stillbase
