#include "app/page_scene.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>

#include "app/page_motion.hpp"
#include "io/fields/values.hpp"

namespace stillbase::app {

namespace {

using io::Json;

Json shape_json(const Pose& pose, Geometry geometry) {
  return {{"pose", pose_json(pose)}, {"geometry", io::geometry_of(geometry).write()}};
}

Json body_json(const Body& body) {
  return {
      {"name", body.name}, {"mass", rounded(body.mass)}, {"centroid", rounded_list(body.centroid)}};
}

Json target_json(const CaptureProblem& problem) {
  if (!problem.target) return nullptr;
  const TargetBody& target = *problem.target;
  Json shapes = Json::array(), features = Json::array();
  for (const TargetShape& shape : target.shapes) {
    shapes.push_back(shape_json(shape.pose, shape.geometry));
  }
  for (const ContactFeature& feature : target.features) {
    features.push_back({{"name", feature.name},
                        {"point", rounded_list(feature.point)},
                        {"normal", rounded_list(feature.normal)}});
  }
  return {{"name", target.name},
          {"mass", rounded(target.mass)},
          {"shapes", shapes},
          {"features", features},
          {"feature", problem.variables.feature}};
}

/// Robot, target, obstacles and start of a problem.
Json setting_json(const CaptureProblem& problem) {
  Json obstacles = Json::array();
  for (const Obstacle& obstacle : problem.obstacles) {
    Json json = shape_json(obstacle.pose, obstacle.geometry);
    json["name"] = obstacle.name;
    json["on_base"] = obstacle.frame == Frame::Base;
    obstacles.push_back(json);
  }
  Json out{{"robot", robot_scene(problem.robot)},
           {"target", target_json(problem)},
           {"obstacles", obstacles},
           {"start", {{"joints", rounded_list(problem.start)}, {"base", pose_json(problem.base)}}},
           {"cone_half_angle", rounded(problem.uncertainty.cone_half_angle)}};
  return out;
}

/// The target over the window of contact times, with the hand where it starts; null: no target.
Json window_json(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  double first = variables.contact_time_lower, last = variables.contact_time_upper;
  if (!(last > first)) {
    first -= 5;
    last += 5;
  }
  const Configuration start = start_configuration(problem);
  const auto motion = encounter_motion(problem, start);
  if (!motion) return nullptr;
  constexpr int kSamples = 120;
  Json times = Json::array(), poses = Json::array();
  for (int i = 0; i <= kSamples; ++i) {
    const double time = first + (last - first) * i / kSamples;
    times.push_back(time);
    poses.push_back(pose_json(motion->state(time).pose));
  }
  return {{"times", times}, {"target", poses}};
}

/// A problem looked at in one posture: the target at that posture's contact.
Json target_pose_json(const CaptureProblem& problem, const Configuration& configuration) {
  const auto state = target_at_contact(problem, configuration);
  return state ? pose_json(state->pose) : Json();
}

/// The most angular momentum that goes into the base, over the deviation of the impulse from its
/// nominal direction, in one configuration.
Json spread_json(const CaptureProblem& stated, const Configuration& at,
                 const std::vector<double>& deviations) {
  constexpr int kAzimuths = 24;
  CaptureProblem problem = at_feature(stated, at.feature);
  const EncounterModel model = encounter_model(problem);
  const auto contact =
      contact_kinematics<double>(model, at.base.orientation.toRotationMatrix(), at.contact_time);
  Json out = Json::array();
  for (const double deviation : deviations) {
    problem.uncertainty.cone_half_angle = deviation;
    double most = 0;
    for (const Scenario& scenario : rim_scenarios(problem, kAzimuths)) {
      const Encounter<double> encounter = encounter_along(model, contact, scenario);
      most = std::max(most, impact_at(problem, model, encounter, at.phi).base.norm());
    }
    out.push_back(rounded(most));
  }
  return out;
}

/// One standard deviation of the contact feature's predicted position in N: principal axes and
/// half-lengths, m. Null: the problem states no deviations of its estimate.
Json contact_ellipsoid_json(const CaptureProblem& problem, double time) {
  if (!problem.target_deviations || problem.impulse.direction) return nullptr;
  const ContactPrediction contact =
      predict_contact({*problem.target, problem.target_state},
                      covariance_of(*problem.target_deviations), chosen_feature(problem), {time})
          .front();
  const SymmetricEigen3 axes =
      symmetric_eigen3(contact.spread.block<3, 3>(kContactPoint, kContactPoint));
  Matrix3d R = axes.vectors;
  if (R.determinant() < 0) R.col(0) = -R.col(0);
  return {{"pose", pose_json({contact.estimated.point, Eigen::Quaterniond(R)})},
          {"deviations", rounded_list(axes.values.cwiseMax(0).cwiseSqrt())}};
}

/// Robust and nominal optimum side by side, to 1.5 times the half-angle of the cone.
Json spreads_json(const Plan& plan) {
  const double half_angle = plan.problem.uncertainty.cone_half_angle;
  if (!(half_angle > 0) || plan.status == PlanStatus::Infeasible) return nullptr;
  constexpr int kSteps = 24;
  std::vector<double> deviations;
  for (int i = 0; i <= kSteps; ++i) deviations.push_back(1.5 * half_angle * i / kSteps);
  Json out{{"deviations", deviations},
           {"chosen", spread_json(plan.problem, plan.configuration, deviations)}};
  if (plan.nominal_optimum) {
    out["nominal"] = spread_json(plan.problem, plan.nominal_optimum->configuration, deviations);
  }
  return out;
}

}  // namespace

Json robot_scene(const RobotModel& robot) {
  Json joints = Json::array(), tree = Json::array();
  Json bodies = Json::array(), shapes = Json::array();
  for (const Joint& joint : robot.joints) {
    joints.push_back({{"name", joint.name},
                      {"slides", joint.is_prismatic()},
                      {"lower", rounded(joint.lower)},
                      {"upper", rounded(joint.upper)},
                      {"max_velocity", rounded(joint.max_velocity)},
                      {"max_effort", rounded(joint.max_effort)}});
  }
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Joint& joint = robot.tree()[static_cast<std::size_t>(k)];
    Json moved{{"parent", joint.parent},
               {"pose", pose_json({joint.p, Eigen::Quaterniond(joint.R.matrix())})},
               {"slides", joint.is_prismatic()},
               {"joint", robot.coordinate(k)}};
    if (robot.is_coupled()) {
      const Coupling& coupling = robot.couplings[static_cast<std::size_t>(k)];
      moved["ratio"] = rounded(coupling.ratio);
      moved["offset"] = rounded(coupling.offset);
    }
    tree.push_back(moved);
  }
  for (const Body& body : robot.bodies) bodies.push_back(body_json(body));
  for (const CollisionShape& shape : robot.shapes) {
    Json json = shape_json(shape.pose, shape.geometry);
    json["body"] = shape.body;
    json["link"] = shape.link;
    shapes.push_back(json);
  }
  return {{"name", robot.name},
          {"base", body_json(robot.base)},
          {"joints", joints},
          {"tree", tree},
          {"bodies", bodies},
          {"shapes", shapes},
          {"hand",
           {{"link", robot.hand},
            {"body", robot.hand_body},
            {"pose", pose_json({robot.p_hand, Eigen::Quaterniond(robot.R_hand)})}}}};
}

