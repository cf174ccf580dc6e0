// Sines and cosines with the registers that this source file is compiled for.
#pragma once

#include "core/pack.hpp"
#include "core/sines.hpp"

namespace stillbase {

/// @tparam P pack type, which carries the instruction set in its name
template <class P>
void sines_and_cosines_in_packs(const double* x, int n, double* sine, double* cosine) {
  static_assert(kSinesAtOnce % P::kLanes == 0);
  for (int i = 0; i < n; i += P::kLanes) {
    P s, c;
    sin_and_cos(P::load(x + i), s, c);
    s.store(sine + i);
    c.store(cosine + i);
  }
}

}  // namespace stillbase
