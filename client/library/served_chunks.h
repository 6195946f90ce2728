// A mesh that a server makes, chunk by chunk.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "client/library/chunk_consumer.h"
#include "client/library/chunk_supply.h"
#include "client/library/connection.h"
#include "client/library/event_stream.h"
#include "client/library/reused_chunk.h"
#include "client/library/stream_reader.h"
#include "core/base/cancel.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// Holds one chunk at a time. Compact chunks, which hold no columns, are gathered before the
/// first is handed on: then it holds the whole mesh.
class ServedChunks : public ChunkSupply, private ChunkConsumer {
 public:
  /// `cancellation` outlives this, and `progress` may be null.
  ServedChunks(std::shared_ptr<Connection> connection,
               v1::StreamMeshRequest request,
               ClientProgress progress,
               const Cancellation& cancellation);

  absl::StatusOr<const MeshHeader*> header() override;
  std::string mesh_id() const override { return reader_.told().mesh_id; }
  absl::StatusOr<const ChunkView*> next() override;
  std::shared_ptr<const TetMesh> keep() const override {
    return gathered_ ? gathered_ : memory_.kept();
  }
  const TrailerFacts& facts() const override { return facts_; }

 private:
  absl::Status make_room(const MeshHeader& header, const KeptParts* kept) override;
  absl::StatusOr<ChunkColumns> place(const ChunkExtent& chunk) override;
  absl::Status take(const ChunkExtent& chunk) override;

  StreamCall call();
  /// Takes one more event; false after the last.
  absl::StatusOr<bool> step();
  void tell_progress();
  absl::Status gather();
  const ChunkView* gathered_chunk();
  void note_facts();

  const std::shared_ptr<Connection> connection_;
  v1::StreamMeshRequest request_;
  const ClientProgress progress_;
  const Cancellation& cancellation_;
  const PooledSharedChunks shared_{connection_->shared_chunks()};
  StreamReader reader_{*this, StreamReader::Base::kNone};
  ReusedChunk memory_;                 ///< of the chunk that is being taken
  std::shared_ptr<TetMesh> gathered_;  ///< the whole mesh, where its chunks are compact
  ChunkView chunk_;
  bool has_chunk_ = false;     ///< that nobody has been given yet
  std::size_t handed_on_ = 0;  ///< of the compact chunks
  TrailerFacts facts_;
  absl::Status failure_;
  EventStream events_;  // last: it uses the others
};

}  // namespace tet
