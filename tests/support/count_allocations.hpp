// Counts heap allocations by standing in for malloc, which `operator new` and Eigen both end in.
// Include it in one source file of a program. It counts with glibc only, and not under
// AddressSanitizer, which stands in for malloc itself: see kCountsAllocations.
#pragma once

#include <cstddef>
#include <cstdlib>

namespace stillbase {

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
inline constexpr bool kCountsAllocations = true;
#else
inline constexpr bool kCountsAllocations = false;
#endif

/// Calls of malloc by this thread so far.
inline thread_local long allocation_count = 0;

}  // namespace stillbase

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++stillbase::allocation_count;
  return __libc_malloc(size);
}
#endif
