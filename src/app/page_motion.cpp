#include "app/page_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

#include <stillbase/collision/scene.hpp>
#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "planner/contact_case.hpp"

namespace stillbase::app {

using io::Json;

namespace {

Json with_digits(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", x, digits).c_str(), nullptr);
}

}  // namespace

Json rounded(double x) { return with_digits(x, 6); }

Json rounded_list(const Eigen::Ref<const Eigen::VectorXd>& v) {
  Json out = Json::array();
  for (const double x : v) out.push_back(rounded(x));
  return out;
}

Json pose_json(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.orientation;
  Json out = rounded_list(pose.position);
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) out.push_back(with_digits(x, 9));
  return out;
}

namespace {

/// Where hand and target are at one instant.
struct Sight {
  double distance = 0;       ///< m, from the hand to the contact feature
  double closing_speed = 0;  ///< m/s, along the feature's normal
};

Sight sight_of(const RobotModel& robot, const Kinematics<double>& kinematics,
               const PlantState& state, const TargetState& target, const ContactFeature& feature) {
  const auto jacobian = compute_hand_jacobian(robot, kinematics);
  const Vector3d velocity =
      state.base.orientation *
      Vector3d((jacobian.R_bh * state.Omega + jacobian.J_phi * state.phidot).head<3>());
  const Vector3d r = target.pose.orientation * feature.point;
  const Vector3d normal = target.pose.orientation * feature.normal;
  const Vector3d material = target.linear_velocity + target.angular_velocity.cross(r);
  return {(target.pose.position + r - state.base * kinematics.r_bh).norm(),
          normal.dot(material - velocity)};
}

/// Columns of a motion, one element per sample.
struct MotionColumns {
  Json times = Json::array(), joints = Json::array(), rates = Json::array(),
       torques = Json::array(), base = Json::array(), base_rates = Json::array(),
       target = Json::array(), rns = Json::array(), momenta = Json::array(),
       distances = Json::array(), closing_speeds = Json::array();

  void add(double time, const PlantState& state, const JointVectord& tau,
           const JointVectord& null_space_rates, const Vector3d& momentum_sizes) {
    times.push_back(time);
    joints.push_back(rounded_list(state.phi));
    rates.push_back(rounded_list(state.phidot));
    torques.push_back(rounded_list(tau));
    base.push_back(pose_json(state.base));
    base_rates.push_back(rounded_list(state.Omega));
    rns.push_back(rounded_list(null_space_rates));
    momenta.push_back(rounded_list(momentum_sizes));
  }
  void see(const Pose& target_pose, const std::optional<Sight>& sight) {
    target.push_back(pose_json(target_pose));
    if (!sight) return;
    distances.push_back(rounded(sight->distance));
    closing_speeds.push_back(rounded(sight->closing_speed));
  }
  Json json() const {
    return {{"times", times},
            {"joints", joints},
            {"rates", rates},
            {"torques", torques},
            {"base", base},
            {"base_rates", base_rates},
            {"target", target},
            {"rns", rns},
            {"momenta", momenta},
            {"distances", distances},
            {"closing_speeds", closing_speeds}};
  }
};

const ContactFeature* feature_of(const CaptureProblem& problem) {
  return problem.target && !problem.variables.feature.empty() ? &chosen_feature(problem) : nullptr;
}

/// One instant of the approach. `sample` is the stored one, or that before a wait.
struct Instant {
  double time = 0;
  std::size_t sample = 0;
};

/// The stored samples, and every 0.1 s between two in the same posture: the target moves on while
/// the robot waits.
std::vector<Instant> instants_of(const Approach& path) {
  constexpr double kStep = 0.1;
  std::vector<Instant> out;
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    out.push_back({path.times[i], i});
    if (i + 1 == path.times.size() || path.joint_positions[i] != path.joint_positions[i + 1]) {
      continue;
    }
    const double wait = path.times[i + 1] - path.times[i];
    for (int k = 1; k * kStep < wait - kStep / 2; ++k)
      out.push_back({path.times[i] + k * kStep, i});
  }
  return out;
}

/// Frame in B of what carries a body of a pair: link, obstacle or target.
Pose carrier_of(const CaptureProblem& problem, const Kinematics<double>& kinematics,
                const Pose& base, const Pose* target, const std::string& name) {
  if (target != nullptr && name == kTargetName) return base.inverse() * *target;
  if (const LinkFrame* const link = find_link(problem.robot, name)) {
    if (link->body == kBase) return {};
    const auto k = static_cast<std::size_t>(link->body);
    return {kinematics.o[k], Eigen::Quaterniond(kinematics.R[k])};
  }
  const bool is_inertial =
      std::any_of(problem.obstacles.begin(), problem.obstacles.end(),
                  [&](const Obstacle& o) { return o.name == name && o.frame == Frame::Inertial; });
  return is_inertial ? base.inverse() : Pose{};
}

Json nearest_json(const CaptureProblem& problem, const Kinematics<double>& kinematics,
                  const Pose& base, const Pose* target, const NearestPoints& points) {
  const auto carried = [&](const std::string& name, const Vector3d& point) {
    const Pose frame = carrier_of(problem, kinematics, base, target, name);
    return rounded_list(Vector3d(frame.inverse() * point));
  };
  return Json::array(
      {carried(points.pair.first, points.on_first), carried(points.pair.second, points.on_second)});
}

}  // namespace

