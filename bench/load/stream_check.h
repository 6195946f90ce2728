// Whether a stream brought a whole mesh, without keeping it.
#pragma once

#include <cstdint>

#include <absl/status/status.h>
#include <grpcpp/support/byte_buffer.h>

#include "proto/wire/chunk_frame.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

/// Follows one stream. Not thread-safe.
class StreamCheck {
 public:
  explicit StreamCheck(bool check_columns) : check_columns_(check_columns) {}

  /// Takes a message as it came; the columns of a chunk are looked at for their checksum only.
  /// Errors: kDataLoss (no MeshEvent, a chunk out of place or with a wrong checksum, a trailer
  /// too early).
  absl::Status take(grpc::ByteBuffer& event);

  /// kOk when the trailer came, and with it the whole mesh. Errors: kDataLoss.
  absl::Status ended() const;

  bool has_header() const noexcept { return has_header_; }
  std::uint64_t chunks() const noexcept { return next_chunk_; }
  std::uint64_t tets() const noexcept { return next_tet_; }
  std::uint64_t column_bytes() const noexcept { return column_bytes_; }

 private:
  absl::Status take(const tetstream::v1::MeshEvent& event);
  absl::Status take_chunk(const ChunkNumbers& chunk, std::uint64_t column_bytes);
  absl::Status check_columns(const ChunkNumbers& chunk, std::uint32_t checksum) const;

  bool check_columns_;
  bool has_header_ = false, has_trailer_ = false;
  std::uint64_t chunk_count_ = 0, tet_count_ = 0;
  std::uint64_t next_chunk_ = 0, next_tet_ = 0, column_bytes_ = 0;
};

}  // namespace tet::load
