// Sines and cosines of many angles at once.
#pragma once

namespace stillbase {

inline constexpr int kSinesAtOnce = 8;

/// Sine and cosine of n angles (rad), within 2 ulp: the same digits on every machine, since no
/// products are fused with sums, and no mathematical library has a say but beyond 1e6 rad.
/// @param x room for a multiple of kSinesAtOnce, all of it numbers, as of the results
/// @pre results are rounded to nearest
void sines_and_cosines(const double* x, int n, double* sine, double* cosine);

/// One way to do so.
struct SinesKernel {
  bool (*runs_here)();  ///< on this processor
  void (*run)(const double* x, int n, double* sine, double* cosine);
};

/// Null where the compiler has no such registers.
const SinesKernel* sines_kernel_avx512();
const SinesKernel* sines_kernel_avx2();
const SinesKernel* sines_kernel_any_machine();

}  // namespace stillbase
