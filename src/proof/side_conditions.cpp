#include "proof/side_conditions.hpp"

#include "dynamics/kinematics_kernel.hpp"

namespace stillbase::proof {
namespace {

Kept is_between(const Interval& x, double lower, double upper) {
  if (x.lower() >= lower && x.upper() <= upper) return Kept::Yes;
  return x.upper() < lower || x.lower() > upper ? Kept::No : Kept::Open;
}

}  // namespace

Kept keeps_side_conditions(const ZeroProblem& problem, std::span<const Dual> x) {
  const VariableEncounter& model = problem.encounter;
  const EncounterRange<Dual> at = encounter_over<Dual>(model, x);
  const Kinematics<Dual> kin = compute_kinematics<Dual>(problem.robot, at.phi);
  const auto value_of = [&](const SideCondition& condition) -> Dual {
    switch (condition.kind) {
      case SideKind::HandFacing: {
        const Vector3<Dual> n = at.R_BE() * Vector3<Dual>(model.n.cast<Dual>());
        return n.dot(kin.R_hand * Vector3<Dual>(model.approach_axis.cast<Dual>()));
      }
      case SideKind::PoseFacing: {
        const Vector3<Dual> wanted =
            wanted_hand_axes<Dual>(model, at.R_NB, at.contact.R_EB).col(condition.index);
        return wanted.dot(Vector3<Dual>(kin.R_hand.col(condition.index)));
      }
      case SideKind::ClosingSpeed:
        return at.closing_speed;
      case SideKind::BasePosition: {
        const Vector3<Dual> r_bh = at.R_NB * kin.r_bh;
        return at.contact_point[condition.index] - r_bh[condition.index];
      }
      case SideKind::TurnSize:
        return at.turn_size_squared;
      case SideKind::BaseTilt:
        return tilt_cosine<Dual>(model, at);
    }
    return Dual(0.0);
  };
  Kept all = Kept::Yes;
  for (const SideCondition& condition : problem.side_conditions) {
    const Kept one = is_between(value_of(condition).v, condition.lower, condition.upper);
    if (one == Kept::No) return Kept::No;
    if (one == Kept::Open) all = Kept::Open;
  }
  return all;
}

}  // namespace stillbase::proof
