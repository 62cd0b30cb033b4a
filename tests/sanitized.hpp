#pragma once
// Whether a sanitizer watches: what takes a second takes several then, and operator new is not ours alone.

#if defined(__has_feature)
#if __has_feature(thread_sanitizer) || __has_feature(address_sanitizer)
#define GN_TEST_SANITIZED 1
#endif
#elif defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
#define GN_TEST_SANITIZED 1
#endif

namespace gnomon::test {

#if defined(GN_TEST_SANITIZED)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
/// Times as long as without, at most: three to eight.
inline constexpr unsigned kSlowness = kSanitized ? 8 : 1;

} // namespace gnomon::test
