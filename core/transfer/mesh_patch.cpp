#include "core/transfer/mesh_patch.h"

#include <cstdint>
#include <utility>

namespace tet {

std::shared_ptr<const MeshPatch> MeshPatch::between(
    const std::shared_ptr<const BrickPlan>& earlier,
    std::shared_ptr<const BrickPlan> mesh,
    const Cancellation& cancellation,
    PatchDetail detail,
    PatchLimits limits) {
  if (earlier == nullptr || mesh == nullptr) return nullptr;
  const ComparedMesh before = earlier->counted(), now = mesh->counted();
  // Whether a field's values changed, too, nobody has compared.
  // And the same place of the world may be another of the lattice, where a grid was moved.
  if (!can_splice(earlier->header(), mesh->header()) ||
      before.mesh.rules() != now.mesh.rules() || earlier->to_world() != mesh->to_world()) {
    return nullptr;
  }
  auto difference = compare_meshes({before, now, detail, cancellation}, limits);
  if (!difference) return nullptr;
  return std::shared_ptr<const MeshPatch>(
      new MeshPatch(std::move(mesh), *std::move(difference)));
}

MeshPatch::MeshPatch(std::shared_ptr<const BrickPlan> mesh, MeshDifference difference)
    : mesh_(std::move(mesh)), difference_(std::move(difference)), new_(difference_) {
  difference_.changed = within_chunk_size();
}

/// Cuts the ranges of changed bricks so that each stays within a chunk's bytes, if it is more
/// than one brick.
std::vector<BrickRange> MeshPatch::within_chunk_size() const {
  std::vector<BrickRange> cut;
  for (const BrickRange& range : difference_.changed) {
    cut.push_back({range.begin, range.begin});
    for (std::size_t brick = range.begin; brick < range.end; ++brick) {
      const ChunkSizes sizes(mesh_->header(), extent_of({cut.back().begin, brick + 1}));
      if (sizes.total() > kChunkBytes && brick > cut.back().begin)
        cut.push_back({brick, brick});
      cut.back().end = brick + 1;
    }
  }
  // Bricks that only own what is kept, or nothing, need no message.
  std::erase_if(cut, [&](const BrickRange& range) {
    const ChunkExtent extent = extent_of(range);
    return extent.vertex_count == 0 && extent.tet_count == 0;
  });
  return cut;
}

ChunkExtent MeshPatch::extent_of(const BrickRange& bricks) const noexcept {
  const ChunkExtent whole = mesh_->bricks(bricks);
  return kept().loose ? new_.within(whole) : whole;
}

ChunkExtent MeshPatch::extent(std::uint64_t patch) const noexcept {
  return extent_of(difference_.changed[patch]);
}

QualityStats MeshPatch::fill(std::uint64_t patch,
                             MeshWorkspace& workspace,
                             ChunkColumns columns) const noexcept {
  const BrickRange& bricks = difference_.changed[patch];
  return kept().loose ? mesh_->fill_new(bricks, new_, workspace, columns)
                      : mesh_->fill_bricks(bricks, workspace, columns);
}

}  // namespace tet
