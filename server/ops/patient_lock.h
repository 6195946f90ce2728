// Locks among processes that are held for a short time only.
#pragma once

#include <string_view>

#include <absl/status/status.h>

#include "core/base/posix/file.h"

namespace tet {

/// Takes the file alone, and waits for whoever has it, but for a minute at most: a process that
/// was stopped holds its locks for ever. `what` says in the error what the file stands for.
/// Errors: kUnavailable (held for too long), the disk's.
absl::Status lock_patiently(File& file, std::string_view what);

}  // namespace tet
