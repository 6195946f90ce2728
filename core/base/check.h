// TET_CHECK: our own mistakes, told at the line they are noticed.
#pragma once

#include <cstdio>
#include <cstdlib>

/// Aborts with the condition and its place when an internal invariant does not hold. For our
/// own mistakes only: a caller's mistake is an absl::Status. Compiled out unless TET_CHECKS is
/// set.
#ifdef TET_CHECKS
#define TET_CHECK(condition)                                                                 \
  do {                                                                                       \
    if (!(condition)) {                                                                      \
      std::fprintf(stderr, "%s:%d: invariant broken: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                          \
    }                                                                                        \
  } while (false)
#else
#define TET_CHECK(condition) static_cast<void>(sizeof(!(condition)))
#endif
