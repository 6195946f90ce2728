// Starting a program that gets one descriptor and nothing else of this process.
#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

#include <absl/status/statusor.h>

namespace tet {

/// Starts `path` with `environment` alone ("NAME=value"), `descriptor` as `as`, which is 3 or
/// more, nothing on 0, 1 and 2, default signals, and a process group of its own, so that a
/// terminal's signals pass it by. Never forks: its caller may have any threads.
/// Errors: kUnavailable.
absl::StatusOr<pid_t> spawn(const std::string& path,
                            const std::vector<std::string>& environment,
                            int descriptor,
                            int as);

}  // namespace tet
