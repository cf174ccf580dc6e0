// Counts heap allocations by standing in for malloc, which `operator new` and Eigen both end in.
// Include it in one source file of a program. It counts with glibc only, and not under
// sanitizers, which stand in for malloc themselves: see kCountsAllocations.
#pragma once

#include <cstddef>
#include <cstdlib>

#include "core/sanitized.hpp"

namespace stillbase {

#if defined(__GLIBC__) && !STILLBASE_SANITIZED
inline constexpr bool kCountsAllocations = true;
#else
inline constexpr bool kCountsAllocations = false;
#endif

/// Calls of malloc by this thread so far.
inline thread_local long allocation_count = 0;

}  // namespace stillbase

#if defined(__GLIBC__) && !STILLBASE_SANITIZED
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++stillbase::allocation_count;
  return __libc_malloc(size);
}
#endif
