#include "client/command/mesh/written_mesh.h"

#include <utility>

#include "core/mesh/regions.h"

namespace tet {

void WrittenMesh::ask_for_faces(const Shape& shape, MeshRequest& request) {
  const auto output = mesh_output(options_.output, options_.format);
  // A mesh that has faces of several names, or tets of several, is written once it is whole;
  // what improves it needs it whole, too.
  const bool is_plain = !request.labels && !request.improve && !request.box &&
                        request.preset != Preset::kBothSides && grids_of(shape) == nullptr &&
                        labels_of(shape) == nullptr;
  faces_are_ours_ = output.ok() && output->format == MeshFormat::kMsh && !request.faces &&
                    is_plain && !is_wanted_whole();
  if (faces_are_ours_) request.faces = true;
}

absl::StatusOr<TakePart> WrittenMesh::choose_taker(const MeshHeader& header) {
  const auto output = mesh_output(options_.output, options_.format);
  if (!output.ok()) return output.status();
  const bool wanted_afterwards =
      is_wanted_whole() || !header.labels.empty() || (header.has_faces() && !faces_are_ours_);
  if (wanted_afterwards || !PartsFile::takes(output->format, header)) return TakePart();
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
  if (faces_are_ours_) {
    made.mesh.header.face_labels.clear();
    made.mesh.header.face_count = 0;
  }
  return file_->commit();
}

}  // namespace tet
