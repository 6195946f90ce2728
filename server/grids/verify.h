// Whether a stored file still is what was uploaded.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <absl/status/status.h>

#include "server/rpc/fair_tasks.h"

namespace tet {

/// Digests the file at `path`, whose name is the SHA-256 that its bytes had when they were
/// stored, until it is `cancelled`. Errors: kDataLoss with reason STORED_GRID_CORRUPT (other
/// bytes, or no file), kCancelled, or the disk's.
absl::Status verify_stored(
    const std::filesystem::path& path,
    const std::function<bool()>& cancelled = [] { return false; });

/// A stored file that is looked at in many short turns of a client.
struct TurnsToVerify {
  FairTasks& disk;
  std::string client;
  std::function<bool()> cancelled;
};

/// Verifies a stored file in turns, between those of others, and calls `done` in the last one.
/// Errors, as `done` gets them: those of verify_stored.
void verify_in_turns(TurnsToVerify turns,
                     const std::filesystem::path& path,
                     std::function<void(const absl::Status&)> done);

}  // namespace tet