Json lone_robot_scene(const RobotModel& robot) {
  JointVectord joints(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    joints[k] = std::clamp(0.0, joint.lower, joint.upper);
  }
  return {{"robot", robot_scene(robot)},
          {"target", nullptr},
          {"start", {{"joints", rounded_list(joints)}, {"base", pose_json({})}}}};
}

Json problem_scene(const CaptureProblem& problem) {
  Json out = setting_json(problem);
  out["window"] = window_json(problem);
  return out;
}

Json plan_scene(const Plan& plan, const StopCondition& stop) {
  Plan chosen = plan;
  chosen.problem = at_feature(plan.problem, plan.configuration.feature);
  Json out = setting_json(chosen.problem);
  if (plan.candidates.empty()) return out;
  const Configuration& contact = plan.configuration;
  out["contact"] = {{"time", rounded(contact.contact_time)},
                    {"joints", rounded_list(contact.phi)},
                    {"base", pose_json(contact.base)},
                    {"target", target_pose_json(chosen.problem, contact)},
                    {"impulse", rounded_list(Vector3d(plan.impact.Fbar.head<3>()))}};
  out["contact_ellipsoid"] = contact_ellipsoid_json(chosen.problem, contact.contact_time);
  Json candidates = Json::array();
  for (const Candidate& candidate : plan.candidates) {
    candidates.push_back(target_pose_json(at_feature(plan.problem, candidate.configuration.feature),
                                          candidate.configuration));
  }
  out["candidate_targets"] = candidates;
  if (!plan.approach.times.empty()) out["approach"] = approach_json(chosen);
  Json after = Json::array();
  for (const std::string& controller : plan.problem.post_impact.controllers) {
    if (plan.status == PlanStatus::Infeasible) break;
    after.push_back(after_json(chosen, controller, stop));
  }
  out["after"] = after;
  out["spreads"] = spreads_json(plan);
  return out;
}

}  // namespace stillbase::app
