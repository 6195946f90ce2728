// The folder of one stored mesh, held against eviction while it is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/file.h"
#include "server/jobs/results/stored_chunk.h"
#include "server/jobs/store/job.h"

namespace tet {

/// A chunk's SHA-256, as the file of its shard lists it.
inline constexpr std::size_t kDigestBytes = 32;

/// A lock on a folder among all processes that may see it, by its file `lock`.
class FolderLock {
 public:
  /// Waits for nobody but who evicts. Errors: kNotFound (no such folder, unless `make`),
  /// kAborted (FileLock::kAlone: somebody uses it), and the disk's.
  static absl::StatusOr<FolderLock> take(const std::filesystem::path& folder,
                                         FileLock how,
                                         bool make);

 private:
  explicit FolderLock(File file) : file_(std::move(file)) {}
  File file_;
};

/// Chunks under the SHA-256 of their files, and one file for each shard that was made: its
/// chunks' digests. Files appear whole or not at all; a shard's, and all chunks that were put
/// before it, survive a power cut.
///
/// Thread safety: every member may be called from any thread, and from any process that shares
/// the folder.
class MeshFolder {
 public:
  MeshFolder(std::filesystem::path path, FolderLock lock)
      : path_(std::move(path)), lock_(std::move(lock)) {}

  /// Is asked for room for so many bytes before they are written.
  using MakeRoom = std::function<absl::Status(std::uint64_t bytes)>;

  /// Says the digest. Chunks that are there already are not written again, and need no room.
  absl::StatusOr<ChunkDigest> put_chunk(const ChunkMessage& chunk,
                                        const MakeRoom& make_room = nullptr);
  /// Errors: kDataLoss with reason CHUNK_DAMAGED (missing, or other bytes; those are set aside,
  /// so that the chunk can be made again), and the disk's.
  absl::StatusOr<ChunkMessage> get_chunk(const ChunkDigest& digest,
                                         BlockPool& blocks,
                                         std::shared_ptr<SendBudget::Lease> held) const;
  bool has_chunk(const ChunkDigest& digest) const;

  absl::Status put_shard(ChunkRange range, const std::vector<ChunkDigest>& digests);
  /// What was put; nothing where none was, or its file is damaged.
  std::optional<std::vector<ChunkDigest>> find_shard(ChunkRange range) const;
  /// `find_shard`, if all of its chunks are there.
  std::optional<std::vector<ChunkDigest>> find_whole_shard(ChunkRange range) const;

 private:
  std::filesystem::path chunk_path(const ChunkDigest& digest) const;
  std::filesystem::path shard_path(ChunkRange range) const;

  const std::filesystem::path path_;
  const FolderLock lock_;
};

/// Whether a file is a damaged chunk that was moved out of the way.
bool is_set_aside(const std::filesystem::path& path);

}  // namespace tet
