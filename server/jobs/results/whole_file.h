// Small files that are whole or absent, with a checksum.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "server/ops/disk.h"

namespace tet {

/// Writes a file beside `path` and renames it. On failure nothing is left. Its bytes are
/// durable when it returns OK; its name is once write_checked has written to the same folder,
/// so that many files share one flush of it. Errors: those of `write`, and the disk's.
absl::Status write_whole(const std::filesystem::path& path,
                         const std::function<absl::Status(File&)>& write);

/// Writes text, which its SHA-256 follows; durable, name and all, when it returns OK.
absl::Status write_checked(const std::filesystem::path& path, std::string_view text);
/// What write_checked wrote there; nothing where there is none or it is damaged.
std::optional<std::string> read_checked(const std::filesystem::path& path);

/// Whether a name is one that `write_whole` gives to what is not whole yet.
bool is_unfinished(const std::filesystem::path& path);

}  // namespace tet
