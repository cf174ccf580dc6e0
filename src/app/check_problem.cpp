// stillbase check on a target, a problem or a plan.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/collision/scene.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/residual_velocity.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/robot/unlocked_robot.hpp>

#include "app/check_report.hpp"
#include "app/command_line.hpp"
#include "app/window_words.hpp"
#include "app/words.hpp"
#include "collision/locked_links.hpp"
#include "collision/mounted_arms.hpp"

namespace stillbase::app {

namespace {

/// Effective mass of the target along the normal of a contact feature, kg.
double effective_mass(const TargetBody& target, const ContactFeature& feature) {
  return 1 /
         target_inverse_mass(target.mass, target.inverse_inertia(), feature.point, feature.normal);
}

std::vector<std::string> target_suspicions(const TargetBody& target) {
  std::vector<std::string> remarks;
  if (target.shapes.empty()) {
    remarks.push_back(target.name + ": no shapes: nothing is checked for collisions with it");
  }
  if (target.features.empty()) {
    remarks.push_back(target.name +
                      ": no contact features: only an impact along a stated direction is possible");
  }
  for (const ContactFeature& feature : target.features) {
    if (feature.point.dot(feature.normal) <= 0) {
      remarks.push_back(
          fmt::format("{}: the normal points towards the centroid, not outwards", feature.name));
    }
    if (target.is_point_mass) continue;
    if (feature.point.cross(feature.normal).norm() < 1e-6 * feature.point.norm()) {
      remarks.push_back(fmt::format(
          "{}: the normal passes through the centroid: an impulse there does not rotate the target",
          feature.name));
    }
  }
  return remarks;
}

/// Direction of the impulse on the hand in the stated attitude of the base, at the (earliest)
/// contact time.
std::string impulse_words(const CaptureProblem& problem) {
  const EncounterModel model = encounter_model(problem);
  const Configuration at = start_configuration(problem);
  const double time = at.contact_time;
  const Vector3d direction = encounter_at(model, at).F.head<3>();
  // The impulse of another law has no direction before the posture is known.
  const ContactLaw law = problem.impulse.contact;
  const char* const what = law == ContactLaw::Latch      ? "latch: contact direction"
                           : law == ContactLaw::Sticking ? "contact without slip: contact direction"
                                                         : "impulse: along";
  std::string text = fmt::format("{} {} in the base frame", what, vector_words(direction));
  if (!model.follows_target()) return text + ", as stated\n";
  text += fmt::format(", {} in N", vector_words(problem.base.orientation * direction));
  const bool is_window = problem.variables.contact_time_upper > time;
  text += fmt::format(" at {}{:.6g} s", is_window ? "the earliest contact, " : "", time);
  if (problem.variables.base_attitude != AttitudeFreedom::Fixed) {
    text += ", in the stated attitude of the base";
  }
  return text + fmt::format(": against the normal of {}\n", problem.variables.feature);
}

/// How well the contact is known, and the cone that the search uses.
std::string uncertainty_words(const CaptureProblem& problem) {
  const UncertaintySpec& uncertainty = problem.uncertainty;
  std::string text;
  if (problem.impulse.contact == ContactLaw::Frictionless) {
    text += fmt::format("direction within {:.4g} deg of the nominal one",
                        uncertainty.cone_half_angle * kDegrees);
    if (uncertainty.cone_plane_normal) text += " in a plane";
    if (uncertainty.cone_confidence) {
      text +=
          fmt::format(": from the covariance, with probability {:g}", *uncertainty.cone_confidence);
    }
    text += '\n';
  }
  const bool is_predicted = problem.target && problem.target_deviations &&
                            !problem.impulse.direction && !problem.variables.feature.empty();
  if (!is_predicted) return text;
  const double confidence = uncertainty.cone_confidence.value_or(kDefaultConeConfidence);
  DirectionCone cone;
  try {
    cone = direction_cone(problem, confidence);
  } catch (const std::invalid_argument& error) {
    return text + fmt::format("no prediction of the contact: {}\n", error.what());
  }
  const ContactPrediction& contact = cone.widest;
  text += fmt::format(
      "predicted contact at {:.6g} s: the normal within {:.4g} deg with probability {:g}; "
      "standard deviations: point {} m, closing speed {:.4g} of {:.4g} m/s to a hand that does not "
      "move, "
      "effective mass {:.3g} % of {:.4g} kg\n",
      contact.time, cone.half_angle * kDegrees, confidence, vector_words(contact.point_deviation()),
      contact.closing_speed_deviation(), contact.value[kClosingSpeed],
      100 * std::sqrt(contact.spread(kEffectiveMass, kEffectiveMass)), contact.effective_mass);
  return text;
}

/// The measure over the residual velocity.
std::string residual_words(const CaptureProblem& problem) {
  const ResidualVelocity& residual = *problem.uncertainty.residual_velocity;
  const std::string source = residual.covariance
                                 ? "as stated"
                                 : "from the covariance of the target's estimate and the hand's "
                                   "tracking";
  const double time = problem.variables.contact_time_lower;
  const Vector6d deviations = ResidualRoot(problem).covariance(time).diagonal().cwiseSqrt();
  std::string text = fmt::format(
      "relative velocity at the contact: standard deviations {} m/s and {} deg/s in the axes of "
      "the "
      "target at {:.6g} s, {}\n",
      vector_words(deviations.head<3>()), vector_words(deviations.tail<3>() * kDegrees), time,
      source);
  if (problem.measure.kind == RiskMeasure::WorstCase) {
    text += fmt::format("measure: worst case over {:g} standard deviations of it\n",
                        residual.deviations);
  } else if (problem.measure.kind == RiskMeasure::Expectation) {
    text += "measure: root mean square over it\n";
  }
  return text;
}

/// In words; empty for problems that are only analysed and simulated.
std::vector<std::string> free_variables(const CaptureProblem& problem) {
  std::vector<std::string> free;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (problem.variables.joints[i]) free.push_back(problem.robot.joints[i].name);
  }
  const VariableSpec& spec = problem.variables;
  if (spec.base_attitude == AttitudeFreedom::Axis) free.push_back("base attitude about one axis");
  if (spec.base_attitude == AttitudeFreedom::Cone) {
    free.push_back(fmt::format("base attitude with its axis within {:.4g} deg",
                               spec.base_attitude_max * kDegrees));
  }
  if (spec.base_attitude == AttitudeFreedom::Free) free.push_back("base attitude");
  if (spec.contact_time_lower < spec.contact_time_upper) {
    free.push_back(fmt::format("contact time from {:.6g} to {:.6g} s", spec.contact_time_lower,
                               spec.contact_time_upper));
  }
  if (!spec.features.empty()) {
    free.push_back(fmt::format("one of {} contact features", spec.features.size()));
  }
  return free;
}

/// @param path of the problem file
/// @throws InputError for bodies that stand in each other at the start
void check_placement(const CaptureProblem& problem, const UnlockedRobot& unlocked,
                     const std::string& path) {
  const auto refuse = [&](const char* key, const char* rule, const std::string& what) {
    throw InputError({{path, line_of_key(path, key), rule, fmt::format("{}: {}", key, what)}});
  };
  if (const auto hit = overlap_of_arms(problem)) {
    refuse("robot.arms", "mounts-overlap",
           to_string(*hit) +
               " overlap at the start; move a `mount`, lock joints or start in "
               "another position, or state the pair in robot.allowed_contacts");
  }
  if (const auto hit = overlap_of_locked_links(problem, unlocked)) {
    refuse("robot.locked", "locked-overlap",
           to_string(*hit) +
               " overlap where the joints are locked; lock them in another position, "
               "or state the pair in robot.allowed_contacts");
  }
  if (const auto hit = sunk_link(problem)) {
    refuse(
        "robot.arms", "mount-inside",
        to_string(*hit) +
            ": the middle of the link is inside the satellite; move the `mount` or the shapes of "
            "robot.base, or state the pair in robot.allowed_contacts");
  }
  const ApproachSpec& approach = problem.approach;
  if (!approach.enabled) return;
  // Obstacles in N are left out where the base does not start as stated.
  CaptureProblem alone = problem;
  if (approach.station_free) {
    std::erase_if(alone.obstacles, [](const Obstacle& o) { return o.frame == Frame::Inertial; });
  }
  const auto kinematics = compute_kinematics<double>(problem.robot, problem.start);
  if (const auto hit = CollisionScene(alone).first_hit(kinematics, problem.base, nullptr,
                                                       least_distance(approach))) {
    refuse("robot.start", "start-too-close",
           fmt::format("{} are {:.4g} m apart, approach.clearance asks for {:.4g} m; state another "
                       "posture, a smaller clearance, or the pair in robot.allowed_contacts",
                       to_string(*hit), std::max(hit->distance, 0.0), approach.clearance));
  }
}

std::vector<std::string> lines_of(const std::vector<Finding>& remarks) {
  std::vector<std::string> lines;
  for (const Finding& remark : remarks) lines.push_back(to_string(remark));
  return lines;
}

}  // namespace

