#include "core/transfer/mesh_patch.h"

#include <utility>

namespace tet {
namespace {

/// Cuts ranges of bricks so that each stays within a chunk's bytes, if it is more than one
/// brick.
std::vector<BrickRange> within_chunk_size(const std::vector<BrickRange>& ranges,
                                          const BrickPlan& plan) {
  std::vector<BrickRange> cut;
  for (const BrickRange& range : ranges) {
    cut.push_back({range.begin, range.begin});
    for (std::size_t brick = range.begin; brick < range.end; ++brick) {
      const ChunkExtent extent = plan.bricks({cut.back().begin, brick + 1});
      const ChunkSizes sizes(plan.header(), extent);
      if (sizes.total() > kChunkBytes && brick > cut.back().begin)
        cut.push_back({brick, brick});
      cut.back().end = brick + 1;
    }
  }
  // Bricks that only own what is kept, or nothing, need no message.
  std::erase_if(cut, [&](const BrickRange& range) {
    const ChunkExtent extent = plan.bricks(range);
    return extent.vertex_count == 0 && extent.tet_count == 0;
  });
  return cut;
}

}  // namespace

std::shared_ptr<const MeshPatch> MeshPatch::between(
    const std::shared_ptr<const BrickPlan>& earlier, std::shared_ptr<const BrickPlan> mesh) {
  if (earlier == nullptr || mesh == nullptr) return nullptr;
  const ComparedMesh before = earlier->counted(), now = mesh->counted();
  // Whether a field's values changed, too, nobody has compared.
  if (!can_splice(earlier->header(), mesh->header()) ||
      before.mesh.rules() != now.mesh.rules()) {
    return nullptr;
  }
  MeshDifference difference = compare_meshes(before, now);
  difference.changed = within_chunk_size(difference.changed, *mesh);
  return std::shared_ptr<const MeshPatch>(
      new MeshPatch(std::move(mesh), std::move(difference)));
}

MeshPatch::MeshPatch(std::shared_ptr<const BrickPlan> mesh, MeshDifference difference)
    : mesh_(std::move(mesh)), difference_(std::move(difference)) {}

ChunkExtent MeshPatch::extent(std::uint64_t patch) const noexcept {
  return mesh_->bricks(difference_.changed[patch]);
}

QualityStats MeshPatch::fill(std::uint64_t patch,
                             MeshWorkspace& workspace,
                             ChunkColumns columns) const noexcept {
  return mesh_->fill_bricks(difference_.changed[patch], workspace, columns);
}

}  // namespace tet
