#include "server/meshing/shared_chunk.h"

#include "proto/convert/chunk_numbers.h"
#include "proto/wire/serialized.h"
#include "proto/wire/shared_columns.h"

namespace tet {

absl::Status check_not_read_back(const ChunkSource& source) {
  if (!source.plan->improvement()) return absl::OkStatus();
  return absl::FailedPreconditionError("the mesh is improved");
}

absl::StatusOr<ChunkMessage> make_shared_chunk(const ChunkSource& source,
                                               std::uint64_t index,
                                               ChunkMemory memory,
                                               const ChunkRing& ring,
                                               const Cancellation& cancellation) {
  const ChunkExtent extent = source.extent(index);
  const ChunkSizes size(source.plan->header(), extent);
  const SharedColumns layout(size.all());
  if (layout.bytes() > ring.size().block_bytes) {
    return make_chunk(source, index, memory, nullptr, cancellation);
  }
  std::byte* const block = ring.block_of(index).data();
  const auto column = [&](std::size_t i) { return layout.column(block, i); };
  const ChunkColumns columns{column(0), column(1), column(2), column(3),
                             column(4), column(5), column(6)};
  ChunkMessage message;
  auto quality = fill_columns(source, index, memory, columns, cancellation);
  if (!quality.ok()) return quality.status();
  message.quality = *std::move(quality);
  message.tets = extent.tet_count;
  message.bytes = size.total();
  v1::MeshEvent event;
  to_proto(numbers_of(index, extent, checksum_of(columns)), *event.mutable_chunk());
  event.mutable_chunk()->set_shared_offset(static_cast<std::int64_t>(ring.offset_of(index)));
  message.event = serialized(event);
  return message;
}

}  // namespace tet
