#include "core/fidelity/measure_plan.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/fidelity/measured_mesh.h"
#include "core/fidelity/tet_sums.h"
#include "core/field/find_bricks.h"
#include "core/plan/budget.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

/// What is kept of a face: its vertices while they are sorted, where it lies, its box in a tree
/// with what sorts it, its middle's phi; and of phi's surface there as much again. Measured,
/// and rounded up.
constexpr std::uint64_t kBytesPerFace = 448;
/// Points on both surfaces, whatever the mesh.
constexpr std::uint64_t kSampleBytes = std::uint64_t{16} << 20;
/// A brick that phi's surface is looked for in: while bricks are found, and in three lists.
constexpr std::uint64_t kBytesPerMeasuredBrick = kBytesPerFoundBrick + 3 * sizeof(BrickCoord);

/// Where the lattice is coarser than a grid's voxels, their bricks are looked through.
std::uint64_t finer_bricks_of(const Volume& volume, double spacing) noexcept {
  constexpr double kSameSpacing = 1e-6;
  const bool is_coarser = spacing > (1 + kSameSpacing) * volume.transform.voxel_size;
  return is_coarser ? std::min<std::uint64_t>(kMaxSurfaceBricks, volume.bricks.size()) : 0;
}

/// Bricks that phi's surface is looked for in; one grid's part is measured after the other.
std::uint64_t measured_bricks(const MeshPlan& plan) noexcept {
  std::uint64_t finer = 0;
  if (const Volume* const volume = volume_of(plan.shape())) {
    finer = finer_bricks_of(*volume, plan.header().spacing);
  }
  if (const GridList* const grids = grids_of(plan.shape())) {
    const auto& parts = plan.header().parts;
    for (std::size_t i = 0; i < std::min(grids->size(), parts.size()); ++i) {
      finer = std::max(finer, finer_bricks_of(*(*grids)[i], parts[i].spacing));
    }
  }
  return plan.surface_bricks() + finer;
}

/// One task's chunk, whose memory its next one uses again.
struct Scratch {
  MeshWorkspace workspace;
  TetMesh chunk;
};

/// Makes a plan's chunks one after the other.
class PlanMeasure {
 public:
  PlanMeasure(const MeshPlan& plan, const Cancellation& cancellation)
      : plan_(plan),
        header_(plan.header()),
        cancellation_(cancellation),
        positions_(ChunkSizes(header_, whole_of(header_)).positions) {}

  /// Keeps all positions, and returns the triangles of the surface as surface_triangles does.
  std::vector<Triangle> find_surface() {
    std::vector<std::vector<SortedFace>> chunks(header_.chunk_count);
    for_each_chunk([&](std::size_t i, const TetMesh& chunk, const ChunkExtent& place) {
      std::memcpy(positions_.bytes().data() + ChunkSizes::before(header_, place).positions,
                  chunk.positions.bytes().data(), chunk.positions.size());
      for (std::uint64_t f = 0; f < place.face_count; ++f) {
        const FaceLabel& label = header_.face_labels[chunk.face_label(f)];
        if (label.kind != FaceKind::kBox) chunks[i].push_back(sort_face(chunk.face(f)));
      }
    });
    std::vector<SortedFace> faces;
    faces.reserve(header_.face_count);
    for (auto& chunk : chunks) {
      faces.insert(faces.end(), chunk.begin(), chunk.end());
      chunk = {};
    }
    std::sort(faces.begin(), faces.end());
    std::vector<Triangle> triangles(faces.size());
    std::ranges::transform(faces, triangles.begin(), &SortedFace::triangle);
    return triangles;
  }

  /// After find_surface.
  TetSums sum_tets() {
    std::vector<TetSums> chunks(header_.chunk_count, TetSums(header_));
    for_each_chunk([&](std::size_t i, const TetMesh& chunk, const ChunkExtent& place) {
      MeshView view = places();
      view.tets = chunk.tets.bytes();
      for (std::uint64_t t = 0; t < place.tet_count; ++t) {
        chunks[i].add(place.first_tet + t, view.stored_places(t), chunk.region(t));
      }
    });
    TetSums all(header_);
    for (const TetSums& chunk : chunks) all.add(chunk);
    return all;
  }

  MeshView places() const noexcept {
    return {header_.coordinate_type, header_.index_type, positions_.bytes(), {}};
  }

 private:
  template <class Take>
  void for_each_chunk(const Take& take) {
    for_each_index(header_.chunk_count, [&](std::size_t i) {
      if (cancellation_.requested()) return;
      const ScratchPool<Scratch>::Turn scratch(scratch_);
      const ChunkExtent place = plan_.chunk(i);
      MeshHeader header = header_of_chunk(header_, place);
      header.fields.clear();
      scratch->chunk = TetMesh(header, std::move(scratch->chunk));
      const WatchedFill watched(scratch->workspace, cancellation_);
      plan_.fill_chunk(i, scratch->workspace, scratch->chunk.columns());
      if (cancellation_.requested()) return;
      take(i, std::as_const(scratch->chunk), place);
    });
  }

  const MeshPlan& plan_;
  const MeshHeader& header_;
  const Cancellation& cancellation_;
  ByteBuffer positions_;
  ScratchPool<Scratch> scratch_;
};

}  // namespace

std::uint64_t fidelity_bytes(const MeshPlan& plan, int threads) noexcept {
  const MeshHeader& header = plan.header();
  return ChunkSizes(header, whole_of(header)).positions + kBytesPerFace * header.face_count +
         kBytesPerMeasuredBrick * measured_bricks(plan) + sizeof(TetSums) * header.chunk_count +
         kSampleBytes + static_cast<std::uint64_t>(std::max(1, threads)) * 2 * kChunkBytes;
}

absl::StatusOr<MeshFidelity> fidelity_of(const MeshPlan& plan,
                                         const MeshRequest& request,
                                         const Cancellation& cancellation) {
  TET_CHECK(plan.header().has_faces());
  PlanMeasure measure(plan, cancellation);
  const std::vector<Triangle> surface = measure.find_surface();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  const TetSums sums = measure.sum_tets();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  auto parts = measure_surface({plan.header(), measure.places(), surface, sums.volumes()},
                               plan.shape(), request, cancellation);
  if (!parts.ok()) return parts.status();
  return MeshFidelity{*std::move(parts), summary_of(sums.shapes())};
}

double fidelity_seconds(const MeshPlan& plan, double fill_seconds, int threads) noexcept {
  // Found with faces_bench's meshes, seconds of one thread; bricks with a ball of voxels whose
  // lattice is ten times as coarse.
  constexpr double kPerSamples = 0.25, kPerFace = 4e-6, kPerTet = 2.5e-7, kPerBrick = 3e-5;
  const MeshHeader& header = plan.header();
  const double alone = kPerSamples + kPerFace * static_cast<double>(header.face_count) +
                       kPerTet * static_cast<double>(header.tet_count) +
                       kPerBrick * static_cast<double>(measured_bricks(plan));
  return 2 * fill_seconds + alone / std::max(1, threads);
}

}  // namespace tet
