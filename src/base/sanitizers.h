#pragma once
/// SL_ADDRESS_SANITIZER and SL_THREAD_SANITIZER are 1 in builds with them, by g++ or clang, else 0.

#if defined(__has_feature)
#define SL_HAS_FEATURE(name) __has_feature(name)
#else
#define SL_HAS_FEATURE(name) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || SL_HAS_FEATURE(address_sanitizer)
#define SL_ADDRESS_SANITIZER 1
#else
#define SL_ADDRESS_SANITIZER 0
#endif
#if defined(__SANITIZE_THREAD__) || SL_HAS_FEATURE(thread_sanitizer)
#define SL_THREAD_SANITIZER 1
#else
#define SL_THREAD_SANITIZER 0
#endif
