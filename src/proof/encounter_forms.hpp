// The encounter over a box by Taylor models: what encounter_over() needs of them.
#pragma once

#include "proof/encounter_kernel.hpp"
#include "proof/taylor.hpp"

/// Forms are wide numbers: their matrices take as many joints as a redundant arm has.
template <int N, int K>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Taylor<N, K>> = 8;

namespace stillbase::proof {

/// The target's turn to second order in time, about the middle of the box.
template <int N, int K>
TargetTurn<Taylor<N, K>> turn_over(const SpinEnclosure& spin, const Taylor<N, K>& time) {
  const SpinSeries motion = spin.series(time.c(), time.range());
  const auto entry = [&](const auto& f, const auto& whole, Eigen::Index i) {
    const std::array<Interval, 4> terms = {f[0].data()[i].v, f[1].data()[i].v, f[2].data()[i].v,
                                           f[3].data()[i].v};
    return series(time, terms, whole.data()[i].v);
  };
  TargetTurn<Taylor<N, K>> out;
  for (Eigen::Index i = 0; i < 9; ++i) {
    out.R_NT.data()[i] = entry(motion.R, motion.whole.R, i);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    out.omega.data()[i] = entry(motion.omega, motion.whole.omega, i);
  }
  return out;
}

}  // namespace stillbase::proof
