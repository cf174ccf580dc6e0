#include <stillbase/plan/scenario.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/plan/feature.hpp>

namespace stillbase {

namespace {

/// The nominal direction and the normal of the wedge's plane, in the contact frame.
struct ContactAxes {
  Vector3d n;
  std::optional<Vector3d> plane_normal;
};

ContactAxes contact_axes(const CaptureProblem& problem) {
  ContactAxes out;
  const std::optional<Vector3d>& plane = problem.uncertainty.cone_plane_normal;
  const Eigen::Quaterniond& R_NB = problem.base.orientation;
  if (problem.impulse.direction) {
    out.n = *problem.impulse.direction;
    const bool in_base = problem.impulse.direction_frame == Frame::Base;
    if (plane) out.plane_normal = in_base ? *plane : Vector3d(R_NB * *plane);
    return out;
  }
  out.n = chosen_feature(problem).normal;
  if (plane) {
    const double time = problem.variables.contact_time_lower;
    const double horizon = std::abs(time - problem.target_state.time) + 1;
    const TargetState state =
        TargetMotion(*problem.target, problem.target_state, horizon).state(time);
    out.plane_normal = state.pose.orientation.conjugate() * (R_NB * *plane);
  }
  return out;
}

/// Unit vectors normal to n; the first is in the wedge's plane.
std::pair<Vector3d, Vector3d> sides_of(const ContactAxes& axes) {
  const Vector3d side = axes.plane_normal ? Vector3d(axes.plane_normal->cross(axes.n).normalized())
                                          : Vector3d(axes.n.unitOrthogonal());
  return {side, axes.n.cross(side)};
}

}  // namespace

std::vector<Scenario> rim_scenarios(const CaptureProblem& problem, int count) {
  const ContactAxes axes = contact_axes(problem);
  const auto [side, other] = sides_of(axes);
  const double half_angle = problem.uncertainty.cone_half_angle;
  Scenario scenario;
  scenario.restitution = problem.impulse.restitution;
  scenario.direction = axes.n;
  std::vector<Scenario> out = {scenario};
  const int places = axes.plane_normal ? 2 : count;
  for (int i = 0; i < places && half_angle > 0; ++i) {
    const double azimuth = 2 * kPi * i / places;
    scenario.direction =
        (std::cos(half_angle) * axes.n +
         std::sin(half_angle) * (std::cos(azimuth) * side + std::sin(azimuth) * other))
            .normalized();
    out.push_back(scenario);
  }
  return out;
}

std::vector<Scenario> draw_scenarios(const CaptureProblem& problem) {
  const UncertaintySpec& spread = problem.uncertainty;
  const ContactAxes axes = contact_axes(problem);
  const auto [side, other] = sides_of(axes);
  std::vector<Scenario> out;
  for (int k = 0; k < problem.measure.samples; ++k) {
    Random random(problem.measure.seed, static_cast<std::uint64_t>(k));
    const auto about_zero = [&random](double half_range) {
      return random.uniform(-half_range, half_range);
    };
    Scenario scenario;
    scenario.weight = 1.0 / problem.measure.samples;
    double angle = about_zero(spread.cone_half_angle);
    double azimuth = random.uniform(0, 2 * kPi);
    if (axes.plane_normal) {
      azimuth = 0;
    } else {
      const double share = std::abs(angle) / std::max(spread.cone_half_angle, 1e-300);
      angle = std::acos(1 - share * (1 - std::cos(spread.cone_half_angle)));
    }
    scenario.direction = (std::cos(angle) * axes.n +
                          std::sin(angle) * (std::cos(azimuth) * side + std::sin(azimuth) * other))
                             .normalized();
    scenario.closing_speed_offset = about_zero(spread.closing_speed);
    scenario.restitution = problem.impulse.restitution + about_zero(spread.restitution);
    scenario.target_mass_factor = 1 + about_zero(spread.target_mass);
    scenario.target_inertia_factor = 1 + about_zero(spread.target_inertia);
    const double turn = random.uniform(0, 2 * kPi), reach = random.uniform();
    scenario.contact_offset = axes.plane_normal
                                  ? Vector3d(spread.contact_point * (2 * reach - 1) * side)
                                  : Vector3d(spread.contact_point * std::sqrt(reach) *
                                             (std::cos(turn) * side + std::sin(turn) * other));
    scenario.time_offset = about_zero(spread.contact_time);
    if (spread.joint_position.size() > 0) {
      scenario.joint_offset.resize(spread.joint_position.size());
      for (Eigen::Index i = 0; i < spread.joint_position.size(); ++i) {
        scenario.joint_offset[i] = about_zero(spread.joint_position[i]);
      }
    }
    out.push_back(scenario);
  }
  return out;
}

std::string to_string(ObjectiveQuantity quantity) { return row_of(quantity).name; }
std::string unit_of(ObjectiveQuantity quantity) { return row_of(quantity).unit; }

std::string objective_name(const CaptureProblem& problem) {
  std::string name;
  for (const ObjectiveTerm& term : problem.objective) {
    name += (name.empty() ? "" : "+") + to_string(term.quantity);
  }
  return name;
}

namespace {

/// The quantity that the objective consists of, in its own unit; null: a sum of several or scaled.
const QuantityRow* only_quantity(const CaptureProblem& problem) {
  const ObjectiveTerm& first = problem.objective.front();
  const bool is_alone = problem.objective.size() == 1 && problem.user.terms.empty();
  return is_alone && first.size == 1 ? &row_of(first.quantity) : nullptr;
}

}  // namespace

std::string objective_unit_name(const CaptureProblem& problem) {
  const QuantityRow* const only = only_quantity(problem);
  return only != nullptr ? only->unit : "1";
}

Power objective_power(const CaptureProblem& problem) {
  const QuantityRow* const only = only_quantity(problem);
  return only != nullptr ? only->power : Power{};
}

bool simulates_turn(const CaptureProblem& problem) {
  return std::any_of(
      problem.objective.begin(), problem.objective.end(),
      [](const ObjectiveTerm& term) { return row_of(term.quantity).is_simulated(); });
}

}  // namespace stillbase
