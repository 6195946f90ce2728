// SSE 4.1's instructions: the processor's own on x86-64, and the same in SIMDe's words
// elsewhere.
#pragma once

#if defined(__x86_64__)
#include <smmintrin.h>
#else
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/sse4.1.h>
#endif
