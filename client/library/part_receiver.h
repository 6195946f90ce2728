// Chunks of a mesh that is nowhere whole: each is handed on as it comes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/support/byte_buffer.h>

#include "client/library/reused_chunk.h"
#include "core/mesh/tet_mesh.h"
#include "proto/wire/chunk_frame.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Takes a chunk: its vertices and tets as a mesh, whose ids are the whole mesh's, and where in
/// that it belongs. Only during the call.
using PartSink = std::function<absl::Status(const TetMesh& part, const ChunkExtent& place)>;

/// Receives chunks [first, end) in their order from as many streams as it takes, and keeps
/// none. What it hands on was checked as MeshReceiver checks it. Not thread-safe.
class PartReceiver {
 public:
  /// Receives chunks of the mesh that `header` and `mesh_id` belong to.
  PartReceiver(const MeshHeader& header,
               std::string mesh_id,
               std::uint64_t first,
               std::uint64_t end,
               PartSink sink);

  /// Errors: kDataLoss (saying what does not fit), those of the sink.
  absl::Status take(grpc::ByteBuffer& event);

  /// The first chunk that is missing.
  std::uint64_t next_chunk() const noexcept { return next_; }
  std::uint64_t end_chunk() const noexcept { return end_; }
  bool complete() const noexcept { return next_ == end_; }

  /// The chunk that was handed on last: it stays as it is while the result lives.
  std::shared_ptr<const TetMesh> kept() const noexcept { return part_.kept(); }

  /// What the chunks that came cover, without gaps.
  const ChunkExtent& covered() const noexcept { return covered_; }

 private:
  using ColumnBytes = std::array<std::size_t, kMeshColumns>;

  absl::Status take(const v1::MeshEvent& event);
  absl::Status take_chunk(const v1::MeshChunk& chunk);
  absl::Status check_place(const ChunkNumbers& chunk) const;
  /// Makes room for the chunk's columns, if they have these sizes.
  absl::Status size_part(const ChunkNumbers& chunk, const ColumnBytes& columns);
  absl::Status hand_on(const ChunkNumbers& chunk, std::uint32_t checksum);

  const MeshHeader header_;
  const std::string mesh_id_;
  const std::uint64_t end_;
  const PartSink sink_;
  std::uint64_t next_;
  ReusedChunk part_;  ///< of the chunk that is being taken
  ChunkExtent covered_;
  bool any_ = false;  ///< a chunk has come
};

}  // namespace tet
