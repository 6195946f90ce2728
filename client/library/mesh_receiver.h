// Stream events in, a mesh in memory out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/compact_receiver.h"
#include "client/library/mesh_client.h"
#include "core/mesh/packed_chunk.h"
#include "core/mesh/splice.h"
#include "proto/wire/chunk_frame.h"

namespace tet {

/// Collects one mesh from as many streams as it takes. Trusts nothing that the server says:
/// every count and every vertex id is checked before it is used. Not thread-safe.
class MeshReceiver {
 public:
  /// `base`, which may be null, is the mesh that the request names as its base; it must outlive
  /// this. The mesh is made in the memory of `used`, as far as that is enough.
  explicit MeshReceiver(const TetMesh* base = nullptr, TetMesh used = {})
      : base_(base), used_(std::move(used)) {}

  /// Errors: kDataLoss (saying what does not fit), kResourceExhausted (no memory for the mesh).
  absl::Status take(const v1::MeshEvent& event);
  /// Takes an event as it came: a chunk goes into the mesh without another copy.
  absl::Status take(grpc::ByteBuffer& event);

  /// How far planning is, if the last event said that.
  const std::optional<v1::MeshProgress>& planning() const noexcept { return planning_; }

  /// The first chunk that is missing.
  std::uint64_t next_chunk() const noexcept { return next_chunk_; }
  const std::string& mesh_id() const noexcept { return received_.mesh_id; }
  std::uint64_t tets_received() const noexcept { return next_tet_; }
  /// Tets of the chunks that came, without those kept from the base.
  std::uint64_t tets_sent() const noexcept { return tets_sent_; }
  std::uint64_t tet_count() const noexcept { return received_.mesh.header.tet_count; }
  /// Every chunk is here and the server has said that there are no more.
  bool complete() const noexcept { return complete_; }

  /// The mesh, once complete. Statistics are measured here unless one stream brought them all.
  /// Errors: those of CompactReceiver::finish.
  absl::StatusOr<StreamedMesh> finish(const Cancellation& cancellation) &&;

 private:
  using ColumnBytes = std::array<std::size_t, ChunkFrame::kColumns>;

  absl::Status take_header(const v1::MeshHeader& header);
  absl::Status take_chunk(const v1::MeshChunk& chunk);
  absl::Status take_encoded(const v1::MeshChunk& chunk);
  absl::Status unpack(const ChunkExtent& extent, std::span<const std::byte> bytes);
  absl::Status check_place(const ChunkNumbers& chunk) const;
  absl::StatusOr<ChunkColumns> place_of(const ChunkNumbers& chunk, const ColumnBytes& columns);
  absl::Status take_kept(const v1::MeshHeader& header, const MeshHeader& checked);
  absl::Status allocate(const MeshHeader& header);
  absl::Status advance(const ChunkNumbers& chunk, std::uint32_t checksum);
  void count(const ChunkNumbers& chunk);
  absl::Status take_trailer(const v1::MeshTrailer& trailer);
  absl::Status take_statistics(const v1::MeshTrailer& trailer);
  absl::Status take_quality(const v1::MeshTrailer& trailer);
  Statistics statistics() const;

  const TetMesh* base_;
  TetMesh used_;
  StreamedMesh received_;
  KeptParts kept_;                          ///< of the base
  std::uint64_t chunks_ = 0;                ///< that come, once there is a header
  std::optional<CompactReceiver> compact_;  ///< where chunks are compact
  ChunkUnpacker unpacker_;
  std::optional<v1::MeshProgress> planning_;
  std::uint64_t next_chunk_ = 0, next_vertex_ = 0, next_tet_ = 0, tets_sent_ = 0;
  bool has_header_ = false, keeps_parts_ = false, has_quality_ = false, complete_ = false;
};

}  // namespace tet
