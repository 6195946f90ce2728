#include "client/library/mesh_receiver.h"

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/parallel.h"
#include "core/plan/make/fill_mesh.h"

namespace tet {

absl::Status MeshInMemory::make_room(const MeshHeader& header, const KeptParts* kept) {
  if (mesh_.header.tet_count > 0) used_ = std::exchange(mesh_, TetMesh());  // all comes anew
  if (kept != nullptr) {
    absl::StatusOr<TetMesh> mesh = absl::InternalError("not made");
    TaskPool pool;
    pool.run([&] { mesh = splice_mesh(*base_, header, *kept, std::move(used_)); });
    if (!mesh.ok()) return mesh.status();
    mesh_ = *std::move(mesh);
    loose_ = kept->loose;
    if (loose_) {
      new_vertices_ = RowQueue::beside(kept->vertices, header.vertex_count);
      new_tets_ = RowQueue::beside(kept->tets, header.tet_count);
    }
    return absl::OkStatus();
  }
  try {
    mesh_ = TetMesh(header, std::move(used_));
    return absl::OkStatus();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "no memory for ", header.vertex_count, " vertices and ", header.tet_count, " tets"));
  }
}

absl::StatusOr<ChunkColumns> MeshInMemory::place(const ChunkExtent& chunk) {
  if (!loose_) return mesh_.columns_of(chunk);
  chunk_ = TetMesh(header_of_chunk(mesh_.header, chunk), std::move(chunk_));
  return chunk_.columns();
}

absl::Status MeshInMemory::take(const ChunkExtent& chunk) {
  if (!loose_) return absl::OkStatus();
  const MeshHeader& header = mesh_.header;
  const auto copy = [](const ByteBuffer& from, ByteBuffer& to, std::size_t row_bytes) {
    return [&from, &to, row_bytes](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      if (count * row_bytes == 0) return;
      std::memcpy(to.bytes().data() + row * row_bytes, from.bytes().data() + at * row_bytes,
                  count * row_bytes);
    };
  };
  const auto vertices =
      copy(chunk_.positions, mesh_.positions, 3 * size_of(header.coordinate_type));
  const auto tets = copy(chunk_.tets, mesh_.tets, 4 * size_of(header.index_type));
  const auto regions = copy(chunk_.regions, mesh_.regions, header.region_bytes());
  const bool fits = new_vertices_.take(chunk.vertex_count, vertices) &&
                    new_tets_.take(chunk.tet_count, [&](auto row, auto at, auto count) {
                      tets(row, at, count);
                      regions(row, at, count);
                    });
  return fits ? absl::OkStatus()
              : absl::InvalidArgumentError("a chunk has more than what is new");
}

absl::StatusOr<StreamedMesh> MeshReceiver::finish(const Cancellation& cancellation) && {
  const Statistics statistics = reader_.statistics();
  StreamedMesh received = std::move(reader_.told());
  if (reader_.compact()) {
    absl::StatusOr<FilledMesh> filled =
        std::move(*reader_.compact())
            .finish(received.mesh.header, cancellation, mesh_->take_used(), statistics);
    if (!filled.ok()) return filled.status();
    received.mesh = std::move(filled->mesh);
    received.quality = filled->quality;
    return received;
  }
  received.mesh = mesh_->take_mesh();
  if (!reader_.has_quality() && statistics == Statistics::kMeasured) {
    received.quality = measure_quality(received.mesh);
  }
  return received;
}

}  // namespace tet
