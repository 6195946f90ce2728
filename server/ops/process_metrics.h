// The process as the system sees it, under the names that every Prometheus client uses.
#pragma once

#include <vector>

#include "server/ops/metrics.h"

namespace tet {

/// CPU time, memory, threads, file descriptors and start time, read from /proc/self.
std::vector<Reading> read_process();

}  // namespace tet
