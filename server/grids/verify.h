// Whether a stored file still is what was uploaded.
#pragma once

#include <filesystem>
#include <functional>

#include <absl/status/status.h>

namespace tet {

/// Digests the file at `path`, whose name is the SHA-256 that its bytes had when they were
/// stored, until it is `cancelled`. Errors: kDataLoss with reason STORED_GRID_CORRUPT (other
/// bytes, or no file), kCancelled, or the disk's.
absl::Status verify_stored(
    const std::filesystem::path& path,
    const std::function<bool()>& cancelled = [] { return false; });

}  // namespace tet
