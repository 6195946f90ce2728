// Ctrl-C and its like, as a flag that long work polls.
#pragma once

#include "core/base/cancel.h"

namespace tet {

/// Raised by SIGINT, SIGTERM and SIGHUP from the first call on. From then on a full disk and a
/// closed pipe are errors too, not the end of the process. Call it before starting threads.
const Cancellation& watch_for_interruption();

/// What watch_for_interruption returns, for what understands options that name files: those may
/// be pipes, for which it waits.
const Cancellation& user_interruption() noexcept;

/// The number of the first signal that came, or 0.
int interrupting_signal() noexcept;

}  // namespace tet
