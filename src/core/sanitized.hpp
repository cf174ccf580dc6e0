// Whether this build runs under the address or the thread sanitizer, whose shadow memory is larger
// than any limit of address space and whose allocator is not to be replaced.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
#define STILLBASE_SANITIZED 1
#elif defined(__has_feature)  // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define STILLBASE_SANITIZED 1
#endif
#endif
#ifndef STILLBASE_SANITIZED
#define STILLBASE_SANITIZED 0
#endif
