#include "server/meshing/chunk_maker.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/plan/fill_watch.h"
#include "core/transfer/compact_chunk.h"
#include "core/transfer/mesh_patch.h"
#include "proto/convert/chunk_numbers.h"
#include "proto/wire/checksum.h"
#include "proto/wire/chunk_frame.h"
#include "proto/wire/serialized.h"

namespace tet {

namespace {

using Held = std::shared_ptr<SendBudget::Lease>;

/// Where a frame has its columns.
ChunkColumns columns_in(const ChunkFrame& frame, std::byte* block) {
  const auto column = [&](std::size_t i) { return frame.column(block, i); };
  return {column(0), column(1), column(2), column(3), column(4), column(5), column(6)};
}

/// Columns as they are: each is sent from where it was made in `block`.
grpc::ByteBuffer plain_event(const ChunkFrame& frame,
                             const grpc::Slice& slice,
                             std::byte* block,
                             const ChunkNumbers& numbers) {
  std::vector<grpc::Slice> slices;
  for (const ChunkFrame::Part& part : frame.write(block, numbers)) {
    if (part.end > part.begin) slices.push_back(slice.sub(part.begin, part.end));
  }
  return {slices.data(), slices.size()};
}

/// A chunk as protobuf writes it, without what it holds.
v1::MeshChunk chunk_of(const ChunkNumbers& numbers) {
  v1::MeshChunk chunk;
  to_proto(numbers, chunk);
  return chunk;
}

/// `bytes` are in the chunk.
grpc::ByteBuffer encoded_event(v1::MeshChunk chunk, std::size_t bytes, Held held) {
  v1::MeshEvent event;
  *event.mutable_chunk() = std::move(chunk);
  held->shrink_to(bytes);
  return serialized(event, std::move(held));
}

absl::StatusOr<ChunkMessage> make_columns(const ChunkSource& source,
                                          std::uint64_t index,
                                          ChunkMemory memory,
                                          const Held& held,
                                          const Cancellation& cancellation) {
  const MeshPlan& plan = *source.plan;
  const ChunkExtent extent = source.extent(index);
  const ChunkSizes size(plan.header(), extent);
  const ChunkFrame frame(size.all());
  const grpc::Slice slice = memory.blocks.take(frame.block_bytes(), held);
  auto* const block = reinterpret_cast<std::byte*>(const_cast<std::uint8_t*>(slice.begin()));
  const ChunkColumns columns = columns_in(frame, block);

  ChunkMessage message;
  message.tets = extent.tet_count;
  auto quality = fill_columns(source, index, memory, columns, cancellation);
  if (!quality.ok()) return quality.status();
  message.quality = *std::move(quality);
  if (source.encoding == v1::ENCODING_PACKED) {
    const ScratchPool<ChunkPacker>::Turn packer(memory.packers);
    const auto packed = packer->pack(plan.header(), extent, columns);
    if (!packed.empty()) {
      v1::MeshChunk chunk = chunk_of(numbers_of(index, extent, add_to_checksum(0, packed)));
      chunk.set_packed(packed.data(), packed.size());
      message.event = encoded_event(std::move(chunk), packed.size(), held);
      message.bytes = packed.size();
      return message;
    }
  }
  message.event =
      plain_event(frame, slice, block, numbers_of(index, extent, checksum_of(columns)));
  message.bytes = size.total();
  return message;
}

absl::StatusOr<ChunkMessage> make_compact(const BrickPlan& plan,
                                          std::uint64_t index,
                                          ChunkMemory memory,
                                          Held held,
                                          const Cancellation& cancellation) {
  const ChunkExtent extent = plan.chunk(index);
  std::vector<std::byte> bytes;
  {
    const ScratchPool<MeshWorkspace>::Turn workspace(memory.workspaces);
    const WatchedFill watched(*workspace, cancellation);
    encode_chunk(plan, index, *workspace, bytes);
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  }

  v1::MeshChunk chunk = chunk_of(numbers_of(index, extent, add_to_checksum(0, bytes)));
  chunk.set_compact(bytes.data(), bytes.size());
  ChunkMessage message;
  message.event = encoded_event(std::move(chunk), bytes.size(), std::move(held));
  message.tets = extent.tet_count;
  message.bytes = bytes.size();
  return message;
}

}  // namespace

std::uint32_t checksum_of(const ChunkColumns& columns) {
  std::uint32_t checksum = 0;
  for (const std::span<std::byte> column : columns.all()) {
    checksum = add_to_checksum(checksum, column);
  }
  return checksum;
}

ChunkNumbers numbers_of(std::uint64_t index,
                        const ChunkExtent& extent,
                        std::uint32_t checksum) {
  return {.index = index,
          .first_vertex = extent.first_vertex,
          .vertex_count = extent.vertex_count,
          .first_tet = extent.first_tet,
          .tet_count = extent.tet_count,
          .checksum = checksum,
          .first_face = extent.first_face,
          .face_count = extent.face_count};
}

absl::StatusOr<QualityStats> fill_columns(const ChunkSource& source,
                                          std::uint64_t index,
                                          ChunkMemory memory,
                                          const ChunkColumns& columns,
                                          const Cancellation& cancellation) {
  const ScratchPool<MeshWorkspace>::Turn workspace(memory.workspaces);
  const WatchedFill watched(*workspace, cancellation);
  QualityStats quality = source.patch ? source.patch->fill(index, *workspace, columns)
                                      : source.plan->fill_chunk(index, *workspace, columns);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return quality;
}

ChunkExtent ChunkSource::extent(std::uint64_t index) const {
  return patch ? patch->extent(index) : plan->chunk(index);
}

std::uint64_t ChunkSource::chunk_count() const {
  return patch ? patch->patch_count() : plan->header().chunk_count;
}

const BrickPlan& ChunkSource::bricks() const {
  const BrickPlan* bricks = as_bricks(*plan);
  TET_CHECK(bricks != nullptr);
  return *bricks;
}

absl::StatusOr<ChunkMessage> make_chunk(const ChunkSource& source,
                                        std::uint64_t index,
                                        ChunkMemory memory,
                                        std::shared_ptr<SendBudget::Lease> held,
                                        const Cancellation& cancellation) {
  return source.encoding == v1::ENCODING_COMPACT
             ? make_compact(source.bricks(), index, memory, std::move(held), cancellation)
             : make_columns(source, index, memory, held, cancellation);
}

}  // namespace tet
