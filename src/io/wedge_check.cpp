#include <cmath>

#include <fmt/format.h>

#include <stillbase/plan/feature.hpp>

#include "io/wedge_check.hpp"

namespace stillbase::io {

namespace {

constexpr double kParallel = 1e-9;

bool is_parallel(const Vector3d& a, const Vector3d& unit) {
  return a.cross(unit).norm() <= kParallel * (1 + a.norm());
}

/// What leaves the plane with this normal (in B); empty: nothing.
std::string out_of_plane(const CaptureProblem& problem, const Vector3d& normal) {
  // The axis of a joint stays parallel to the normal whatever the joints before it do.
  std::vector<Matrix3d> axes;
  for (const Joint& joint : problem.robot.joints) {
    const Matrix3d R = joint.parent == kBase
                           ? joint.R
                           : Matrix3d(axes[static_cast<std::size_t>(joint.parent)] * joint.R);
    axes.push_back(R);
    const Vector3d z = R.col(2);
    const bool stays =
        joint.is_prismatic() ? std::abs(z.dot(normal)) <= kParallel : is_parallel(z, normal);
    if (!stays) return fmt::format("joint {} moves the arm out of it", joint.name);
  }
  const Vector3d normal_N = problem.base.orientation * normal;
  const VariableSpec& variables = problem.variables;
  if (variables.base_attitude == AttitudeFreedom::Axis) {
    if (!is_parallel(variables.base_attitude_axis, normal_N)) {
      return "the base may turn out of it";
    }
  } else if (variables.base_attitude != AttitudeFreedom::Fixed) {
    return "the base may turn out of it";
  }
  if (problem.impulse.direction) {
    const bool in_N = problem.impulse.direction_frame == Frame::Inertial;
    if (!(std::abs(problem.impulse.direction->dot(in_N ? normal_N : normal)) <= kParallel)) {
      return "the impulse points out of it";
    }
    return "";
  }
  const TargetState& state = problem.target_state;
  const Vector3d n = state.pose.orientation * chosen_feature(problem).normal;
  if (!(std::abs(n.dot(normal_N)) <= kParallel)) return "the contact feature looks out of it";
  if (!is_parallel(state.angular_velocity, normal_N)) return "the target turns out of it";
  const Matrix3d& I = problem.target->inertia;
  const Vector3d in_T = state.pose.orientation.conjugate() * normal_N;
  if (!problem.target->is_point_mass && !is_parallel(I * in_T / I.trace(), in_T)) {
    return "the target does not keep turning in it: it is no plane of symmetry of its inertia";
  }
  return "";
}

/// Which error of the estimate tilts the contact's normal out of the plane; empty: none.
std::string tilts(const CaptureProblem& problem, const Vector3d& normal_N) {
  const EstimateDeviations& deviations = *problem.target_deviations;
  const Vector3d in_T = problem.target_state.pose.orientation.conjugate() * normal_N;
  for (int i = 0; i < 3; ++i) {
    if (deviations.orientation[i] > 0 && !is_parallel(Vector3d::Unit(i), in_T)) {
      return "orientation";
    }
    if (deviations.angular_velocity[i] > 0 && !is_parallel(Vector3d::Unit(i), normal_N)) {
      return "angular_velocity";
    }
  }
  return "";
}

}  // namespace

void check_wedge(MapReader& map, const CaptureProblem& problem) {
  const UncertaintySpec& uncertainty = problem.uncertainty;
  if (!uncertainty.cone_plane_normal) return;
  const auto refuse = [&](const std::string& message) {
    map.context().add(map.line_of("uncertainty"), "not-planar",
                      fmt::format("{}.cone_plane: {}", map.path_of("uncertainty"), message));
  };
  const Vector3d& normal = *uncertainty.cone_plane_normal;
  const std::string what = out_of_plane(problem, normal);
  if (!what.empty()) {
    return refuse(
        "the worst direction of a problem that is not planar need not lie in the wedge (" + what +
        "); leave it out");
  }
  if (!uncertainty.cone_confidence) return;
  const std::string error = tilts(problem, problem.base.orientation * normal);
  if (!error.empty()) {
    refuse(
        fmt::format("target.state.covariance.{} tilts the normal out of this plane; state the "
                    "deviations in the plane, or leave cone_plane out",
                    error));
  }
}

}  // namespace stillbase::io
