#include "bench/load/stream_check.h"

#include <absl/strings/str_cat.h>

#include "client/library/chunk_message.h"
#include "proto/convert/chunk_numbers.h"
#include "proto/convert/counts.h"
#include "proto/wire/checksum.h"
#include "proto/wire/serialized.h"

namespace tet::load {
namespace {

namespace v1 = ::tetstream::v1;

std::uint64_t column_bytes_of(const ReceivedChunk& chunk) {
  std::uint64_t bytes = 0;
  for (const ReceivedChunk::Column& column : chunk.columns) bytes += column.size;
  return bytes;
}

std::uint64_t column_bytes_of(const v1::MeshChunk& chunk) {
  std::uint64_t bytes = chunk.compact().size() + chunk.packed().size();
  for (const std::string_view column : columns_of(chunk)) bytes += column.size();
  return bytes;
}

std::uint32_t checksum_of(const v1::MeshChunk& chunk) {
  if (!chunk.compact().empty()) return chunk_checksum({chunk.compact()});
  if (!chunk.packed().empty()) return chunk_checksum({chunk.packed()});
  return chunk_checksum(columns_of(chunk));
}

}  // namespace

absl::Status StreamCheck::take(grpc::ByteBuffer& event) {
  if (const auto chunk = read_chunk(event)) {
    const absl::Status status = take_chunk(chunk->numbers, column_bytes_of(*chunk));
    if (!status.ok() || !check_columns_) return status;
    return check_columns(chunk->numbers, columns_checksum(event, *chunk));
  }
  v1::MeshEvent message;
  if (!deserialize(event, message))
    return absl::DataLossError("a message that is no MeshEvent");
  return take(message);
}

absl::Status StreamCheck::take(const v1::MeshEvent& event) {
  switch (event.event_case()) {
    case v1::MeshEvent::kHeader:
      has_header_ = true;
      chunk_count_ = unsigned_count(event.header().chunk_count());
      tet_count_ = unsigned_count(event.header().tet_count());
      return absl::OkStatus();
    case v1::MeshEvent::kChunk: {
      const v1::MeshChunk& chunk = event.chunk();
      const absl::Status status = take_chunk(from_proto(chunk), column_bytes_of(chunk));
      if (!status.ok() || !check_columns_) return status;
      return check_columns(from_proto(chunk), checksum_of(chunk));
    }
    case v1::MeshEvent::kTrailer:
      has_trailer_ = true;
      return ended();
    default:
      return absl::OkStatus();  // progress, or news from a newer server
  }
}

absl::Status StreamCheck::take_chunk(const ChunkNumbers& chunk, std::uint64_t column_bytes) {
  if (!has_header_) return absl::DataLossError("a chunk came before the header");
  if (chunk.index != next_chunk_ || chunk.first_tet != next_tet_) {
    return absl::DataLossError(absl::StrCat("chunk ", chunk.index, " is out of place"));
  }
  ++next_chunk_;
  next_tet_ += chunk.tet_count;
  column_bytes_ += column_bytes;
  return absl::OkStatus();
}

absl::Status StreamCheck::check_columns(const ChunkNumbers& chunk,
                                        std::uint32_t checksum) const {
  if (chunk.checksum == checksum) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("chunk ", chunk.index, " has a wrong checksum"));
}

absl::Status StreamCheck::ended() const {
  if (has_trailer_ && next_chunk_ == chunk_count_ && next_tet_ == tet_count_) {
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat("the stream ended after ", next_chunk_, " of ",
                                          chunk_count_, " chunks and ", next_tet_, " of ",
                                          tet_count_, " tets"));
}

}  // namespace tet::load
