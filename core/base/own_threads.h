// Parallel loops beside the pools, for work that gives way to theirs.
#pragma once

#include <functional>

namespace tet {

/// Runs `work` in the calling thread. Parallel loops within it run there and on up to
/// `threads` - 1 threads more, which each loop makes for itself: on Linux they have the
/// caller's priority, where those of a TaskPool are all alike. `threads` <= 0 takes every core.
void run_with_own_threads(int threads, const std::function<void()>& work);

}  // namespace tet
