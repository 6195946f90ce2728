// Threads that libraries start before main, and that nobody uses.
#pragma once

#include <absl/status/status.h>

namespace tet {

/// Waits until all other threads of the process sleep, at one and the same moment. None of them
/// goes on by itself from then on, if the caller holds nothing that they wait for: what sleeps
/// waits for another.
///
/// A thread that is still starting, or ending, makes system calls that it never makes again.
/// Errors: kInternal (the system does not tell how they are, or one works on and on).
absl::Status await_idle_threads();

}  // namespace tet
