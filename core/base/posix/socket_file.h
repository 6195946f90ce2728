// A Unix socket's file: claimed, given its rights before anybody can reach it, and removed
// again.
#pragma once

#include <cstddef>
#include <string>
#include <sys/types.h>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// Where a process listens on a socket file. The socket is bound at `bind_path`, in a folder
/// that only its user can enter; `publish` gives it its rights and moves it to its path, so
/// that nobody reaches it with other rights, and nothing else is ever at that path.
///
/// A socket file that nobody listens on, as a process that was killed leaves it, is replaced.
/// Anything else that is there stays.
///
/// Not thread-safe.
class SocketFile {
 public:
  /// Longest path, bytes: an address of the system's holds 107, and a companion's ending has to
  /// fit behind it.
  static constexpr std::size_t kMaxPath = 100;

  /// Errors: kInvalidArgument (no path, or too long a one), kFailedPrecondition (something that
  /// is no socket is there), kUnavailable (somebody listens there, or may), those of io_error.
  static absl::StatusOr<SocketFile> prepare(const std::string& path,
                                            std::size_t limit = kMaxPath);
  SocketFile(SocketFile&&) noexcept = default;
  SocketFile& operator=(SocketFile&&) = delete;
  /// Removes the file, if it is still this one.
  ~SocketFile();

  const std::string& path() const noexcept { return path_; }
  /// Where to bind, and what the system then calls the address of the socket.
  const std::string& bind_path() const noexcept { return bind_path_; }

  /// To be called once the socket listens. Errors: those of `prepare`.
  absl::Status publish(mode_t rights);

 private:
  SocketFile() = default;
  absl::Status make_way() const;
  absl::Status move_there(mode_t rights);
  void remove_stage() noexcept;

  std::string path_, name_, stage_name_, bind_path_;
  Descriptor folder_, stage_;
  dev_t device_ = 0;  ///< of what was published; with `inode_`
  ino_t inode_ = 0;   ///< 0: nothing
};

/// Errors: kInvalidArgument, naming the length and the limit.
absl::Status check_socket_path(const std::string& path,
                               std::size_t limit = SocketFile::kMaxPath);

}  // namespace tet
