#include "core/transfer/compact_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/lattice/reach.h"
#include "core/mesh/find_faces.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/mesh_workspace.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

constexpr std::size_t kCodedPerRange = 16;

/// Enters the cut points that a finest brick's tets reach.
void unpack_cut_points(const CountedMesh& mesh, std::size_t brick, StuffedLattice& lattice) {
  lattice.warped.cut = {};
  const VerticesAround around = mesh.vertices_around(brick);
  for (std::size_t o = 0; o < around.size(); ++o) {
    if (!around[o].at_surface) continue;
    const PackedGeometry geometry(around[o].geometry, *around[o].stuffed);
    std::size_t first = geometry.zeros();
    for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
      first += for_each_in_reach(
          around[o].stuffed->cut[family], o, [&](int x, int y, int z, std::uint32_t rank) {
            const int low = halo_index(x, y, z);
            lattice.warped.cut[family].set(low);
            lattice.cuts.fraction[family][static_cast<std::size_t>(low)] =
                geometry.fraction(first + rank);
          });
    }
  }
}

/// Whether every surface quad that has a vertex in its middle is said to have one.
bool fans_are_right(const CountedMesh& mesh) {
  if (!mesh.rules().both_sides) return true;
  const OctreeLevel& finest = mesh.tree().levels[0];
  std::atomic<bool> right{true};
  for_each_range(finest.bricks.size(), kCodedPerRange, [&](std::size_t begin, std::size_t end) {
    const auto lattice = std::make_unique<StuffedLattice>();
    for (std::size_t i = begin; i < end; ++i) {
      if (!mesh.touches_surface(i)) continue;
      unpack_cut_points(mesh, i, *lattice);
      const HaloSet leaf = gather_halo(finest, finest.leaf, finest.bricks[i]);
      const FanMasks fans =
          find_fans(*lattice, gather_nodes(mesh.neighbourhood(i), leaf), mesh.rules());
      if (fans != mesh.survey().fans[mesh.stuffed(i)]) right = false;
    }
  });
  return right;
}

absl::Status check_totals(const CountedMesh& mesh, const MeshHeader& header) {
  const std::uint64_t vertices = mesh.first_vertex(mesh.brick_count());
  const std::uint64_t tets = mesh.first_tet(mesh.brick_count());
  const std::uint64_t faces = mesh.first_face(mesh.brick_count());
  if (vertices != header.vertex_count || tets != header.tet_count ||
      faces != header.face_count) {
    return absl::DataLossError(absl::StrFormat(
        "the compact chunks make %d vertices, %d tets and %d faces; the header says %d, %d and "
        "%d",
        vertices, tets, faces, header.vertex_count, header.tet_count, header.face_count));
  }
  // The filler gives faces these labels, whatever else the header has.
  MeshHeader labelled;
  labelled.face_labels = face_labels_of(mesh.rules().both_sides, mesh.rules().both_sides);
  add_region_labels(header.face_regions, labelled);
  if (header.has_faces() && labelled.face_labels.size() != header.face_labels.size()) {
    return absl::DataLossError(
        absl::StrFormat("faces of compact chunks have %d labels; the header says %d",
                        labelled.face_labels.size(), header.face_labels.size()));
  }
  if (!fans_are_right(mesh)) {
    return absl::DataLossError("a compact chunk is broken: a fan where there is none");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<FilledMesh> decode_mesh(CompactBricks bricks,
                                       const MeshHeader& header,
                                       const CompactFrame& frame,
                                       const Cancellation& cancellation,
                                       TetMesh used,
                                       Statistics statistics) {
  const std::vector<std::size_t> first_brick = bricks.first_brick();
  absl::StatusOr<CountedMesh> counted =
      std::move(bricks).count(frame.rules, header.has_faces());
  if (!counted.ok()) return counted.status();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = check_totals(*counted, header); !status.ok()) return status;
  FilledMesh filled;
  try {
    filled.mesh = TetMesh(header, std::move(used));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("no memory for %d vertices and %d tets",
                                                        header.vertex_count, header.tet_count));
  }
  const Volume no_samples;  // all that they decided has come with the chunks
  PhiField field;
  field.volume = &no_samples;
  std::vector<QualityStats> stats(first_brick.size() - 1);
  std::atomic<bool> whole{true};  // what another's octree lacks has ids of no vertex
  ScratchPool<MeshWorkspace> workspaces;
  for_each_range(stats.size(), 1, [&](std::size_t begin, std::size_t end) {
    const ScratchPool<MeshWorkspace>::Turn workspace(workspaces);
    for (std::size_t chunk = begin; chunk < end && !cancellation.requested(); ++chunk) {
      BrickFiller filler(*counted, field, header, frame.to_world, statistics,
                         workspace->get<BrickScratch>());
      for (std::size_t i = first_brick[chunk]; i < first_brick[chunk + 1]; ++i) {
        const ChunkColumns columns = filled.mesh.columns_of(counted->extent({i, i + 1}));
        filler.fill(i, columns);
        if (!ids_are_within(columns.tets, header)) whole = false;
      }
      stats[chunk] = filler.stats();
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  if (!whole) return absl::DataLossError("a compact chunk is broken: its leaves leave gaps");
  for (const QualityStats& chunk : stats) filled.quality.add(chunk);
  return filled;
}

}  // namespace tet
