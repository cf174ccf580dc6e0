// Variables, side conditions and impulses of a lower bound.
#include "proof/minimum_problem.hpp"

#include <algorithm>

#include <Eigen/LU>

#include <stillbase/encounter/target_motion.hpp>

namespace stillbase::proof {
namespace {

/// Whether wrench or hand point change with the base attitude.
bool depends_on_attitude(const ZeroProblem& where) {
  const EncounterModel& encounter = where.encounter;
  const bool is_point_in_base = encounter.hand_point && encounter.hand_frame == Frame::Base;
  return encounter.frame != DirectionFrame::Base || (where.has_hand_point && !is_point_in_base);
}

/// Whether of a free attitude only the direction of the impulse in B counts, which is known but for
/// a turn about it: it is the same for all impulses that turn with it.
bool counts_by_direction(const CaptureProblem& problem, const ZeroProblem& where) {
  const EncounterModel& encounter = where.encounter;
  const auto is_position = [](const SideCondition& side) {
    return side.kind == SideKind::BasePosition;
  };
  if (problem.variables.base_attitude != AttitudeFreedom::Free || encounter.time_is_free ||
      !encounter.moment.isZero(0) || where.has_hand_point || where.has_hand_axis ||
      where.has_hand_axes ||
      std::any_of(where.side_conditions.begin(), where.side_conditions.end(), is_position)) {
    return false;
  }
  if (problem.measure.kind == RiskMeasure::Nominal) return true;
  // A cone is the same all around, and so has to be what an impulse along it is.
  return problem.measure.kind == RiskMeasure::WorstCase && !problem.uncertainty.cone_plane_normal &&
         encounter.frame == DirectionFrame::Inertial &&
         problem.impulse.source != ImpulseSource::RigidBody;
}

class Impulses {
 public:
  Impulses(const CaptureProblem& problem, const EncounterModel& encounter)
      : problem_(problem), encounter_(encounter) {
    if (encounter.frame == DirectionFrame::Target && !encounter.time_is_free) {
      motion_ = encounter_motion(problem, Vector3d::Zero(), problem.base.orientation, 0);
    }
    const bool is_rigid = problem.impulse.source == ImpulseSource::RigidBody;
    if (is_rigid && !problem.target->is_point_mass) {
      inverse_inertia_ = problem.target->inertia.inverse();
    }
  }

  ImpulseCase of(const Scenario& scenario) const {
    const ImpulseSpec& impulse = problem_.impulse;
    const Vector3d& d = scenario.direction;
    const Vector3d r = encounter_.feature_point + scenario.contact_offset;
    ImpulseCase out;
    out.weight = scenario.weight;
    out.F << d, encounter_.moment + scenario.contact_offset.cross(d);
    double speed = impulse.closing_speed;
    if (motion_) {
      // The target is ahead of its prediction: it has turned.
      const TargetState state = motion_->state(encounter_.time_lower + scenario.time_offset);
      const Matrix3d R_NT = state.pose.orientation.toRotationMatrix();
      if (scenario.time_offset != 0) {
        const Matrix3d turn = encounter_.R_NT.transpose() * R_NT;
        out.F << turn * out.F.head<3>(), turn * out.F.tail<3>();
      }
      const Vector3d velocity_N =
          state.linear_velocity + state.angular_velocity.cross(Vector3d(R_NT * r));
      speed = velocity_N.dot(R_NT * d);
    }
    speed += scenario.closing_speed_offset;
    if (impulse.source == ImpulseSource::Given) {
      out.numerator = impulse.magnitude;
      return out;
    }
    out.numerator = 1 + scenario.restitution;
    if (encounter_.spin) {
      out.closing = ImpulseCase::Closing{r, scenario.closing_speed_offset};
    } else {
      out.numerator *= std::max(speed, 0.0);
    }
    const Vector3d lever = r.cross(d);
    out.target_inverse_mass = 1 / (problem_.target->mass * scenario.target_mass_factor) +
                              lever.dot(inverse_inertia_ * lever) / scenario.target_inertia_factor;
    return out;
  }

 private:
  const CaptureProblem& problem_;
  const EncounterModel& encounter_;
  std::optional<TargetMotion> motion_;  ///< of the predicted target at a fixed time
  Matrix3d inverse_inertia_ = Matrix3d::Zero();
};

}  // namespace

MinimumProblem minimum_problem(const CaptureProblem& problem,
                               const std::vector<Scenario>& scenarios) {
  MinimumProblem out;
  // The wrench is stated per impulse, in E.
  out.where = zero_problem(problem, Vector6d::Zero());
  EncounterModel& encounter = out.where.encounter;
  if (encounter.num_attitudes() > 0 && !depends_on_attitude(out.where)) {
    encounter.attitude_is_free = false;
    encounter.turn_basis.clear();
    out.where.side_conditions.clear();
  }
  if (!encounter.spin) encounter.time_is_free = false;
  if (!encounter.turn_basis.empty() && counts_by_direction(problem, out.where)) {
    // Turns about axes across it bring it into every direction.
    encounter.turn_basis = {encounter.u, encounter.v};
    for (Vector3d& axis : encounter.turn_basis) {
      if (encounter.frame == DirectionFrame::Target) axis = encounter.R_NT * axis;
    }
  }
  for (SideCondition& side : out.where.side_conditions) {
    side.lower -= kFeasible;
    side.upper += kFeasible;
  }
  out.objective = problem.objective;
  out.measure = problem.measure.kind;
  out.cvar_level = problem.measure.cvar_level;
  const Impulses impulses(problem, encounter);
  for (const Scenario& scenario : scenarios) out.impulses.push_back(impulses.of(scenario));
  return out;
}

}  // namespace stillbase::proof
