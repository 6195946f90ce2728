// One server at a time in one store.
#pragma once

#include <filesystem>

#include <absl/status/statusor.h>

namespace tet {

/// Holds a directory for this process until it is destroyed or the process ends, however it
/// does.
class StoreLock {
 public:
  /// Locks `folder`/lock, and writes the process's number there.
  /// Errors: kFailedPrecondition (another process has it: which), kInternal (cannot be made).
  static absl::StatusOr<StoreLock> take(const std::filesystem::path& folder);
  ~StoreLock();
  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&&) = delete;

 private:
  explicit StoreLock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
};

}  // namespace tet
