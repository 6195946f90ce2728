#include "core/plan/make/divide_surface.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/mesh/crease_patches.h"
#include "core/plan/crease_labels.h"
#include "core/plan/creased_plan.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

absl::Status check_surface_budget(const MeshHeader& header, const MeshLimits& limits) {
  const ChunkSizes sizes(header, whole_of(header));
  const std::uint64_t bytes = sizes.positions + sizes.faces + sizes.face_labels +
                              header.face_count * kPatchBytesPerFace;
  if (bytes <= limits.max_plan_bytes && header.face_count <= kMostPatchedFaces) {
    return absl::OkStatus();
  }
  return absl::ResourceExhaustedError(absl::StrFormat(
      "dividing %d faces of %d vertices at creases would take %d bytes; the limit is %d. Use a "
      "larger spacing, or regions without creases",
      header.face_count, header.vertex_count, bytes, limits.max_plan_bytes));
}

/// Columns of a chunk that are made and let go of.
struct PassingColumns {
  MeshWorkspace workspace;
  std::vector<std::byte> tets, regions, face_tets;
};

/// Makes the faces of a plan's mesh, and the positions of their vertices.
class SurfaceMaker {
 public:
  SurfaceMaker(const MeshPlan& plan, const Cancellation& cancellation)
      : plan_(plan), cancellation_(cancellation) {
    surface_.header = plan.header();
    const ChunkSizes sizes(surface_.header, whole_of(surface_.header));
    surface_.positions = ByteBuffer(sizes.positions);
    surface_.faces = ByteBuffer(sizes.faces);
    surface_.face_labels = ByteBuffer(sizes.face_labels);
  }

  /// Some of it once cancelled.
  TetMesh make() {
    const std::uint64_t chunks = plan_.header().chunk_count;
    std::vector<std::uint64_t> with_faces, others;
    for (std::uint64_t i = 0; i < chunks; ++i) {
      if (plan_.chunk(i).face_count > 0) with_faces.push_back(i);
    }
    fill(with_faces);
    // Vertices of faces may be those of chunks without any.
    const std::vector<bool> needed = chunks_of_vertices();
    for (std::uint64_t i = 0; i < chunks; ++i) {
      if (needed[i] && plan_.chunk(i).face_count == 0) others.push_back(i);
    }
    fill(others);
    return std::move(surface_);
  }

 private:
  void fill(std::span<const std::uint64_t> chunks) {
    for_each_range(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
      ScratchPool<PassingColumns>::Turn passing(passing_);
      const WatchedFill watched(passing->workspace, cancellation_);
      for (std::size_t i = begin; i < end && !cancellation_.requested(); ++i) {
        fill_chunk(chunks[i], *passing);
      }
    });
  }

  void fill_chunk(std::uint64_t index, PassingColumns& passing) {
    const ChunkExtent extent = plan_.chunk(index);
    const ChunkSizes size(surface_.header, extent);
    const ChunkSizes before = ChunkSizes::before(surface_.header, extent);
    passing.tets.resize(size.tets);
    passing.regions.resize(size.regions);
    passing.face_tets.resize(size.face_tets);
    ChunkColumns columns;
    columns.positions = surface_.positions.bytes().subspan(before.positions, size.positions);
    columns.faces = surface_.faces.bytes().subspan(before.faces, size.faces);
    columns.face_labels =
        surface_.face_labels.bytes().subspan(before.face_labels, size.face_labels);
    columns.tets = passing.tets;
    columns.regions = passing.regions;
    columns.face_tets = passing.face_tets;
    plan_.fill_chunk(index, passing.workspace, columns);
  }

  /// Which chunks have vertices of faces.
  std::vector<bool> chunks_of_vertices() const {
    std::vector<std::uint64_t> end;  // of each chunk's vertices
    for (std::uint64_t i = 0; i < surface_.header.chunk_count; ++i) {
      const ChunkExtent extent = plan_.chunk(i);
      end.push_back(extent.first_vertex + extent.vertex_count);
    }
    std::vector<bool> needed(end.size());
    if (cancellation_.requested()) return needed;  // the faces are not all there
    std::size_t chunk = 0;
    for (std::uint64_t i = 0; i < surface_.header.face_count; ++i) {
      for (const std::uint64_t vertex : surface_.face(i)) {
        const bool is_in = vertex < end[chunk] && (chunk == 0 || end[chunk - 1] <= vertex);
        if (!is_in) {
          chunk = static_cast<std::size_t>(std::ranges::upper_bound(end, vertex) - end.begin());
        }
        needed[chunk] = true;
      }
    }
    return needed;
  }

  const MeshPlan& plan_;
  const Cancellation& cancellation_;
  TetMesh surface_;  // with these columns alone
  ScratchPool<PassingColumns> passing_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const MeshPlan>> divide_surface(
    std::shared_ptr<const MeshPlan> plan,
    const MeshLimits& limits,
    const Cancellation& cancellation) {
  if (auto status = check_surface_budget(plan->header(), limits); !status.ok()) return status;
  SurfaceMaker maker(*plan, cancellation);
  TetMesh surface = maker.make();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = divide_regions(surface, cancellation); !status.ok()) return status;
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return std::make_shared<const CreasedPlan>(
      std::move(plan), std::move(surface.header.face_labels), std::move(surface.face_labels));
}

}  // namespace tet
