// One upload on its way to the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "proto/wire/sha256.h"
#include "server/grids/grid_store.h"
#include "server/ops/disk.h"

namespace tet {

/// The only writer of a part file. Destroyed before `commit`, it leaves the part to be resumed.
///
/// Not thread-safe; the store outlives it.
class GridUpload {
 public:
  /// Takes over the part. The store has reserved the place.
  static absl::StatusOr<std::unique_ptr<GridUpload>> open(GridStore& store,
                                                          GridKey key,
                                                          std::uint64_t size_bytes,
                                                          File part);
  ~GridUpload();
  GridUpload(const GridUpload&) = delete;
  GridUpload& operator=(const GridUpload&) = delete;

  /// Digests `most_bytes` more, or all, of what the part held when it was taken over. Before
  /// more may come, or all of it is to be stored, all of that has to be digested: as long as a
  /// part of gigabytes takes.
  absl::Status digest_part(std::uint64_t most_bytes);
  bool has_digested_part() const noexcept { return committed_size_ >= part_size_; }

  /// What has been digested, and can be gone on from.
  std::uint64_t committed_size() const noexcept { return committed_size_; }
  std::uint64_t size_bytes() const noexcept { return size_bytes_; }
  bool has_all() const noexcept { return committed_size_ == size_bytes_; }

  /// Errors: kOutOfRange (offset is not the committed size), kInvalidArgument (more than was
  /// announced), kResourceExhausted (disk full). What was committed before stays.
  absl::Status append(std::uint64_t offset, std::string_view bytes);

  /// The parts of `append`, for a caller that writes and digests at the same time: first
  /// whether `size` bytes may come at `offset`, last that they did. After an error nothing more
  /// may come.
  absl::Status check(std::uint64_t offset, std::uint64_t size) const;
  absl::Status write(std::span<const std::string_view> bytes);
  void digest(std::span<const std::string_view> bytes) noexcept;
  void advance(std::uint64_t size) noexcept { committed_size_ += size; }

  /// Stores the file, once `has_all`.
  /// Errors: kInvalidArgument (other bytes than the digest says: they are thrown away).
  absl::Status commit();

 private:
  GridUpload(GridStore& store, GridKey key, std::uint64_t size_bytes, File file)
      : store_(store), key_(std::move(key)), size_bytes_(size_bytes), file_(std::move(file)) {}
  absl::Status measure_part();

  GridStore& store_;
  const GridKey key_;
  const std::uint64_t size_bytes_;
  File file_;
  Sha256 sha256_;
  std::uint64_t part_size_ = 0;  ///< when it was taken over
  std::uint64_t committed_size_ = 0;
  bool kept_ = false;
};

}  // namespace tet
