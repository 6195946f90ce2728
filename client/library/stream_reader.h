// Stream events in, chunks out: checked, in order, and each where its consumer wants it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/chunk_consumer.h"
#include "client/library/compact_receiver.h"
#include "client/library/mesh_client.h"
#include "client/library/shared_chunks.h"
#include "core/mesh/packed/packed_chunk.h"
#include "core/mesh/stable/splice.h"
#include "proto/wire/chunk_frame.h"

namespace tet {

/// Reads one mesh from as many streams as it takes. Trusts nothing that the server says: every
/// count and every vertex id is checked before it is used. Not thread-safe.
///
/// Compact chunks hold no columns: they are gathered in `compact`, and their consumer is asked
/// for nothing.
class StreamReader {
 public:
  /// Whether the header may say that parts of another mesh are kept; of the frame before also
  /// such that patches are loose (see KeptParts).
  enum class Base : std::uint8_t { kNone, kNamed, kFrame };

  /// `consumer` outlives this, and lies still.
  StreamReader(ChunkConsumer& consumer, Base base) : consumer_(&consumer), base_(base) {}

  /// Takes chunks from shared memory, too, and waits until `cancellation` at most for it to be
  /// handed over. Both outlive this.
  void use_shared(SharedChunks& shared, const Cancellation& cancellation) noexcept {
    shared_ = &shared;
    cancellation_ = &cancellation;
  }

  /// Errors: kDataLoss (saying what does not fit), kUnavailable (the next attempt begins with
  /// chunk 0), those of the consumer.
  absl::Status take(const v1::MeshEvent& event);
  /// Takes an event as it came: a chunk goes to its place without another copy.
  absl::Status take(grpc::ByteBuffer& event);

  /// How far planning is, if the last event said that.
  const std::optional<v1::MeshProgress>& planning() const noexcept { return planning_; }

  bool has_header() const noexcept { return has_header_; }
  /// Whether the header said that nothing is kept of a base.
  bool is_sent_whole() const noexcept { return has_header_ && !keeps_parts_; }
  /// All but the columns: of the header once there is one, of the trailer once complete.
  const StreamedMesh& told() const noexcept { return told_; }
  StreamedMesh& told() noexcept { return told_; }
  /// Whether the trailer told the quality of the whole mesh.
  bool has_quality() const noexcept { return has_quality_; }
  /// What the request wants of them.
  Statistics statistics() const noexcept;

  /// The first chunk that is missing.
  std::uint64_t next_chunk() const noexcept { return next_chunk_; }
  std::uint64_t tets_received() const noexcept { return next_tet_; }
  /// Tets of the chunks that came, without those kept from the base.
  std::uint64_t tets_sent() const noexcept { return tets_sent_; }
  /// Every chunk is here and the server has said that there are no more.
  bool complete() const noexcept { return complete_; }
  /// Why there is no mesh, where a session's server has refused the frame; else OK.
  const absl::Status& refusal() const noexcept { return refusal_; }

  /// Where chunks are compact.
  std::optional<CompactReceiver>& compact() noexcept { return compact_; }
  /// The chunks that were gathered there.
  const std::vector<ChunkExtent>& compact_chunks() const noexcept { return compact_chunks_; }

 private:
  using ColumnBytes = std::array<std::size_t, kMeshColumns>;

  const MeshHeader& header() const noexcept { return told_.mesh.header; }
  absl::Status read(grpc::ByteBuffer& event);
  absl::Status take_header(const v1::MeshHeader& header);
  absl::Status resume(const v1::MeshHeader& header);
  absl::Status take_shared(const ChunkNumbers& numbers, std::int64_t offset);
  absl::Status begin(const v1::MeshHeader& header, const MeshHeader& checked);
  absl::Status take_chunk(const v1::MeshChunk& chunk);
  absl::Status take_packed(const ChunkNumbers& numbers, std::span<const std::byte> bytes);
  absl::Status take_compact(const ChunkNumbers& numbers, std::span<const std::byte> bytes);
  absl::Status check_place(const ChunkNumbers& chunk) const;
  bool follows(const ChunkNumbers& chunk) const;
  bool is_whole() const;
  absl::StatusOr<ChunkColumns> place_of(const ChunkNumbers& chunk, const ColumnBytes& columns);
  absl::Status advance(const ChunkNumbers& chunk,
                       const ChunkColumns& columns,
                       const CopiedChunk& copied);
  absl::Status hand_on(const ChunkNumbers& chunk);
  void count(const ChunkNumbers& chunk);
  absl::Status take_refusal(const v1::FrameRefusal& refusal);
  absl::Status take_trailer(const v1::MeshTrailer& trailer);
  absl::Status take_statistics(const v1::MeshTrailer& trailer);
  absl::Status take_quality(const v1::MeshTrailer& trailer);

  ChunkConsumer* consumer_;
  SharedChunks* shared_ = nullptr;              ///< null: none is asked for
  const Cancellation* cancellation_ = nullptr;  ///< null with it
  Base base_;
  StreamedMesh told_;
  KeptParts kept_;                          ///< of the base
  ChunkExtent to_come_;                     ///< what chunks have, where kept parts are loose
  std::uint64_t chunks_ = 0;                ///< that come, once there is a header
  std::optional<CompactReceiver> compact_;  ///< where chunks are compact
  std::vector<ChunkExtent> compact_chunks_;
  ChunkUnpacker unpacker_;
  absl::Status refusal_;
  std::optional<v1::MeshProgress> planning_;
  std::uint64_t next_chunk_ = 0, next_vertex_ = 0, next_tet_ = 0, tets_sent_ = 0;
  std::uint64_t next_face_ = 0;
  bool has_header_ = false, keeps_parts_ = false, has_quality_ = false, complete_ = false;
};

}  // namespace tet
