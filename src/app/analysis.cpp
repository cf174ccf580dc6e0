#include "app/analysis.hpp"

#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>

#include "app/exit_code.hpp"
#include "app/interruption.hpp"

namespace stillbase::app {

namespace {

double angle_deg(const Vector3d& direction) {
  const double angle = std::atan2(direction.y(), direction.x()) * 180 / kPi;
  return angle < 0 ? angle + 360 : angle;
}

std::vector<AnalysisRow> sweep(CaptureProblem problem, int directions) {
  if (directions == 0) {
    const ImpactSummary impact = impact_at(problem, start_configuration(problem));
    return {{angle_deg(impact.Fbar.head<3>()), impact}};
  }
  if (!problem.impulse.direction) {
    throw CommandLineError(
        "--sweep-direction: the direction of this problem's impulse follows from the target's "
        "motion; a sweep needs a problem that states impact.direction and closing_speed");
  }
  std::vector<AnalysisRow> rows;
  problem.impulse.direction_frame = Frame::Base;
  for (int i = 0; i < directions && signal_exit_code() == 0; ++i) {
    const double degrees = 360.0 * i / directions;
    const double angle = degrees * kPi / 180;
    problem.impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    rows.push_back({degrees, impact_at(problem, start_configuration(problem))});
  }
  return rows;
}

std::vector<AnalysisComparison> compare(CaptureProblem problem) {
  std::vector<AnalysisComparison> out;
  for (const ComparedResistance& entry :
       resistances_to_compare(problem.robot, problem.start, problem.resistance)) {
    problem.resistance = entry.resistance;
    out.push_back({entry.is_illustrative, impact_at(problem, start_configuration(problem))});
  }
  return out;
}

PostureIndices posture_indices(const CaptureProblem& problem) {
  const auto posture = evaluate_posture<double>(
      problem.robot, prepare_resistance(problem.resistance, problem.robot.n()), problem.start);
  const Matrix6d W_h = extended_inverse_inertia(posture.factor, posture.jacobian);
  PostureIndices out;
  out.impulse = impulse_ellipsoid(W_h, Matrix3d::Zero());
  out.reaction = base_reaction_ellipsoid(posture);
  out.favourable_in_plane = favourable_directions(posture, directions_in_xy_plane());
  out.favourable_in_space = favourable_directions(posture, all_directions());
  out.zero_in_plane = case_directions(posture, directions_in_xy_plane());
  out.zero_in_space = case_directions(posture, all_directions());
  out.jacobian = generalized_jacobian_indices(posture);
  out.coupling = dynamic_coupling(posture);
  return out;
}

}  // namespace

Analysis analyse(const CaptureProblem& problem, int directions) {
  return {problem.name, problem.robot, sweep(problem, directions), compare(problem),
          posture_indices(problem)};
}

}  // namespace stillbase::app