Json approach_json(const Plan& plan) {
  const CaptureProblem& problem = plan.problem;
  const RobotModel& robot = problem.robot;
  const Approach& path = plan.approach;
  const auto motion = encounter_motion(problem, plan.configuration);
  const ContactFeature* const feature = feature_of(problem);
  const CollisionScene scene(problem);
  const JointVectord rotors = added_plant_inertia(problem.resistance, robot.n());
  MotionColumns columns;
  Json clearances = Json::array(), pairs = Json::array(), nearest = Json::array();
  for (const auto& [time, i] : instants_of(path)) {
    PlantState state = state_at_rest(path.base_poses[i], path.joint_positions[i]);
    state.phidot = path.joint_velocities[i];
    state.Omega = path.base_velocities[i];
    const PlantTerms terms(robot, rotors, state);
    const auto momentum = compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
    const auto parts =
        decompose_joint_velocity(angular_reaction_null_space(terms.tilde), state.phidot);
    columns.add(time, state, path.joint_torques[i], parts.rns,
                {momentum.base.norm(), momentum.coupling.norm(), momentum.L_g.norm()});
    std::optional<TargetState> target;
    if (motion) target = motion->state(time);
    if (target) {
      std::optional<Sight> sight;
      if (feature != nullptr) sight = sight_of(robot, terms.kinematics, state, *target, *feature);
      columns.see(target->pose, sight);
    }
    const Pose* const target_pose = target ? &target->pose : nullptr;
    const auto closest = scene.nearest(terms.kinematics, state.base, target_pose, false);
    clearances.push_back(closest ? rounded(closest->distance) : Json());
    pairs.push_back(closest ? Json(to_string(*closest)) : Json());
    const auto points = scene.nearest_points(terms.kinematics, state.base, target_pose, false);
    nearest.push_back(
        points ? nearest_json(problem, terms.kinematics, state.base, target_pose, *points)
               : Json());
  }
  Json out = columns.json();
  out["clearances"] = clearances;
  out["pairs"] = pairs;
  out["nearest"] = nearest;
  return out;
}

namespace {

/// The target right after the impulse on the hand, whose opposite it takes.
/// @param Fbar impulse [f; t] on the hand, in B
TargetState target_after(const ContactCase& contact, const Vector6d& Fbar) {
  const TargetAtContact& target = *contact.target;
  const TargetPlantState& before = target.state;
  const Eigen::Quaterniond& R_NB = contact.before.base.orientation;
  const Vector3d J = -(R_NB * Fbar.head<3>()), turning = -(R_NB * Fbar.tail<3>());
  const Eigen::Quaterniond& R = before.pose.orientation;
  TargetState after;
  after.pose = before.pose;
  after.linear_velocity = before.velocity + J / target.body.mass;
  const Vector3d hand =
      contact.before.base * compute_kinematics<double>(contact.robot, contact.before.phi).r_bh;
  const Vector3d moment = R.conjugate() * ((hand - before.pose.position).cross(J) + turning);
  after.angular_velocity =
      R * Vector3d(before.angular_velocity + target.body.inverse_inertia() * moment);
  return after;
}

/// The samples that a page keeps of a trace: every 20 ms in the first second, every 50 ms later.
bool is_kept(double since_last, double time) { return since_last >= (time <= 1 ? 0.02 : 0.05); }

}  // namespace

Json after_json(const Plan& plan, const std::string& controller, const StopCondition& stop) {
  const CaptureProblem& problem = plan.problem;
  const AfterContact run =
      simulate_post_impact(problem, plan.configuration, plan.impact, controller, stop);
  const ContactCase contact = contact_case(problem, plan.configuration, plan.impact);
  const ContactFeature* const feature = feature_of(problem);
  const std::vector<TraceSample>& trace = run.simulation.trace;
  std::optional<TargetMotion> free_motion;
  Pose hand_target;  // T in the hand frame, when it is held
  const auto hand_pose = [&](const Kinematics<double>& kinematics) {
    return Pose{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  };
  if (contact.target) {
    free_motion.emplace(contact.target->body, target_after(contact, plan.impact.Fbar),
                        trace.back().time + 1);
    const PlantState& before = contact.before;
    hand_target =
        (before.base * hand_pose(compute_kinematics<double>(contact.robot, before.phi))).inverse() *
        contact.target->state.pose;
  }
  MotionColumns columns;
  double last = -1;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const TraceSample& sample = trace[i];
    if (i + 1 < trace.size() && !is_kept(sample.time - last + 1e-9, sample.time)) continue;
    last = sample.time;
    columns.add(sample.time, sample.state, sample.tau, sample.rns,
                {sample.base.norm(), sample.coupling.norm(), sample.total.norm()});
    if (!contact.target) continue;
    const auto kinematics = compute_kinematics<double>(problem.robot, sample.state.phi);
    if (run.is_held) {
      columns.see(sample.state.base * hand_pose(kinematics) * hand_target, std::nullopt);
      continue;
    }
    TargetState target = free_motion->state(sample.time);
    if (sample.target) {
      target.pose = sample.target->pose;
      target.linear_velocity = sample.target->velocity;
      target.angular_velocity = target.pose.orientation * sample.target->angular_velocity;
    }
    std::optional<Sight> sight;
    if (feature != nullptr) {
      sight = sight_of(problem.robot, kinematics, sample.state, target, *feature);
    }
    columns.see(target.pose, sight);
  }
  Json out{{"controller", controller},
           {"status", to_string(run.simulation.status)},
           {"held", run.is_held}};
  out.update(columns.json());
  return out;
}

}  // namespace stillbase::app
