// Which servers may work in one store at a time: one, or several that know of each other.
#pragma once

#include <filesystem>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/posix/file.h"

namespace tet {

/// Who else works in a store.
enum class StoreSharing {
  kAlone,    ///< workers at most
  kServers,  ///< other servers, all of which ask one database which grids jobs need
  kBeside,   ///< for a worker: servers, of whatever kind
};

/// Holds a directory for this process, or for all servers that share it, until it is destroyed
/// or the process ends, however it does.
class StoreLock {
 public:
  /// Locks `folder`/lock as a server that shares it or does not, and writes the process there.
  /// Errors: kFailedPrecondition (another process has it and one of the two wants it alone:
  /// which), kInternal (cannot be made).
  static absl::StatusOr<StoreLock> take(const std::filesystem::path& folder,
                                        StoreSharing sharing = StoreSharing::kAlone);

 private:
  explicit StoreLock(File file) : file_(std::move(file)) {}

  File file_;
};

}  // namespace tet
