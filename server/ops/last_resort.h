// The end of a process that was told to end, whatever hinders it.
#pragma once

#include <chrono>
#include <csignal>

namespace tet {

/// Ends the process after `time`, or when it is told to end once more (any of `signals`, which
/// are blocked in every thread), with exit code 3: a thread may hang in a disk that does not
/// answer, and would be waited for, for ever.
void end_after(std::chrono::seconds time, const sigset_t& signals);

/// Signals that end nothing here: of terminals that hang up, and of readers that went away.
void ignore_hangups();

}  // namespace tet
