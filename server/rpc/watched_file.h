// Settings kept in files of their own, which may be replaced while the server runs.
#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

#include <absl/status/statusor.h>

namespace tet {

/// Reads a small file as a whole. `forbidden` are the permission bits that it must not have:
/// 077 for what only its owner may read. Errors: kInvalidArgument (not there, not readable,
/// over 1 MiB, or readable by others).
absl::StatusOr<std::string> read_small_file(const std::string& path, mode_t forbidden = 0);

/// Tells when files were replaced or written to. Not thread-safe.
class FileWatch {
 public:
  explicit FileWatch(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  /// Whether any file is another than at the last call; true at the first.
  bool changed();

 private:
  /// What a file that was replaced or written to has different.
  struct Stamp {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0;
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  static Stamp stamp_of(const std::string& path);

  std::vector<std::string> paths_;
  std::vector<Stamp> stamps_;
};

}  // namespace tet
