#include "client/library/mesh_receiver.h"

#include <new>

#include <absl/strings/str_cat.h>

#include "core/base/parallel.h"
#include "core/plan/make/fill_mesh.h"

namespace tet {

absl::Status MeshInMemory::make_room(const MeshHeader& header, const KeptParts* kept) {
  if (kept != nullptr) {
    absl::StatusOr<TetMesh> mesh = absl::InternalError("not made");
    TaskPool pool;
    pool.run([&] { mesh = splice_mesh(*base_, header, *kept, std::move(used_)); });
    if (!mesh.ok()) return mesh.status();
    mesh_ = *std::move(mesh);
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
