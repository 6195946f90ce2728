// One server at a time in one store.
#pragma once

#include <filesystem>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/posix/file.h"

namespace tet {

/// Holds a directory for this process until it is destroyed or the process ends, however it
/// does.
class StoreLock {
 public:
  /// Locks `folder`/lock, and writes the process's number there.
  /// Errors: kFailedPrecondition (another process has it: which), kInternal (cannot be made).
  static absl::StatusOr<StoreLock> take(const std::filesystem::path& folder);

 private:
  explicit StoreLock(File file) : file_(std::move(file)) {}

  File file_;
};

}  // namespace tet
