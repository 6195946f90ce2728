// A chunk of a counted mesh, as the message that carries it.
#pragma once

#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "core/base/cancel.h"
#include "core/base/scratch_pool.h"
#include "core/mesh/packed/packed_chunk.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_workspace.h"
#include "proto/wire/block_pool.h"
#include "proto/wire/chunk_frame.h"
#include "server/meshing/send_budget.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

class BrickPlan;
class MeshPatch;

namespace v1 = ::tetstream::v1;

/// What chunks are made from, and how they are written.
struct ChunkSource {
  std::shared_ptr<const MeshPlan> plan;
  std::shared_ptr<const MeshPatch> patch;  ///< null: of the whole mesh
  v1::Encoding encoding = v1::ENCODING_PLAIN;

  std::uint64_t chunk_count() const;
  /// Where a chunk lies within the mesh.
  ChunkExtent extent(std::uint64_t index) const;
  /// What compact chunks are made from: a request that asks for them of a mesh that has no
  /// bricks is refused before anything is planned.
  const BrickPlan& bricks() const;
};

struct ChunkMessage {
  grpc::ByteBuffer event;  ///< a MeshEvent
  QualityStats quality;    ///< nothing of a compact chunk
  std::uint64_t tets = 0;
  std::uint64_t bytes = 0;  ///< of its columns, or of what they are encoded as
};

/// Memory to make chunks with, and in.
struct ChunkMemory {
  ScratchPool<MeshWorkspace>& workspaces;
  ScratchPool<ChunkPacker>& packers;
  BlockPool& blocks;
};

/// Fills a chunk's columns. Looks at `cancellation` between bricks. Errors: kCancelled,
/// kDeadlineExceeded.
absl::StatusOr<QualityStats> fill_columns(const ChunkSource& source,
                                          std::uint64_t index,
                                          ChunkMemory memory,
                                          const ChunkColumns& columns,
                                          const Cancellation& cancellation);

std::uint32_t checksum_of(const ChunkColumns& columns);
ChunkNumbers numbers_of(std::uint64_t index, const ChunkExtent& extent, std::uint32_t checksum);

/// Makes chunk `index` < chunk_count(). A plain chunk's columns are made in the memory they are
/// sent from, within the protobuf bytes around them; packed ones are made there, too. `held`
/// lives as long as the message's bytes. Looks at `cancellation` between bricks: what was made
/// of a chunk until then is let go of. Errors: kCancelled, kDeadlineExceeded.
absl::StatusOr<ChunkMessage> make_chunk(const ChunkSource& source,
                                        std::uint64_t index,
                                        ChunkMemory memory,
                                        std::shared_ptr<SendBudget::Lease> held,
                                        const Cancellation& cancellation);

}  // namespace tet
