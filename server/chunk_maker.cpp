#include "server/chunk_maker.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/wire/checksum.h"
#include "proto/wire/chunk_frame.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace {

namespace v1 = ::tetstream::v1;

using Held = std::shared_ptr<SendBudget::Lease>;

std::uint32_t checksum_of(const ChunkColumns& columns) {
  const auto text = [](std::span<const std::byte> bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  return chunk_checksum({text(columns.positions), text(columns.tets), text(columns.regions),
                         text(columns.fields)});
}

ChunkMessage make_columns(const ChunkSource& source,
                          std::uint64_t index,
                          ChunkMemory memory,
                          Held held) {
  const MeshPlan& plan = *source.plan;
  const ChunkExtent extent = source.patch ? source.patch->extent(index) : plan.chunk(index);
  const ChunkSizes size(plan.header(), extent.vertex_count, extent.tet_count);
  const ChunkFrame frame({size.positions, size.tets, size.regions, size.fields});
  const grpc::Slice slice = memory.blocks.take(frame.block_bytes(), std::move(held));
  auto* const block = reinterpret_cast<std::byte*>(const_cast<std::uint8_t*>(slice.begin()));
  const ChunkColumns columns{frame.positions(block), frame.tets(block), frame.regions(block),
                             frame.fields(block)};

  ChunkMessage message;
  {
    const ScratchPool<MeshWorkspace>::Turn workspace(memory.workspaces);
    message.quality = source.patch ? source.patch->fill(index, *workspace, columns)
                                   : plan.fill_chunk(index, *workspace, columns);
  }
  const auto parts =
      frame.write(block, {index, extent.first_vertex, extent.vertex_count, extent.first_tet,
                          extent.tet_count, checksum_of(columns)});
  std::vector<grpc::Slice> slices;
  for (const ChunkFrame::Part& part : parts) {
    if (part.end > part.begin) slices.push_back(slice.sub(part.begin, part.end));
  }
  message.event = grpc::ByteBuffer(slices.data(), slices.size());
  message.tets = extent.tet_count;
  message.bytes = size.total();
  return message;
}

ChunkMessage make_compact(const MeshPlan& plan,
                          std::uint64_t index,
                          ChunkMemory memory,
                          Held held) {
  const ChunkExtent extent = plan.chunk(index);
  std::vector<std::byte> bytes;
  plan.encode_chunk(index, *ScratchPool<MeshWorkspace>::Turn(memory.workspaces), bytes);

  v1::MeshEvent event;
  v1::MeshChunk& chunk = *event.mutable_chunk();
  chunk.set_index(static_cast<std::int64_t>(index));
  chunk.set_first_vertex(static_cast<std::int64_t>(extent.first_vertex));
  chunk.set_vertex_count(static_cast<std::int64_t>(extent.vertex_count));
  chunk.set_first_tet(static_cast<std::int64_t>(extent.first_tet));
  chunk.set_tet_count(static_cast<std::int64_t>(extent.tet_count));
  chunk.set_checksum(add_to_checksum(0, bytes));
  chunk.set_compact(bytes.data(), bytes.size());
  held->shrink_to(bytes.size());
  ChunkMessage message;
  message.event = serialized(event, std::move(held));
  message.tets = extent.tet_count;
  message.bytes = bytes.size();
  return message;
}

}  // namespace

std::uint64_t ChunkSource::chunk_count() const {
  return patch ? patch->patch_count() : plan->header().chunk_count;
}

ChunkMessage make_chunk(const ChunkSource& source,
                        std::uint64_t index,
                        ChunkMemory memory,
                        std::shared_ptr<SendBudget::Lease> held) {
  return source.compact ? make_compact(*source.plan, index, memory, std::move(held))
                        : make_columns(source, index, memory, std::move(held));
}

}  // namespace tet
