// Loops compiled once for each generation of processors; the program takes what its processor
// knows when it starts.
#pragma once

// Every clone computes the same bits: nothing is fused (-ffp-contract=off) and no sum is
// reordered, so a wider vector does the same operations on more lanes. Sanitizers and lint see
// one plain function: the resolver runs before a sanitizer is ready. Other processors than
// x86-64 have their one vector unit.
#if !defined(__x86_64__) || defined(__clang__) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__)
#define TET_VECTOR_CLONES
#else
#define TET_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
