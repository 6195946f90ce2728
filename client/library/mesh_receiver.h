// Stream events in, a mesh in memory out.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/mesh_client.h"
#include "client/library/stream_reader.h"
#include "core/mesh/stable/row_queue.h"

namespace tet {

/// The consumer that keeps every chunk where it belongs in the mesh.
class MeshInMemory : public ChunkConsumer {
 public:
  /// `base`, which may be null, outlives this.
  MeshInMemory(const TetMesh* base, TetMesh used) : base_(base), used_(std::move(used)) {}

  absl::Status make_room(const MeshHeader& header, const KeptParts* kept) override;
  absl::StatusOr<ChunkColumns> place(const ChunkExtent& chunk) override;
  absl::Status take(const ChunkExtent& chunk) override;

  TetMesh take_mesh() { return std::move(mesh_); }
  TetMesh take_used() { return std::move(used_); }

 private:
  const TetMesh* base_;
  TetMesh used_, mesh_;
  // Where kept parts are loose: what comes next, and the chunk that is received.
  RowQueue new_vertices_, new_tets_;
  TetMesh chunk_;
  bool loose_ = false;
};

/// Collects one mesh from as many streams as it takes. Not thread-safe.
class MeshReceiver {
 public:
  /// `base`, which may be null, is the mesh that the request names as its base; it must outlive
  /// this. The mesh is made in the memory of `used`, as far as that is enough. `loose` says
  /// whether patches may be that: see KeptParts.
  explicit MeshReceiver(const TetMesh* base = nullptr, TetMesh used = {}, bool loose = false)
      : mesh_(std::make_unique<MeshInMemory>(base, std::move(used))),
        reader_(*mesh_,
                base == nullptr ? StreamReader::Base::kNone
                : loose         ? StreamReader::Base::kFrame
                                : StreamReader::Base::kNamed) {}

  /// See StreamReader.
  void use_shared(SharedChunks& shared, const Cancellation& cancellation) noexcept {
    reader_.use_shared(shared, cancellation);
  }

  /// Errors: kDataLoss (saying what does not fit), kUnavailable (see StreamReader),
  /// kResourceExhausted (no memory for the mesh).
  absl::Status take(const v1::MeshEvent& event) { return reader_.take(event); }
  /// Takes an event as it came: a chunk goes into the mesh without another copy.
  absl::Status take(grpc::ByteBuffer& event) { return reader_.take(event); }

  /// How far planning is, if the last event said that.
  const std::optional<v1::MeshProgress>& planning() const noexcept {
    return reader_.planning();
  }

  /// Whether the header said that nothing is kept of a base.
  bool is_sent_whole() const noexcept { return reader_.is_sent_whole(); }
  /// The first chunk that is missing.
  std::uint64_t next_chunk() const noexcept { return reader_.next_chunk(); }
  const std::string& mesh_id() const noexcept { return reader_.told().mesh_id; }
  std::uint64_t tets_received() const noexcept { return reader_.tets_received(); }
  /// Tets of the chunks that came, without those kept from the base.
  std::uint64_t tets_sent() const noexcept { return reader_.tets_sent(); }
  std::uint64_t tet_count() const noexcept { return reader_.told().mesh.header.tet_count; }
  /// Every chunk is here and the server has said that there are no more.
  bool complete() const noexcept { return reader_.complete(); }

  /// See StreamReader.
  const absl::Status& refusal() const noexcept { return reader_.refusal(); }
  /// The memory that it was given, of which a refused frame needs nothing.
  TetMesh take_used() && { return mesh_->take_used(); }

  /// The mesh, once complete. Statistics are measured here unless one stream brought them all.
  /// Errors: those of CompactReceiver::finish.
  absl::StatusOr<StreamedMesh> finish(const Cancellation& cancellation) &&;

 private:
  std::unique_ptr<MeshInMemory> mesh_;
  StreamReader reader_;
};

}  // namespace tet