std::string target_report(const TargetBody& target) {
  std::string text = fmt::format("target {}: {:.6g} kg", target.name, target.mass);
  if (target.is_point_mass) {
    text += ", a point mass\n";
  } else {
    const Vector3d moments = principal_moments(target.inertia);
    text += fmt::format(", principal moments {} kg m^2\n", vector_words(moments));
  }
  text += fmt::format("collision shapes: {}\nfeatures:\n", target.shapes.size());
  for (const ContactFeature& feature : target.features) {
    text += fmt::format("  {}: at {} m, normal {}, effective mass {:.4g} kg along it\n",
                        feature.name, vector_words(feature.point), vector_words(feature.normal),
                        effective_mass(target, feature));
  }
  return text + remark_lines(target_suspicions(target));
}

std::string problem_report(const CaptureProblem& problem, const std::vector<Finding>& remarks) {
  std::string text = fmt::format("problem {}: {}\n", problem.name, problem.purpose);
  text += fmt::format("start: {}\nbase: {}\n", posture_words(problem.robot, problem.start),
                      pose_words(problem.base));
  if (problem.target) {
    text += fmt::format("target {}: {:.6g} kg{}\n", problem.target->name, problem.target->mass,
                        problem.target->is_point_mass ? ", a point mass" : "");
    text += remark_lines(target_suspicions(*problem.target));
  }
  text += impulse_words(problem) + window_words(problem);
  text += fmt::format("joints during the impact: {}\n", to_string(problem.resistance.model));
  text += fmt::format("objective: {}\n", objective_name(problem));
  for (const ObjectiveTerm& term : problem.objective) {
    if (!row_of(term.quantity).needs_time) continue;
    text += fmt::format("attitude change of the base: {:.6g} s after the impact under {}\n",
                        term.after, problem.post_impact.controllers.front());
  }
  if (problem.uncertainty.residual_velocity) {
    text += residual_words(problem);
  } else if (problem.measure.kind == RiskMeasure::WorstCase) {
    text += fmt::format("measure: worst case over the cone of {:.6g} deg\n",
                        problem.uncertainty.cone_half_angle * kDegrees);
  } else if (problem.measure.kind != RiskMeasure::Nominal) {
    const bool tail = problem.measure.kind == RiskMeasure::Cvar;
    text += fmt::format(
        "measure: root mean square over {}{} samples\n",
        tail ? fmt::format("the worst {:.4g} % of ", 100 * (1 - problem.measure.cvar_level)) : "",
        problem.measure.samples);
  }
  text += uncertainty_words(problem);
  if (!problem.post_impact.controllers.empty()) {
    text += fmt::format("after the impact: {}\n", limit_words(problem.post_impact));
  }
  const std::vector<std::string> free = free_variables(problem);
  if (free.empty()) {
    text += "free: nothing, so there is nothing to plan\n";
  } else {
    const Formulation formulation(problem);
    text += fmt::format("free: {}\n", fmt::join(free, ", "));
    text += fmt::format(
        "{}, {}: {} degrees of freedom left\n",
        count_words(formulation.num_variables(), "variable", "variables"),
        count_words(formulation.num_equations(), "independent equation", "independent equations"),
        formulation.freedom());
  }
  return text + robot_report(problem.robot) + remark_lines(lines_of(remarks));
}

CaptureProblem read_placed_problem(const std::string& path, std::vector<Finding>& remarks) {
  try {
    UnlockedRobot unlocked;
    CaptureProblem problem = read_problem(path, &remarks, &unlocked);
    check_placement(problem, unlocked, path);
    return problem;
  } catch (const InputError&) {
    std::string text = remark_lines(lines_of(remarks));
    if (!text.empty()) text.pop_back();  // say() ends the line
    if (!text.empty()) say(text);
    throw;
  }
}

std::string plan_report(const PlanFile& file) {
  const Plan& plan = file.plan;
  std::string text =
      fmt::format("plan for {}: {}, {}, approach {}\n", plan.problem.name, to_string(plan.status),
                  count_words(static_cast<long>(plan.candidates.size()), "candidate", "candidates"),
                  to_string(plan.approach.status));
  text += "fingerprints of the content and of the robot: as stated\n";
  for (const InputFile& input : file.inputs) {
    text += fmt::format("made from the {} {} (SHA-256 {})\n", input.role, input.path,
                        input.sha256.substr(0, 16));
  }
  return text + problem_report(plan.problem);
}

}  // namespace stillbase::app
