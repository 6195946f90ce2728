// Whether a stream brought a whole mesh, without keeping it.
#pragma once

#include <cstdint>

#include <absl/status/status.h>

#include "tetstream/v1/meshes.pb.h"

namespace tet::load {

/// Follows one stream. Not thread-safe.
class StreamCheck {
 public:
  explicit StreamCheck(bool check_columns) : check_columns_(check_columns) {}

  /// Errors: kDataLoss (a chunk out of place, of another size than its header says, or with a
  /// wrong checksum; a trailer too early).
  absl::Status take(const tetstream::v1::MeshEvent& event);

  /// kOk when the trailer came, and with it the whole mesh. Errors: kDataLoss.
  absl::Status ended() const;

 private:
  absl::Status take_chunk(const tetstream::v1::MeshChunk& chunk);

  bool check_columns_;
  bool has_header_ = false, has_trailer_ = false;
  std::int64_t chunk_count_ = 0, tet_count_ = 0;
  std::int64_t next_chunk_ = 0, next_tet_ = 0;
};

}  // namespace tet::load
