#include "client/mesh_receiver.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/wire/checksum.h"

namespace tet {

namespace {

// Beyond any mesh that fits a machine, and small enough that sizes in bytes do not overflow.
constexpr std::int64_t kMaxCount = std::int64_t{1} << 48;

bool is_count(std::int64_t count) { return 0 <= count && count <= kMaxCount; }

WorldPoint to_core(const v1::Point& point) { return {point.x(), point.y(), point.z()}; }

std::uint64_t unsigned_count(std::int64_t count) { return static_cast<std::uint64_t>(count); }

absl::Status bad_stream(const std::string& message) {
  return absl::DataLossError(absl::StrCat("the server's stream is broken: ", message));
}

MeshHeader to_core(const v1::MeshHeader& message) {
  MeshHeader header;
  header.vertex_count = unsigned_count(message.vertex_count());
  header.tet_count = unsigned_count(message.tet_count());
  header.chunk_count = unsigned_count(message.chunk_count());
  header.coordinate_type = message.coordinate_type() == v1::COORDINATE_TYPE_FLOAT64
                               ? CoordinateType::kFloat64
                               : CoordinateType::kFloat32;
  header.index_type =
      message.index_type() == v1::INDEX_TYPE_UINT64 ? IndexType::kUint64 : IndexType::kUint32;
  header.origin = to_core(message.origin());
  header.bounds = {to_core(message.bounds().min()), to_core(message.bounds().max())};
  header.spacing = message.spacing();
  header.levels = message.levels();
  header.has_regions = message.has_regions();
  return header;
}

bool is_valid(const v1::MeshHeader& header) {
  return is_count(header.vertex_count()) && is_count(header.tet_count()) &&
         is_count(header.chunk_count()) &&
         header.coordinate_type() != v1::COORDINATE_TYPE_UNSPECIFIED &&
         v1::CoordinateType_IsValid(header.coordinate_type()) &&
         header.index_type() != v1::INDEX_TYPE_UNSPECIFIED &&
         v1::IndexType_IsValid(header.index_type());
}

void copy(const std::string& from, std::span<std::byte> to) {
  if (!to.empty()) std::memcpy(to.data(), from.data(), to.size());
}

}  // namespace

absl::Status MeshReceiver::take(const v1::MeshEvent& event) {
  switch (event.event_case()) {
    case v1::MeshEvent::kHeader:
      return take_header(event.header());
    case v1::MeshEvent::kChunk:
      return take_chunk(event.chunk());
    case v1::MeshEvent::kTrailer:
      return take_trailer(event.trailer());
    default:
      return absl::OkStatus();  // progress, or news from a newer server
  }
}

absl::Status MeshReceiver::take_header(const v1::MeshHeader& header) {
  if (!is_valid(header)) return bad_stream("a header with impossible values");
  if (has_header_) {
    return header.mesh_id() == received_.mesh_id ? absl::OkStatus()
                                                 : bad_stream("another mesh after resuming");
  }
  try {
    received_.mesh = TetMesh(to_core(header));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat("no memory for ", header.vertex_count(),
                                                     " vertices and ", header.tet_count(),
                                                     " tets"));
  }
  received_.mesh_id = header.mesh_id();
  received_.canonical_request = header.canonical_request();
  has_header_ = true;
  return absl::OkStatus();
}

absl::Status MeshReceiver::take_chunk(const v1::MeshChunk& chunk) {
  if (!has_header_) return bad_stream("a chunk before the header");
  if (!is_count(chunk.vertex_count()) || !is_count(chunk.tet_count())) {
    return bad_stream("a chunk with impossible counts");
  }
  const ChunkExtent extent{next_vertex_, unsigned_count(chunk.vertex_count()), next_tet_,
                           unsigned_count(chunk.tet_count())};
  const MeshHeader& header = received_.mesh.header;
  if (unsigned_count(chunk.index()) != next_chunk_ ||
      unsigned_count(chunk.first_vertex()) != next_vertex_ ||
      unsigned_count(chunk.first_tet()) != next_tet_ ||
      extent.vertex_count > header.vertex_count - next_vertex_ ||
      extent.tet_count > header.tet_count - next_tet_) {
    return bad_stream(absl::StrCat("chunk ", chunk.index(), " is out of place"));
  }
  const ChunkColumns columns = received_.mesh.columns_of(extent);
  if (chunk.positions().size() != columns.positions.size() ||
      chunk.tets().size() != columns.tets.size() ||
      chunk.regions().size() != columns.regions.size() ||
      chunk_checksum(chunk.positions(), chunk.tets(), chunk.regions()) != chunk.checksum()) {
    return bad_stream(absl::StrCat("chunk ", chunk.index(), " has a wrong checksum or size"));
  }
  copy(chunk.positions(), columns.positions);
  copy(chunk.tets(), columns.tets);
  copy(chunk.regions(), columns.regions);
  next_vertex_ += extent.vertex_count;
  next_tet_ += extent.tet_count;
  ++next_chunk_;
  return absl::OkStatus();
}

absl::Status MeshReceiver::take_trailer(const v1::MeshTrailer& trailer) {
  const MeshHeader& header = received_.mesh.header;
  if (!has_header_ || next_chunk_ != header.chunk_count ||
      next_vertex_ != header.vertex_count || next_tet_ != header.tet_count) {
    return bad_stream("it ended before the mesh was whole");
  }
  complete_ = true;
  const v1::QualityStats& quality = trailer.quality();
  has_quality_ = trailer.first_chunk() == 0 &&
                 unsigned_count(trailer.end_chunk()) == header.chunk_count &&
                 quality.dihedral_histogram_size() == QualityStats::kBins;
  if (!has_quality_) return absl::OkStatus();
  received_.quality.min_dihedral_deg = quality.min_dihedral_deg();
  received_.quality.max_dihedral_deg = quality.max_dihedral_deg();
  received_.quality.volume = quality.volume();
  std::transform(quality.dihedral_histogram().begin(), quality.dihedral_histogram().end(),
                 received_.quality.histogram.begin(), unsigned_count);
  return absl::OkStatus();
}

StreamedMesh MeshReceiver::finish() && {
  if (!has_quality_) received_.quality = measure_quality(received_.mesh);
  return std::move(received_);
}

}  // namespace tet
