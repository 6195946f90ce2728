// How much of a long test a sanitizer sees.
#pragma once

namespace tet::test {

/// True in a build for a sanitizer, in which everything takes ten times as long. It sees what
/// each path does to memory and threads; whether a promise holds on one more random input is
/// for the other builds. So a test that walks the same path with many inputs walks it with
/// fewer there.
#ifdef TET_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace tet::test
