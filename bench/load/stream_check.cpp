#include "bench/load/stream_check.h"

#include <absl/strings/str_cat.h>

#include "proto/wire/checksum.h"

namespace tet::load {

namespace v1 = ::tetstream::v1;

absl::Status StreamCheck::take(const v1::MeshEvent& event) {
  switch (event.event_case()) {
    case v1::MeshEvent::kHeader:
      has_header_ = true;
      chunk_count_ = event.header().chunk_count();
      tet_count_ = event.header().tet_count();
      return absl::OkStatus();
    case v1::MeshEvent::kChunk:
      return take_chunk(event.chunk());
    case v1::MeshEvent::kTrailer:
      has_trailer_ = true;
      return ended();
    default:
      return absl::OkStatus();  // progress, or news from a newer server
  }
}

absl::Status StreamCheck::take_chunk(const v1::MeshChunk& chunk) {
  if (!has_header_) return absl::DataLossError("a chunk came before the header");
  if (chunk.index() != next_chunk_ || chunk.first_tet() != next_tet_) {
    return absl::DataLossError(absl::StrCat("chunk ", chunk.index(), " is out of place"));
  }
  ++next_chunk_;
  next_tet_ += chunk.tet_count();
  if (check_columns_ &&
      chunk.checksum() != chunk_checksum(chunk.positions(), chunk.tets(), chunk.regions())) {
    return absl::DataLossError(absl::StrCat("chunk ", chunk.index(), " has a wrong checksum"));
  }
  return absl::OkStatus();
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
