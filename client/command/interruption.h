// Ctrl-C and its like, as a flag that long work polls.
#pragma once

#include "core/base/cancel.h"

namespace tet {

/// Raised by SIGINT, SIGTERM and SIGHUP from the first call on. From then on a full disk and a
/// closed pipe are errors too, not the end of the process. Call it before starting threads.
const Cancellation& watch_for_interruption();

/// The number of the first signal that came, or 0.
int interrupting_signal() noexcept;

}  // namespace tet
