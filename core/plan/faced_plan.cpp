#include "core/plan/faced_plan.h"

#include <algorithm>
#include <utility>

namespace tet {
namespace {

MeshFacts facts_with_faces(const MeshPlan& plan, const MeshHeader& with_faces) {
  MeshFacts facts{.shape = plan.shape(),
                  .header = plan.header(),
                  .thin_walls = plan.thin_walls(),
                  .statistics = plan.statistics(),
                  .boundary = plan.boundary(),
                  .improvement = plan.improvement(),
                  .surface_bricks = plan.surface_bricks()};
  facts.header.face_labels = with_faces.face_labels;
  facts.header.face_count = with_faces.face_count;
  return facts;
}

TetMesh faces_alone(TetMesh mesh) {
  TetMesh faces;
  faces.header = std::move(mesh.header);
  faces.faces = std::move(mesh.faces);
  faces.face_tets = std::move(mesh.face_tets);
  faces.face_labels = std::move(mesh.face_labels);
  return faces;
}

void copy_rows_from(std::span<const std::byte> column,
                    std::size_t first,
                    std::span<std::byte> to) noexcept {
  std::ranges::copy(column.subspan(first, to.size()), to.begin());
}

}  // namespace

FacedPlan::FacedPlan(std::shared_ptr<const MeshPlan> faceless, TetMesh mesh)
    : MeshPlan(facts_with_faces(*faceless, mesh.header)),
      faceless_(std::move(faceless)),
      faces_(faces_alone(std::move(mesh))) {}

std::uint64_t FacedPlan::first_face_from(std::uint64_t tet) const noexcept {
  std::uint64_t begin = 0, end = faces_.header.face_count;
  while (begin < end) {
    const std::uint64_t middle = begin + (end - begin) / 2;
    faces_.face_tet(middle) < tet ? begin = middle + 1 : end = middle;
  }
  return begin;
}

ChunkExtent FacedPlan::chunk(std::uint64_t index) const noexcept {
  ChunkExtent extent = faceless_->chunk(index);
  extent.first_face = first_face_from(extent.first_tet);
  extent.face_count = first_face_from(extent.first_tet + extent.tet_count) - extent.first_face;
  return extent;
}

QualityStats FacedPlan::fill_chunk(std::uint64_t index,
                                   MeshWorkspace& workspace,
                                   ChunkColumns columns) const noexcept {
  const ChunkSizes before = ChunkSizes::before(header(), chunk(index));
  copy_rows_from(faces_.faces.bytes(), before.faces, columns.faces);
  copy_rows_from(faces_.face_tets.bytes(), before.face_tets, columns.face_tets);
  copy_rows_from(faces_.face_labels.bytes(), before.face_labels, columns.face_labels);
  columns.faces = columns.face_tets = columns.face_labels = {};
  return faceless_->fill_chunk(index, workspace, columns);
}

std::uint64_t FacedPlan::bytes() const noexcept {
  return faceless_->bytes() + faces_.faces.size() + faces_.face_tets.size() +
         faces_.face_labels.size();
}

}  // namespace tet
