// The encounter over a box by quadratic forms: what encounter_over() needs of them.
#pragma once

#include "proof/encounter_kernel.hpp"
#include "proof/quadratic.hpp"

/// Forms are wide numbers: their matrices take as many joints as a redundant arm has.
template <int N>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Quadratic<N>> = 8;

namespace stillbase::proof {

/// The target's turn to second order in time, about the middle of the box.
template <int N>
TargetTurn<Quadratic<N>> turn_over(const SpinEnclosure& spin, const Quadratic<N>& time) {
  const SpinSeries motion = spin.series(time.c, time.range());
  const auto entry = [&](const auto& f, const auto& whole, Eigen::Index i) {
    return series(time, {f[0].data()[i].v, f[1].data()[i].v, f[2].data()[i].v, f[3].data()[i].v},
                  whole.data()[i].v);
  };
  TargetTurn<Quadratic<N>> out;
  for (Eigen::Index i = 0; i < 9; ++i) {
    out.R_NT.data()[i] = entry(motion.R, motion.whole.R, i);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    out.omega.data()[i] = entry(motion.omega, motion.whole.omega, i);
  }
  return out;
}

}  // namespace stillbase::proof
