// The inequalities of a case problem over a box.
#pragma once

#include <span>

#include "dynamics/kinematics_kernel.hpp"
#include "proof/zero_problem.hpp"

namespace stillbase::proof {

enum class Kept { Yes, No, Open };

inline Kept is_between(const Interval& x, double lower, double upper) {
  if (x.lower() >= lower && x.upper() <= upper) return Kept::Yes;
  return x.upper() < lower || x.lower() > upper ? Kept::No : Kept::Open;
}

/// Whether the side conditions hold at every point of a box (Yes), at none (No).
/// @param x values of the variables over the box
inline Kept keeps_side_conditions(const ZeroProblem& problem, std::span<const Number> x) {
  const VariableEncounter& model = problem.encounter;
  const EncounterRange<Number> at = encounter_over<Number>(model, x);
  const Kinematics<Number> kin = compute_kinematics<Number>(problem.robot, at.phi);
  const auto value_of = [&](const SideCondition& condition) -> Number {
    switch (condition.kind) {
      case SideKind::HandFacing: {
        const Vector3<Number> n = at.R_BE() * Vector3<Number>(model.n.cast<Number>());
        return n.dot(kin.R_hand * Vector3<Number>(model.approach_axis.cast<Number>()));
      }
      case SideKind::PoseFacing: {
        const Vector3<Number> wanted =
            wanted_hand_axes<Number>(model, at.R_NB, at.contact.R_EB).col(condition.index);
        return wanted.dot(Vector3<Number>(kin.R_hand.col(condition.index)));
      }
      case SideKind::ClosingSpeed:
        return at.closing_speed;
      case SideKind::BasePosition: {
        const Vector3<Number> r_bh = at.R_NB * kin.r_bh;
        return at.contact_point[condition.index] - r_bh[condition.index];
      }
      case SideKind::TurnSize:
        return at.turn_size_squared;
      case SideKind::BaseTilt:
        return tilt_cosine<Number>(model, at);
    }
    return Number(0.0);
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
