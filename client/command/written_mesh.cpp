#include "client/command/written_mesh.h"

#include <utility>

#include "core/mesh/regions.h"

namespace tet {

absl::StatusOr<TakePart> WrittenMesh::choose_taker(const MeshHeader& header) {
  const auto output = mesh_output(options_.output, options_.format);
  if (!output.ok()) return output.status();
  const bool wanted_afterwards = !options_.report.empty() || options_.order > 1 ||
                                 header.has_faces() || !header.labels.empty();
  if (wanted_afterwards || !PartsFile::has_format(output->format)) return TakePart();
  absl::StatusOr<PartsFile> file = PartsFile::create(*output, header, cancellation_);
  if (!file.ok()) return file.status();
  file_.emplace(*std::move(file));
  return [this](const TetMesh& part, const ChunkExtent& place) { return take(part, place); };
}

absl::Status WrittenMesh::take(const TetMesh& part, const ChunkExtent& place) {
  if (part.header.has_regions) tets_inside_ += count_tets(part, MeshRegion::kInside);
  return file_->put(part, place);
}

absl::Status WrittenMesh::finish(MadeMesh& made) {
  made.is_written = true;
  made.tets_inside = tets_inside_;
  return file_->commit();
}

}  // namespace tet
